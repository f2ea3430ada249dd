//! An interactive sculpting session: a recorded stroke of 300 moves on spheres of 250,000 to
//! 4,000,000 triangles.
//!
//! The brush touches the same number of vertices on each sphere, while edges are split, collapsed
//! and flipped. Reports the time of each stage of a move, and the time and memory of undo. The
//! reported run is the median of seven.

#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

use std::{f64::consts::FRAC_PI_4, sync::Arc, time::Instant};

use glam::DVec3;
use isochore_bench::{cpu_seconds, median, print_row};
use isochore_field::{Pose, rotation_from_vector};
use isochore_mesh::{NoProgress, TriMesh, primitives};
use isochore_sculpt::{
    Meshes,
    recipe::{Profile, Sphere, Tool, ToolShape},
    session::{InteractiveRefinement, MoveReceipt, Session, SessionOptions, SessionTool, StrokeOptions, StrokeReceipt},
};

/// Cells along each edge of the cubes that are projected to spheres. A cube has 12 n² triangles.
const SEGMENTS: [usize; 3] = [144, 289, 577];

/// Index of the reference mesh, which has a million triangles.
const REFERENCE: usize = 1;

/// Fraction of the surface of the reference mesh within reach of the brush at its mean height. A
/// median move touches two percent of the vertices.
const REACHED: f64 = 0.023;

const MOVES: usize = 300;

const ROUNDS: usize = 7;

/// Height of the brush center above the surface at rest, relative to its reach. The core does not
/// touch the surface.
const HEIGHT: f64 = 0.7;

fn main() {
    print_row([
        "triangles",
        "touched",
        "median ms",
        "p99 ms",
        "CPU ms",
        "select",
        "advect",
        "refine",
        "index",
        "buffers",
    ]);
    // Alternate between the meshes, so that other load on the machine affects all of them.
    let mut rounds: Vec<Vec<Run>> = SEGMENTS.iter().map(|_| Vec::new()).collect();
    for _ in 0..ROUNDS {
        SEGMENTS.into_iter().zip(&mut rounds).for_each(|(segments, runs)| runs.push(Run::of(segments)));
    }
    let runs: Vec<Run> = rounds.into_iter().map(median_run).inspect(Run::report).collect();
    print_row([
        "triangles",
        "inserted",
        "removed",
        "flips",
        "undo ms",
        "redo ms",
        "undo MB",
        "undo bytes/vertex",
        "bare volume change",
    ]);
    for run in &runs {
        run.report_stroke();
    }
    println!("\ncost per touched vertex, relative to the mesh of a million triangles");
    print_row(["triangles", "wall time", "CPU time"]);
    for run in &runs {
        let relative_cost = |seconds: fn(&Run) -> f64| {
            let cost_per_vertex = |run: &Run| seconds(run) / run.touched();
            format!("{:.2}", cost_per_vertex(run) / cost_per_vertex(&runs[REFERENCE]))
        };
        print_row([
            &run.triangles.to_string(),
            &relative_cost(Run::median_seconds),
            &relative_cost(|run| run.cpu_seconds),
        ]);
    }
}

/// The run whose median time per move is the median of all runs.
fn median_run(mut runs: Vec<Run>) -> Run {
    runs.sort_by(|one, other| one.median_seconds().total_cmp(&other.median_seconds()));
    runs.swap_remove(runs.len() / 2)
}

/// Reach of a brush that covers a `fraction` of the unit sphere if its center is `HEIGHT` times its
/// reach above the surface.
fn reach_of(fraction: f64) -> f64 {
    let covered = |reach: f64| {
        let center = 1.0 + HEIGHT * reach;
        // Law of cosines for the two centers and a point on both surfaces.
        let cosine = (1.0 + center * center - reach * reach) / (2.0 * center);
        0.5 * (1.0 - cosine)
    };
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        *(if covered(middle) < fraction { &mut low } else { &mut high }) = middle;
    }
    high
}

/// One stroke on one mesh.
struct Run {
    triangles: usize,
    opened_volume: f64,
    /// Wall time of each move in seconds, including the query of its changes, with its receipt.
    moves: Vec<(f64, MoveReceipt)>,
    /// Mean CPU time per move, seconds.
    cpu_seconds: f64,
    receipt: StrokeReceipt,
    undo_seconds: f64,
    redo_seconds: f64,
}

impl Run {
    fn of(segments: usize) -> Self {
        let mesh = sphere(segments);
        let (triangles, opened_volume) = (mesh.triangles.len(), mesh.volume());
        let million = (12 * SEGMENTS[REFERENCE] * SEGMENTS[REFERENCE]) as f64;
        let reach = reach_of(REACHED * million / triangles as f64);
        let longest = 1.5 * longest_edge(&mesh);
        let mut session = Session::open(mesh, SessionOptions::default()).expect("a sphere");
        let shape = ToolShape::Sphere(Sphere { radius: 0.5 * reach });
        let tool = Tool { shape, support: 0.5 * reach, profile: Profile::Quintic, free_form: 0.0 };
        let tool = Arc::new(SessionTool::new("brush", tool, &Meshes::new(), &NoProgress).expect("a valid tool"));
        let refine = InteractiveRefinement { longest: Some(longest), ..InteractiveRefinement::default() };
        session.begin_stroke(&tool, StrokeOptions { refine: Some(refine) }).expect("no open stroke");
        let cpu = cpu_seconds();
        let mut moves = Vec::new();
        for (index, pose) in recorded(reach).iter().enumerate() {
            let begin = Instant::now();
            let receipt = session.move_to(pose, index as f64 / 60.0).expect("a valid move");
            std::hint::black_box(session.take_changes());
            if index > 0 {
                moves.push((begin.elapsed().as_secs_f64(), receipt));
            }
        }
        let cpu_seconds = (cpu_seconds() - cpu) / MOVES as f64;
        let receipt = session.end_stroke().expect("an open stroke");
        let mut timed = |step: fn(&mut Session) -> bool| {
            let begin = Instant::now();
            assert!(step(&mut session));
            begin.elapsed().as_secs_f64()
        };
        let mut undo = Vec::new();
        let mut redo = Vec::new();
        for _ in 0..9 {
            undo.push(timed(|session| session.undo().expect("no open stroke")));
            redo.push(timed(|session| session.redo().expect("no open stroke")));
        }
        Self {
            triangles,
            opened_volume,
            moves,
            cpu_seconds,
            receipt,
            undo_seconds: median(&mut undo),
            redo_seconds: median(&mut redo),
        }
    }

    fn median_seconds(&self) -> f64 {
        self.percentile(0.5, |(seconds, _)| *seconds)
    }

    /// Median number of vertices that a move touches.
    fn touched(&self) -> f64 {
        self.percentile(0.5, |(_, receipt)| receipt.moved_vertices as f64)
    }

    fn percentile(&self, fraction: f64, figure: impl Fn(&(f64, MoveReceipt)) -> f64) -> f64 {
        let mut figures: Vec<f64> = self.moves.iter().map(figure).collect();
        figures.sort_unstable_by(f64::total_cmp);
        figures[(fraction * (figures.len() - 1) as f64) as usize]
    }

    fn report(&self) {
        let stage = |figure: fn(&MoveReceipt) -> f64| {
            format!("{:.2}", 1e3 * self.percentile(0.5, |(_, receipt)| figure(receipt)))
        };
        print_row([
            &self.triangles.to_string(),
            &format!("{:.0}", self.touched()),
            &format!("{:.2}", 1e3 * self.median_seconds()),
            &format!("{:.2}", 1e3 * self.percentile(0.99, |(seconds, _)| *seconds)),
            &format!("{:.2}", 1e3 * self.cpu_seconds),
            &stage(|receipt| receipt.seconds.select),
            &stage(|receipt| receipt.seconds.flow),
            &stage(|receipt| receipt.seconds.refine),
            &stage(|receipt| receipt.seconds.index),
            &stage(|receipt| receipt.seconds.buffers),
        ]);
    }

    fn report_stroke(&self) {
        let receipt = &self.receipt;
        print_row([
            &self.triangles.to_string(),
            &receipt.inserted_vertices.to_string(),
            &receipt.removed_vertices.to_string(),
            &receipt.flipped_edges.to_string(),
            &format!("{:.2}", 1e3 * self.undo_seconds),
            &format!("{:.2}", 1e3 * self.redo_seconds),
            &format!("{:.1}", 1e-6 * receipt.undo_bytes as f64),
            &format!("{:.0}", receipt.undo_bytes as f64 / receipt.touched_vertices as f64),
            &format!("{:+.1e}", receipt.volume.expect("a closed sphere").bare() / self.opened_volume),
        ]);
    }
}

/// A cube projected to a sphere. The cells have equal angles as seen from the center, so their
/// sizes are similar.
fn sphere(segments: usize) -> TriMesh {
    let mut mesh = primitives::box_mesh(DVec3::ONE, [segments; 3]);
    for position in &mut mesh.positions {
        *position = position.map(|coordinate| libm::tan(FRAC_PI_4 * coordinate)).normalize();
    }
    mesh
}

fn longest_edge(mesh: &TriMesh) -> f64 {
    let edges = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let lengths = edges.map(|ends| {
        let [a, b] = ends.map(|vertex| mesh.positions[vertex as usize]);
        a.distance(b)
    });
    lengths.fold(0.0, f64::max)
}

/// Poses of a rubbing motion, recorded at 60 Hz. The brush oscillates across its path while it
/// advances slowly. Its speed and height vary, and it rotates. A move takes up to four time steps.
fn recorded(reach: f64) -> Vec<Pose> {
    let pose = |index: usize| {
        let phase = index as f64 * 0.1;
        let along = 0.01 * index as f64 * reach;
        let across = 0.9 * reach * libm::sin(phase + 0.5 * libm::sin(0.23 * phase));
        let height = 1.0 + reach * (HEIGHT + 0.08 * libm::sin(1.7 * phase));
        let direction = DVec3::new(libm::cos(along), libm::sin(along), across).normalize();
        Pose {
            rotation: rotation_from_vector(DVec3::new(0.02, 0.01, 0.03) * index as f64),
            translation: height * direction,
        }
    };
    (0..=MOVES).map(pose).collect()
}
