//! The body of a dragon along a spine. A twisted frame keeps the crest upright at the tail and at
//! the head (figure 7.4 of Zheng's thesis).

use std::error::Error;

use glam::{DVec2, DVec3};
use isochore_curve::{
    ArcLength, CubicSpline, Curve, EndCondition, Frame, FrameMethod, Parametrization, Spine, TwistLaw,
    meet_end_direction, rotation_minimizing_frames,
};
use isochore_examples::{Stations, save_figure, small, varying_body};
use isochore_mesh::TriMesh;
use isochore_picture::{Body, Camera, Options, Paint, Panel};

const SEGMENTS: usize = 900;
const COLUMNS: usize = 40;

/// Number of stations between two spikes of the crest.
const SPIKE: usize = 18;

fn main() -> Result<(), Box<dyn Error>> {
    let points = [
        (0.0, 0.0, 0.2),
        (1.0, 0.8, 0.9),
        (2.2, 0.2, 1.6),
        (2.6, -1.0, 0.9),
        (1.6, -1.4, 0.1),
        (1.2, -0.2, 0.0),
        (2.6, 0.9, 0.5),
        (4.0, 0.4, 1.5),
        (4.4, -0.6, 2.3),
        (3.6, -1.0, 3.0),
        (3.0, -0.2, 3.3),
        (3.8, 0.5, 3.5),
        (4.8, 0.3, 3.4),
    ]
    .map(|(x, y, z)| DVec3::new(x, y, z));
    let curve = CubicSpline::open(&points, Parametrization::Centripetal, EndCondition::NotAKnot)?;
    let length = ArcLength::new(&curve);
    let stations = (0..=SEGMENTS).map(|i| length.parameter_at(length.total() * i as f64 / SEGMENTS as f64));
    let spine = Spine::from_jets(stations.map(|u| curve.jet(u)), false)?;
    let minimizing =
        rotation_minimizing_frames(&spine, DVec3::Z, FrameMethod::DoubleReflection, Default::default())?.stations;
    let twisted = meet_end_direction(&spine, &minimizing, DVec3::Z, TwistLaw::ArcLength, 0)?;
    let off = |frames: &[Frame]| frames[SEGMENTS].angle_to(DVec3::Z).abs();
    let bodies = [
        (
            format!("rotation-minimizing: the crest at the head is off by {:.3} rad", off(&minimizing)),
            dragon(&spine, &minimizing),
        ),
        (
            format!(
                "twisted by {:.3} rad in total: off by {} rad",
                twisted.angles[SEGMENTS].abs(),
                small(off(&twisted.stations))
            ),
            dragon(&spine, &twisted.stations),
        ),
    ];
    let panels: Vec<Panel> = bodies
        .iter()
        .map(|(caption, (mesh, colors))| {
            Panel::new(caption.clone()).with(Body::new(mesh).with_paint(Paint::Vertices(colors)))
        })
        .collect();
    let camera = Camera::from_direction(DVec3::new(0.4, -1.6, 0.7));
    let options = Options { width: 1800, height: 860, ..Options::default() };
    save_figure("dragon", &bodies[1].1.0, &panels, &camera, &options)
}

/// The body, with its crest in the direction of r.
fn dragon(spine: &Spine, frames: &[Frame]) -> (TriMesh, Vec<DVec3>) {
    let stations: Stations = (0..).map(|station| spine.point(station)).zip(frames.iter().copied()).collect();
    let mesh = varying_body(&stations, COLUMNS, |row, column| {
        let radius = radius(row);
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * column as f64 / COLUMNS as f64);
        // The crest is a sawtooth along the back that leans toward the tail.
        let spike = if column == 0 { 0.9 * (row % SPIKE) as f64 / SPIKE as f64 } else { 0.0 };
        DVec2::new(cos + spike, 0.85 * sin) * radius
    });
    let (gold, green, pale) =
        (DVec3::new(0.75, 0.42, 0.03), DVec3::new(0.03, 0.22, 0.10), DVec3::new(0.60, 0.45, 0.15));
    let colors = (0..=SEGMENTS)
        .flat_map(|row| {
            (0..COLUMNS).map(move |column| match column {
                0 => gold,
                15..=25 => pale,
                _ if (row / 6 + column) % 4 == 0 => green * 0.5,
                _ => green,
            })
        })
        .collect();
    (mesh, colors)
}

/// Radius: thin at the tail, largest at two thirds, rounded at the head.
fn radius(row: usize) -> f64 {
    let fraction = row as f64 / SEGMENTS as f64;
    let to_end = ((fraction - 0.94) / 0.06).max(0.0);
    let round = (1.0 - to_end * to_end).max(0.0004).sqrt();
    (0.012 + 0.24 * libm::sin(std::f64::consts::PI * fraction * (0.35 + 0.45 * fraction))) * round
}
