//! Sculpts a sphere by many strokes, and prints what they leave as a table.
//!
//! `session_tracks [mixed|follow] [STROKES] [LEVEL]`. `mixed`: presses and drags in turn at places all
//! around. `follow`: drags on tracks that overlap. A drag moves a ball of radius and support 0.1 in
//! twenty moves along the surface of the sphere, 0.01 deep. `LEVEL` is the level of the icosphere of
//! radius 1.
#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use isochore_field::Pose;
use isochore_mesh::{NoProgress, primitives::icosphere};
use isochore_sculpt::{
    Measures, Meshes,
    recipe::{Profile, Sphere, Tool, ToolShape},
    session::{Session, SessionOptions, SessionTool, StrokeOptions},
};

/// Moves of one stroke.
const MOVES: usize = 20;

/// Radius and support of the ball.
const RADIUS: f64 = 0.1;

/// Height of the center of the ball over the sphere during a drag.
const HEIGHT: f64 = 0.09;

/// Depth of the center of the ball at the end of a press.
const DEPTH: f64 = 0.03;

/// Rows of the table.
const ROWS: usize = 8;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, default: usize| {
        arguments.get(index).map_or(default, |text| text.parse().expect("arguments must be numbers"))
    };
    let is_mixed = arguments.first().is_none_or(|kind| kind == "mixed");
    let (strokes, level) = (number(1, 20), number(2, 5));
    let mut session = Session::open(icosphere(1.0, level as u32), SessionOptions::default()).expect("opens");
    let shape = ToolShape::Sphere(Sphere { radius: RADIUS });
    let tool = Tool { shape, support: RADIUS, profile: Profile::Quintic, free_form: 0.0 };
    let tool = Arc::new(SessionTool::new("ball", tool, &Meshes::new(), &NoProgress).expect("is a tool"));
    println!(
        "| strokes | triangles | crossing | with an angle below 5° | median move | longest move | longest end | stopped |"
    );
    println!("|---:|---:|---:|---:|---:|---:|---:|---:|");
    let (mut moves, mut longest_end, mut stopped) = (Vec::new(), 0.0_f64, 0);
    for index in 0..strokes {
        session.begin_stroke(&tool, StrokeOptions::default()).expect("begins");
        for step in 0..MOVES {
            let at = if is_mixed { mixed(index, step) } else { follow(index, step) };
            moves.push(timed(|| _ = session.move_to(&Pose::at(at), step as f64).expect("moves")));
        }
        let mut receipt = None;
        longest_end = longest_end.max(timed(|| receipt = session.end_stroke().ok()));
        stopped += usize::from(receipt.is_some_and(|receipt| receipt.stopped_at.is_some()));
        if (index + 1).is_multiple_of(strokes.div_ceil(ROWS)) {
            moves.sort_by(f64::total_cmp);
            let [flow, shown] = [false, true].map(|is_locked| {
                Measures::of(&session.export(is_locked).mesh, &NoProgress).expect("triangles are valid")
            });
            println!(
                "| {} | {} | {} | {:.2} % | {:.1} ms | {:.0} ms | {longest_end:.0} ms | {stopped} |",
                index + 1,
                session.triangle_count(),
                flow.self_intersecting_triangles.max(shown.self_intersecting_triangles),
                100.0 * flow.angle_below_5_degrees,
                moves[moves.len() / 2],
                moves[moves.len() - 1],
            );
            (longest_end, stopped) = (0.0, 0);
            moves.clear();
        }
    }
}

/// A drag along one of twelve tracks.
fn follow(index: usize, step: usize) -> DVec3 {
    let row = 0.05 * (index % 12) as f64 - 0.025 * (index / 12) as f64;
    let [x, y] = [0.04 * step as f64 - 0.4, row];
    (1.0 + HEIGHT) * DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// A press or, after it, a drag, at a place of a spiral around the sphere.
fn mixed(index: usize, step: usize) -> DVec3 {
    // The golden angle spreads the places evenly.
    let turn = 2.399_963_229_728_653 * index as f64;
    let height = 0.95 - 1.9 * (0.618_033_988_749_894_9 * index as f64).fract();
    let ring = (1.0 - height * height).sqrt();
    let place = DVec3::new(ring * libm::cos(turn), ring * libm::sin(turn), height);
    let along = place.any_orthonormal_vector();
    let fraction = step as f64 / (MOVES - 1) as f64;
    if index.is_multiple_of(2) {
        place * (1.0 + 2.0 * RADIUS - fraction * (RADIUS + DEPTH))
    } else {
        (1.0 + HEIGHT) * (place + 0.4 * (fraction - 0.5) * along).normalize()
    }
}

/// Wall time of `work` in milliseconds.
fn timed(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    1e3 * start.elapsed().as_secs_f64()
}
