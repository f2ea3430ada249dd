//! Cost and accuracy of refinement on one core: a press and a turning rod, for three volume
//! tolerances. The lower bound of the cost is advecting the vertices of the result once, without
//! refinement.

use std::sync::Arc;

use glam::DVec3;
use isochore_bench::{interleaved_medians, on_one_core, print_row};
use isochore_field::{
    DeformOptions, Move, Pose, Profile, RefineOptions, Stroke, Tool, advect_points, deform, rotation_from_vector,
};
use isochore_mesh::{Capsule, Distance, NoProgress, Sphere, primitives};

fn main() {
    on_one_core(|| {
        print_row(["stroke", "tolerance", "triangles", "volume drift", "M triangles/s", "ratio to bound"]);
        for (name, stroke) in [("press", press()), ("rod", rod())] {
            for volume in [1e-3, 1e-4, 1e-5] {
                measure(name, &stroke, volume);
            }
        }
    });
}

fn measure(name: &str, stroke: &Stroke, volume: f64) {
    let object = primitives::icosphere(1.0, 6);
    let strokes = std::slice::from_ref(stroke);
    let refine = RefineOptions { volume: Some(volume), ..RefineOptions::default() };
    let options = DeformOptions { refine: Some(refine), lock: false };
    let run = || deform(&object, strokes, &options, &NoProgress).expect("the deformation is not canceled");
    let result = run();
    let seconds = interleaved_medians(&mut [&mut || drop(std::hint::black_box(run())), &mut || {
        drop(std::hint::black_box(advect_points(&result.rest.positions, strokes, &NoProgress)))
    }]);
    let drift = result.mesh.volume() / object.volume() - 1.0;
    print_row([
        name,
        &format!("{volume:.0e}"),
        &result.mesh.triangles.len().to_string(),
        &format!("{drift:+.1e}"),
        &format!("{:.2}", 1e-6 * result.mesh.triangles.len() as f64 / seconds[0]),
        &format!("{:.1}", seconds[0] / seconds[1]),
    ]);
}

fn tool(shape: impl Distance + 'static) -> Arc<Tool> {
    Arc::new(Tool::new(Arc::new(shape), 0.3, Profile::Quintic).expect("a positive support"))
}

fn press() -> Stroke {
    let ball = tool(Sphere::new(0.4).expect("a positive radius"));
    let keys = vec![Pose::at(DVec3::Z * 1.75), Pose::at(DVec3::Z)];
    Stroke::Move(Move::new(ball, keys, 0.125).expect("a valid path"))
}

fn rod() -> Stroke {
    let rod = tool(Capsule::new(0.15, 0.8).expect("a positive length"));
    let at = DVec3::new(0.0, 0.9, 0.0);
    let turned = Pose { rotation: rotation_from_vector(DVec3::Y * std::f64::consts::FRAC_PI_2), translation: at };
    Stroke::Move(Move::new(rod, vec![Pose::at(at), turned], 0.125).expect("a valid path"))
}
