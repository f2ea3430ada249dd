//! A tool sampled on a grid, compared with libraries that interpolate a sampled velocity
//! trilinearly.
//!
//! A ball of radius ½ moves past 560,002 points on the unit sphere in 20 Runge-Kutta steps. Its
//! support always contains all points, so skipping points gives no advantage. The error is the
//! largest distance from the reference, which uses 160 steps with the exact distance in double
//! precision.

use std::{fs, sync::Arc, time::Instant};

use glam::{DVec3, dvec3};
use isochore_bench::{Comparison, PythonPeer, cpu_seconds, grouped, median, print_row, scratch};
use isochore_field::{BodyTwist, Move, Pose, Profile, RigidField, Stroke, Tool, advect_points};
use isochore_mesh::{Distance, DistanceField, DistanceFieldOptions, Grid, NoProgress, Padding, Sphere, primitives};
use serde_json::json;

const RADIUS: f64 = 0.5;
const SUPPORT: f64 = 0.8;
const SHIFT: DVec3 = dvec3(0.09, 0.18, 0.22);
const STEPS: usize = 20;
const ROUNDS: usize = 9;

/// Cells on the diameter of the ball, and around it: 128 nodes along each axis.
const CELLS: [usize; 2] = [25, 51];

/// Loads per cycle of a core.
const LOADS_PER_CYCLE: f64 = 2.0;
/// Loads per step without row loads: 64 coefficients in each of four stages.
const LOADS_PER_STEP: f64 = 256.0;

struct Race {
    points: Vec<DVec3>,
    grid: Grid,
    sampled: [Stroke; 1],
    exact: [Stroke; 1],
    /// Reference end positions of the points.
    reference: Vec<DVec3>,
}

impl Race {
    fn new() -> Self {
        let points = primitives::latitude_longitude_sphere(1.0, 800, 701).positions;
        assert_eq!(points.len(), 560_002);
        // Its facets deviate from the ball by less than a millionth.
        let ball = primitives::icosphere(RADIUS, 8);
        let options =
            DistanceFieldOptions { resolution: CELLS[0], padding: Padding::Cells(CELLS[1]), ..Default::default() };
        let field = DistanceField::new(&ball, &options, &NoProgress).expect("a closed mesh");
        let grid = *field.grid();
        assert_eq!(grid.dims, [128; 3]);
        let exact = Sphere::new(RADIUS).expect("a positive radius");
        let reference = advected(&points, &[stroke(exact, 8 * STEPS)]);
        Self { points, grid, sampled: [stroke(field, STEPS)], exact: [stroke(exact, STEPS)], reference }
    }

    fn error(&self, ends: &[DVec3]) -> f64 {
        assert_eq!(ends.len(), self.reference.len());
        ends.iter().zip(&self.reference).map(|(end, reference)| end.distance(*reference)).fold(0.0, f64::max)
    }
}

fn stroke(distance: impl Distance + 'static, steps: usize) -> Stroke {
    let tool = Tool::new(Arc::new(distance), SUPPORT, Profile::Quintic).expect("a positive support");
    let step = SHIFT.length() / tool.feature_size() / (steps as f64 - 0.5);
    let path = Move::new(Arc::new(tool), vec![Pose::IDENTITY, Pose::at(SHIFT)], step).expect("a valid path");
    assert_eq!(path.steps(), steps);
    Stroke::Move(path)
}

fn advected(points: &[DVec3], strokes: &[Stroke]) -> Vec<DVec3> {
    advect_points(points, strokes, &NoProgress).expect("the advection is not canceled")
}

pub(crate) fn run() {
    let race = Race::new();
    let mut peers: Vec<Peer> = [("warp", "Warp 1.19 on the CPU"), ("numba", "numba 0.68")]
        .into_iter()
        .filter_map(|(library, name)| {
            Peer::start(&race, library, name).map_err(|error| println!("{name} is missing: {error}")).ok()
        })
        .collect();

    let (mut clock, mut sampled, mut exact) = (Vec::new(), Vec::new(), Vec::new());
    for round in 0..=ROUNDS {
        let mut times = vec![clock_rate(), cpu_time_of(|| advected(&race.points, &race.sampled))];
        times.push(cpu_time_of(|| advected(&race.points, &race.exact)));
        for peer in &mut peers {
            let seconds = peer.advect();
            // The first round is the warm-up.
            if round > 0 {
                peer.seconds.push(seconds);
            }
        }
        if round > 0 {
            for (times, time) in [&mut clock, &mut sampled, &mut exact].into_iter().zip(times) {
                times.push(time);
            }
        }
    }

    let vertex_steps = (race.points.len() * STEPS) as f64;
    let millions = |seconds: f64| 1e-6 * vertex_steps / seconds;
    let (clock, sampled, exact) = (median(&mut clock), median(&mut sampled), median(&mut exact));
    let bound = 1e-6 * LOADS_PER_CYCLE * clock / LOADS_PER_STEP;
    print_row(["distance", "M vertex-steps/s", "GHz", "upper bound", "of bound", "error"]);
    for (name, seconds, strokes) in [("sampled", sampled, &race.sampled), ("exact", exact, &race.exact)] {
        print_row([
            name,
            &format!("{:.1}", millions(seconds)),
            &format!("{:.2}", 1e-9 * clock),
            &format!("{bound:.1}"),
            &format!("{:.2}", millions(seconds) / bound),
            &format!("{:.1e}", race.error(&advected(&race.points, strokes))),
        ]);
    }
    println!();
    Comparison::print_heading();
    let ours = race.error(&advected(&race.points, &race.sampled));
    for peer in &mut peers {
        let nanoseconds = |seconds: f64| 1e9 * seconds / vertex_steps;
        let row = Comparison {
            job: format!("advect {} points through {STEPS} steps, grid of 128³, one core", grouped(race.points.len())),
            peer: format!("{}, trilinear", peer.name),
            unit: "ns/vertex-step".into(),
            ours: nanoseconds(sampled),
            theirs: nanoseconds(median(&mut peer.seconds)),
            accuracy: format!("error {ours:.0e} | {:.0e}", race.error(&peer.ends(&race.grid))),
        };
        row.report();
    }
    println!();
}

/// Compares wall times on one and two threads. Meaningful only on an idle machine.
pub(crate) fn on_two_cores() {
    let race = Race::new();
    let seconds = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
        let mut seconds: Vec<f64> = (0..ROUNDS)
            .map(|_| {
                let begin = Instant::now();
                pool.install(|| advected(&race.points, &race.sampled));
                begin.elapsed().as_secs_f64()
            })
            .collect();
        median(&mut seconds)
    });
    println!("wall time on one and two threads, seconds");
    print_row(["one", "two", "ratio"]);
    let [one, two] = seconds;
    print_row([&format!("{one:.3}"), &format!("{two:.3}"), &format!("{:.2}", one / two)]);
}

/// CPU time of a job, seconds.
fn cpu_time_of<T>(job: impl FnOnce() -> T) -> f64 {
    let begin = cpu_seconds();
    std::hint::black_box(job());
    cpu_seconds() - begin
}

/// Cycles per second, from a chain of dependent instructions of one cycle each.
fn clock_rate() -> f64 {
    const ITERATIONS: u64 = 10_000_000;
    // Each shift or exclusive or depends on the previous one, and the compiler cannot simplify the
    // chain.
    const CYCLES_PER_ITERATION: f64 = 6.0;
    let seconds = cpu_time_of(|| {
        (0..ITERATIONS).fold(std::hint::black_box(1_u64), |mut state, _| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^ state << 17
        })
    });
    CYCLES_PER_ITERATION * ITERATIONS as f64 / seconds
}

/// A library that advects the same points.
struct Peer {
    name: &'static str,
    process: PythonPeer,
    ends: String,
    seconds: Vec<f64>,
}

impl Peer {
    /// Starts the peer and sends the points and the displacement per step at the grid nodes. Both
    /// are relative to the tool, in units of cells.
    fn start(race: &Race, library: &str, name: &'static str) -> Result<Self, String> {
        let mut process = PythonPeer::start("advect", &[library])?;
        let tool = Tool::new(Arc::new(Sphere::new(RADIUS).expect("a positive radius")), SUPPORT, Profile::Quintic);
        let tool = tool.expect("a positive support");
        let field = RigidField::new(&tool, BodyTwist { linear: SHIFT, angular: DVec3::ZERO });
        let Grid { origin, cell, dims } = race.grid;
        let step = 1.0 / STEPS as f64 / cell;
        let velocities = (0..race.grid.len()).map(|node| step * (field.velocity(race.grid.node_at(node)) - SHIFT));
        let points_in_cells = race.points.iter().map(|&point| (point - origin) / cell);
        let grid = write(&format!("{library}.grid"), velocities);
        let points = write(&format!("{library}.points"), points_in_cells);
        process.ask(&json!({ "job": "prepare", "grid": grid, "nodes": dims[0], "points": points, "steps": STEPS }))?;
        let ends = scratch().join(format!("{library}.ends")).to_string_lossy().into_owned();
        Ok(Self { name, process, ends, seconds: Vec::new() })
    }

    fn advect(&mut self) -> f64 {
        self.process.seconds(&json!({ "job": "advect", "ends": self.ends })).expect("the peer replied before")
    }

    /// End positions of the points in the last round.
    fn ends(&self, grid: &Grid) -> Vec<DVec3> {
        let bytes = fs::read(&self.ends).expect("the peer wrote the end positions");
        let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect();
        let to_model_units = |cells: &[f64; 3]| grid.origin + grid.cell * DVec3::from_array(*cells) + SHIFT;
        numbers.as_chunks().0.iter().map(to_model_units).collect()
    }
}

fn write(name: &str, vectors: impl Iterator<Item = DVec3>) -> String {
    let path = scratch().join(name);
    let bytes: Vec<u8> = vectors.flat_map(|vector| vector.to_array()).flat_map(f64::to_le_bytes).collect();
    fs::write(&path, bytes).expect("the scratch folder can be written");
    path.to_string_lossy().into_owned()
}
