use std::sync::Mutex;

use isochore_bench::cpu_seconds;
use isochore_mesh::{DistanceField, DistanceFieldOptions, Monitor, TriMesh};

/// CPU times of the stages of building a distance field, in seconds.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Stages {
    pub(crate) hierarchy: f64,
    pub(crate) distance: f64,
    pub(crate) signs: f64,
    pub(crate) spline: f64,
}

/// Records the CPU time at which each stage begins.
struct Clock(Mutex<Vec<(&'static str, f64)>>);

impl Monitor for Clock {
    fn update(&self, stage: &'static str, _done: f64) {
        let mut begins = self.0.lock().expect("no thread panicked");
        if begins.last().is_none_or(|(last, _)| *last != stage) {
            begins.push((stage, cpu_seconds()));
        }
    }
}

/// Builds a distance field and returns it with the CPU time of each stage.
pub(crate) fn build(mesh: &TriMesh, options: &DistanceFieldOptions) -> (DistanceField, Stages) {
    let clock = Clock(Mutex::default());
    let field = DistanceField::new(mesh, options, &clock).expect("a valid mesh");
    let mut begins = clock.0.into_inner().expect("no thread panicked");
    begins.push(("end", cpu_seconds()));
    let mut stages = Stages::default();
    for pair in begins.windows(2) {
        let seconds = pair[1].1 - pair[0].1;
        match pair[0].0 {
            "hierarchy" => stages.hierarchy += seconds,
            "distance" => stages.distance += seconds,
            "signs" => stages.signs += seconds,
            _ => stages.spline += seconds,
        }
    }
    (field, stages)
}
