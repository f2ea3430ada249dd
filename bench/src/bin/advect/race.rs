//! A tool sampled on a grid against libraries that interpolate a sampled velocity, trilinear.
//!
//! A ball of radius ½ moves past 560,002 points on the unit sphere in 20 Runge-Kutta steps. Its support holds all points all the
//! time, so that nobody gains by leaving any out. Errors are the largest distances to where points end in 160 steps with the
//! exact distance in double precision.

use std::{fs, sync::Arc, time::Instant};

use glam::{DVec3, dvec3};
use isochore_bench::{Comparison, PythonPeer, cpu_seconds, median, print_row, scratch};
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

/// Loads that a core can do in a cycle, and that a step takes without row loads: 64 coefficients in each of four stages.
const LOADS_A_CYCLE: f64 = 2.0;
const LOADS_A_STEP: f64 = 256.0;

struct Race {
    points: Vec<DVec3>,
    grid: Grid,
    sampled: [Stroke; 1],
    exact: [Stroke; 1],
    /// Where the points end.
    reference: Vec<DVec3>,
}

impl Race {
    fn new() -> Self {
        let points = primitives::latitude_longitude_sphere(1.0, 800, 701).positions;
        assert_eq!(points.len(), 560_002);
        // So fine that its facets lie within a millionth of the ball.
        let ball = primitives::icosphere(RADIUS, 8);
        let options =
            DistanceFieldOptions { resolution: CELLS[0], padding: Padding::Cells(CELLS[1]), ..Default::default() };
        let field = DistanceField::new(&ball, &options, &NoProgress).expect("a closed mesh");
        let grid = *field.grid();
        assert_eq!(grid.dims, [128; 3]);
        let exact = Sphere::new(RADIUS).expect("a radius");
        let reference = carried(&points, &[stroke(exact, 8 * STEPS)]);
        Self { points, grid, sampled: [stroke(field, STEPS)], exact: [stroke(exact, STEPS)], reference }
    }

    fn error(&self, ends: &[DVec3]) -> f64 {
        assert_eq!(ends.len(), self.reference.len());
        ends.iter().zip(&self.reference).map(|(end, reference)| end.distance(*reference)).fold(0.0, f64::max)
    }
}

fn stroke(distance: impl Distance + 'static, steps: usize) -> Stroke {
    let tool = Tool::new(Arc::new(distance), SUPPORT, Profile::Quintic).expect("a support");
    let step = SHIFT.length() / tool.feature_size() / (steps as f64 - 0.5);
    let way = Move::new(Arc::new(tool), vec![Pose::IDENTITY, Pose::at(SHIFT)], step).expect("a way");
    assert_eq!(way.steps(), steps);
    Stroke::Move(way)
}

fn carried(points: &[DVec3], strokes: &[Stroke]) -> Vec<DVec3> {
    advect_points(points, strokes, &NoProgress).expect("nothing cancels")
}

pub(crate) fn run() {
    let race = Race::new();
    let mut peers: Vec<Peer> = [("warp", "Warp 1.19 on the CPU"), ("numba", "numba 0.68")]
        .into_iter()
        .filter_map(|(library, name)| {
            Peer::start(&race, library, name).map_err(|error| println!("{name} is left out: {error}")).ok()
        })
        .collect();

    let (mut clock, mut sampled, mut exact) = (Vec::new(), Vec::new(), Vec::new());
    for round in 0..=ROUNDS {
        let mut times = vec![clock_rate(), work(|| carried(&race.points, &race.sampled))];
        times.push(work(|| carried(&race.points, &race.exact)));
        for peer in &mut peers {
            let seconds = peer.advect();
            // The first round warms up.
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
    let ceiling = 1e-6 * LOADS_A_CYCLE * clock / LOADS_A_STEP;
    print_row(["distance", "M vertex-steps/s", "GHz", "ceiling", "share", "error"]);
    for (name, seconds, strokes) in [("sampled", sampled, &race.sampled), ("exact", exact, &race.exact)] {
        print_row([
            name,
            &format!("{:.1}", millions(seconds)),
            &format!("{:.2}", 1e-9 * clock),
            &format!("{ceiling:.1}"),
            &format!("{:.2}", millions(seconds) / ceiling),
            &format!("{:.1e}", race.error(&carried(&race.points, strokes))),
        ]);
    }
    println!();
    Comparison::print_heading();
    let ours = race.error(&carried(&race.points, &race.sampled));
    for peer in &mut peers {
        let nanoseconds = |seconds: f64| 1e9 * seconds / vertex_steps;
        let row = Comparison {
            job: format!("carry {} points through {STEPS} steps, grid of 128³, one core", race.points.len()),
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

/// By the clock, so it says something only where nothing else runs.
pub(crate) fn on_two_cores() {
    let race = Race::new();
    let seconds = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
        let mut seconds: Vec<f64> = (0..ROUNDS)
            .map(|_| {
                let begin = Instant::now();
                pool.install(|| carried(&race.points, &race.sampled));
                begin.elapsed().as_secs_f64()
            })
            .collect();
        median(&mut seconds)
    });
    println!("seconds by the clock on one and two threads");
    print_row(["one", "two", "ratio"]);
    let [one, two] = seconds;
    print_row([&format!("{one:.3}"), &format!("{two:.3}"), &format!("{:.2}", one / two)]);
}

/// Seconds of work.
fn work<T>(job: impl FnOnce() -> T) -> f64 {
    let begin = cpu_seconds();
    std::hint::black_box(job());
    cpu_seconds() - begin
}

/// Cycles in a second of work, from a chain of dependent instructions of one cycle each.
fn clock_rate() -> f64 {
    const TURNS: u64 = 10_000_000;
    // Shifts and exclusive ors, each of which needs the one before; no compiler knows where that ends.
    const CYCLES_A_TURN: f64 = 6.0;
    let seconds = work(|| {
        (0..TURNS).fold(std::hint::black_box(1_u64), |mut state, _| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^ state << 17
        })
    });
    CYCLES_A_TURN * TURNS as f64 / seconds
}

/// A library that carries the same points.
struct Peer {
    name: &'static str,
    process: PythonPeer,
    ends: String,
    seconds: Vec<f64>,
}

impl Peer {
    /// Gives it the points and, at the nodes of the grid, how far the exact field goes past the tool in a step, both in cells.
    fn start(race: &Race, library: &str, name: &'static str) -> Result<Self, String> {
        let mut process = PythonPeer::start("advect", &[library])?;
        let tool = Tool::new(Arc::new(Sphere::new(RADIUS).expect("a radius")), SUPPORT, Profile::Quintic);
        let tool = tool.expect("a support");
        let field = RigidField::new(&tool, BodyTwist { linear: SHIFT, angular: DVec3::ZERO });
        let Grid { origin, cell, dims } = race.grid;
        let step = 1.0 / STEPS as f64 / cell;
        let velocities = (0..race.grid.len()).map(|node| step * (field.velocity(race.grid.node_at(node)) - SHIFT));
        let places = race.points.iter().map(|&point| (point - origin) / cell);
        let grid = write(&format!("{library}.grid"), velocities);
        let points = write(&format!("{library}.points"), places);
        process.ask(&json!({ "job": "prepare", "grid": grid, "nodes": dims[0], "points": points, "steps": STEPS }))?;
        let ends = scratch().join(format!("{library}.ends")).to_string_lossy().into_owned();
        Ok(Self { name, process, ends, seconds: Vec::new() })
    }

    fn advect(&mut self) -> f64 {
        self.process.seconds(&json!({ "job": "advect", "ends": self.ends })).expect("it has answered before")
    }

    /// Where the points ended in the last round.
    fn ends(&self, grid: &Grid) -> Vec<DVec3> {
        let bytes = fs::read(&self.ends).expect("it has written them");
        let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect();
        let place = |place: &[f64; 3]| grid.origin + grid.cell * DVec3::from_array(*place) + SHIFT;
        numbers.as_chunks().0.iter().map(place).collect()
    }
}

fn write(name: &str, vectors: impl Iterator<Item = DVec3>) -> String {
    let path = scratch().join(name);
    let bytes: Vec<u8> = vectors.flat_map(|vector| vector.to_array()).flat_map(f64::to_le_bytes).collect();
    fs::write(&path, bytes).expect("the scratch folder can be written");
    path.to_string_lossy().into_owned()
}
