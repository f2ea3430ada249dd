//! A sculpting session at the pace of a frame: a recorded stroke of 300 moves over spheres of 250,000 to 4,000,000 triangles, by a
//! brush that touches equally many vertices of each, while edges are split, collapsed and flipped. Every stage of the moves, what
//! undo takes, and what it holds; of seven strokes the one in the middle.

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

/// Cells along each edge of the cubes that are blown up to spheres; twelve triangles a cell squared.
const SEGMENTS: [usize; 3] = [144, 289, 577];

/// The one by which the frame is judged, of a million triangles.
const JUDGED: usize = 1;

/// Share of the surface of a million triangles within reach of the brush, so that a move in the middle of its way in and out touches
/// two vertices in a hundred.
const REACHED: f64 = 0.023;

const MOVES: usize = 300;

const ROUNDS: usize = 7;

/// How far the middle of the brush is above the surface at rest, as a share of its reach: the core does not touch.
const HEIGHT: f64 = 0.7;

fn main() {
    print_row([
        "triangles",
        "touched",
        "median ms",
        "p99 ms",
        "CPU ms",
        "select",
        "flow",
        "refine",
        "index",
        "buffers",
    ]);
    // In turn, so that what else the machine does in a while is in all of them.
    let mut rounds: Vec<Vec<Run>> = SEGMENTS.iter().map(|_| Vec::new()).collect();
    for _ in 0..ROUNDS {
        SEGMENTS.into_iter().zip(&mut rounds).for_each(|(segments, runs)| runs.push(Run::of(segments)));
    }
    let runs: Vec<Run> = rounds.into_iter().map(in_the_middle).inspect(Run::report).collect();
    print_row([
        "triangles",
        "vertices in",
        "out",
        "flips",
        "undo ms",
        "redo ms",
        "undo MB",
        "bytes a vertex",
        "bare change",
    ]);
    for run in &runs {
        run.report_stroke();
    }
    print_row(["triangles", "cost of a touched vertex over that at a million, by the clock", "by the processor"]);
    for run in &runs {
        let over_judged = |seconds: fn(&Run) -> f64| {
            let of_vertex = |run: &Run| seconds(run) / run.touched();
            format!("{:.2}", of_vertex(run) / of_vertex(&runs[JUDGED]))
        };
        print_row([&run.triangles.to_string(), &over_judged(Run::median_seconds), &over_judged(|run| run.cpu_seconds)]);
    }
}

/// The run with the median of the medians.
fn in_the_middle(mut runs: Vec<Run>) -> Run {
    runs.sort_by(|one, other| one.median_seconds().total_cmp(&other.median_seconds()));
    runs.swap_remove(runs.len() / 2)
}

/// The reach of a brush that covers this share of the unit sphere, above which its middle stands by `HEIGHT` of its reach.
fn reach_of(share: f64) -> f64 {
    let covered = |reach: f64| {
        let middle = 1.0 + HEIGHT * reach;
        // The law of cosines for the middles of sphere and brush and a point where both surfaces meet.
        let cosine = (1.0 + middle * middle - reach * reach) / (2.0 * middle);
        0.5 * (1.0 - cosine)
    };
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > 1e-9 {
        let between = 0.5 * (low + high);
        *(if covered(between) < share { &mut low } else { &mut high }) = between;
    }
    high
}

/// One stroke on one mesh.
struct Run {
    triangles: usize,
    opened_volume: f64,
    /// Of each move: by the clock, with taking what has changed, and what it tells of itself.
    moves: Vec<(f64, MoveReceipt)>,
    /// Of the processor, a move on average.
    cpu_seconds: f64,
    receipt: StrokeReceipt,
    undo_seconds: f64,
    redo_seconds: f64,
}

impl Run {
    fn of(segments: usize) -> Self {
        let mesh = sphere(segments);
        let (triangles, opened_volume) = (mesh.triangles.len(), mesh.volume());
        let million = (12 * SEGMENTS[JUDGED] * SEGMENTS[JUDGED]) as f64;
        let reach = reach_of(REACHED * million / triangles as f64);
        let longest = 1.5 * longest_edge(&mesh);
        let mut session = Session::open(mesh, SessionOptions::default()).expect("a sphere");
        let shape = ToolShape::Sphere(Sphere { radius: 0.5 * reach });
        let tool = Tool { shape, support: 0.5 * reach, profile: Profile::Quintic, free_form: 0.0 };
        let tool = Arc::new(SessionTool::new("brush", tool, &Meshes::new(), &NoProgress).expect("a ball"));
        let refine = InteractiveRefinement { longest: Some(longest), ..InteractiveRefinement::default() };
        session.begin_stroke(&tool, StrokeOptions { refine: Some(refine) }).expect("no stroke before");
        let cpu = cpu_seconds();
        let mut moves = Vec::new();
        for (index, pose) in recorded(reach).iter().enumerate() {
            let begin = Instant::now();
            let receipt = session.move_to(pose, index as f64 / 60.0).expect("a short way");
            std::hint::black_box(session.take_changes());
            if index > 0 {
                moves.push((begin.elapsed().as_secs_f64(), receipt));
            }
        }
        let cpu_seconds = (cpu_seconds() - cpu) / MOVES as f64;
        let receipt = session.end_stroke().expect("a stroke");
        let mut timed = |step: fn(&mut Session) -> bool| {
            let begin = Instant::now();
            assert!(step(&mut session));
            begin.elapsed().as_secs_f64()
        };
        let mut undo = Vec::new();
        let mut redo = Vec::new();
        for _ in 0..9 {
            undo.push(timed(|session| session.undo().expect("no stroke")));
            redo.push(timed(|session| session.redo().expect("no stroke")));
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

    /// Vertices moved by the move in the middle.
    fn touched(&self) -> f64 {
        self.percentile(0.5, |(_, receipt)| receipt.moved_vertices as f64)
    }

    fn percentile(&self, share: f64, figure: impl Fn(&(f64, MoveReceipt)) -> f64) -> f64 {
        let mut figures: Vec<f64> = self.moves.iter().map(figure).collect();
        figures.sort_unstable_by(f64::total_cmp);
        figures[(share * (figures.len() - 1) as f64) as usize]
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

/// A cube blown up, its cells at equal angles seen from the middle of a face, so that they are of much the same size.
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

/// A hand that rubs as a host at 60 frames a second records it: to and fro across its way and slowly along it, now quicker, now
/// slower, in and out, and turning. It goes by up to four time steps a move.
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
