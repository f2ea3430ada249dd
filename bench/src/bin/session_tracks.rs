//! Sculpts a sphere by many strokes that follow its surface, and reports what they leave.
//!
//! `session_tracks [tracks|mixed] [STROKES] [LEVEL]`. `tracks`: a ball of radius and support 0.1 is
//! dragged along the surface in twenty moves, on overlapping tracks. `mixed`: presses and drags in
//! turn at places all around. `LEVEL` is the level of the icosphere of radius 1.
#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use isochore_field::Pose;
use isochore_mesh::{NoProgress, SelfIntersections, TriMesh, primitives::icosphere};
use isochore_sculpt::{
    Meshes,
    recipe::{Profile, Sphere, Tool, ToolShape},
    session::{Session, SessionOptions, SessionTool, StrokeOptions},
};

/// Moves of one stroke.
const MOVES: usize = 20;

/// Radius and support of the ball.
const RADIUS: f64 = 0.1;

/// Height of the center of the ball over the surface during a drag.
const HEIGHT: f64 = 0.09;

/// Depth of the center of the ball at the end of a press.
const DEPTH: f64 = 0.03;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, default: usize| {
        arguments.get(index).map_or(default, |text| text.parse().expect("arguments must be numbers"))
    };
    let is_mixed = arguments.first().is_some_and(|kind| kind == "mixed");
    let (strokes, level) = (number(1, 20), number(2, 5));
    let mut session = Session::open(icosphere(1.0, level as u32), SessionOptions::default()).expect("opens");
    let shape = ToolShape::Sphere(Sphere { radius: RADIUS });
    let tool = Tool { shape, support: RADIUS, profile: Profile::Quintic, free_form: 0.0 };
    let tool = Arc::new(SessionTool::new("ball", tool, &Meshes::new(), &NoProgress).expect("is a tool"));
    println!(
        "stroke, triangles, crossing (flow, shown), angles below 5°, moves: median, longest, end (ms), stopped at"
    );
    for index in 0..strokes {
        session.begin_stroke(&tool, StrokeOptions::default()).expect("begins");
        let mut times: Vec<f64> = (0..MOVES)
            .map(|step| {
                let at = if is_mixed { mixed(&session, index, step) } else { track(&session, index, step) };
                timed(|| _ = session.move_to(&Pose::at(at), step as f64).expect("moves"))
            })
            .collect();
        times.sort_by(f64::total_cmp);
        let mut receipt = None;
        let end = timed(|| receipt = session.end_stroke().ok());
        let [shown, flow] = [true, false].map(|is_locked| session.export(is_locked).mesh);
        let [shown_crossing, crossing] = [&shown, &flow].map(crossing_triangles);
        println!(
            "{index:4}, {:8}, {crossing}, {shown_crossing}, {:.3} %, {:7.2}, {:7.2}, {end:7.2}, {:?}",
            session.triangle_count(),
            100.0 * small_angles(&flow),
            times[MOVES / 2],
            times[MOVES - 1],
            receipt.and_then(|receipt| receipt.stopped_at),
        );
    }
}

/// A drag along one of twelve tracks, over the surface as it is now.
fn track(session: &Session, index: usize, step: usize) -> DVec3 {
    let row = 0.05 * (index % 12) as f64 - 0.025 * (index / 12) as f64;
    let from = DVec3::new(-0.4 + 0.04 * step as f64, row, 3.0);
    let hit = session.pick(from, DVec3::NEG_Z).expect("is over the sphere");
    hit.point + HEIGHT * DVec3::Z
}

/// A press or, after it, a drag, at a place of a spiral around the sphere.
fn mixed(session: &Session, index: usize, step: usize) -> DVec3 {
    // The golden angle spreads the places evenly.
    let turn = 2.399_963_229_728_653 * index as f64;
    let height = 0.95 - 1.9 * (0.618_033_988_749_894_9 * index as f64).fract();
    let ring = (1.0 - height * height).sqrt();
    let place = DVec3::new(ring * libm::cos(turn), ring * libm::sin(turn), height);
    let along = place.any_orthonormal_vector();
    let fraction = step as f64 / (MOVES - 1) as f64;
    let toward = if index % 2 == 0 { place } else { (place + 0.4 * (fraction - 0.5) * along).normalize() };
    let hit = session.pick(3.0 * toward, -toward).expect("is over the sphere");
    if index % 2 == 0 {
        place * (1.0 + 2.0 * RADIUS - fraction * (RADIUS + DEPTH))
    } else {
        hit.point + HEIGHT * toward
    }
}

/// Wall time of `work` in milliseconds.
fn timed(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    1e3 * start.elapsed().as_secs_f64()
}

fn crossing_triangles(mesh: &TriMesh) -> usize {
    SelfIntersections::of(mesh, &NoProgress).map_or(0, |found| found.triangles().len())
}

/// Fraction of all angles that are below 5°.
fn small_angles(mesh: &TriMesh) -> f64 {
    let angles = (0..mesh.triangles.len()).flat_map(|triangle| {
        let corners = mesh.corners(triangle);
        [0, 1, 2].map(|side| {
            let [a, b, c] = [0, 1, 2].map(|step| corners[(side + step) % 3]);
            (b - a).angle_between(c - a)
        })
    });
    let small = angles.filter(|angle| !(*angle >= 5_f64.to_radians())).count();
    small as f64 / (3 * mesh.triangles.len()) as f64
}
