//! A snake that is modeled along a straight axis and bent along a spine, with rotation-minimizing
//! and with Frenet frames (figure 1.1 of Zheng's thesis).

use std::error::Error;

use glam::{DVec2, DVec3};
use isochore_curve::{
    ArcLength, CubicSpline, Curve, EndCondition, Frame, FrameMethod, Parametrization, Spine, frenet_frames,
    rotation_minimizing_frames,
};
use isochore_examples::{Stations, save_figure, total_turning, varying_body};
use isochore_mesh::TriMesh;
use isochore_picture::{Body, Camera, Options, Paint, Panel};

const SEGMENTS: usize = 700;
const COLUMNS: usize = 128;

fn main() -> Result<(), Box<dyn Error>> {
    // A crawling snake with a raised head.
    let points = [
        (0.0, 0.0, 0.0),
        (0.9, 0.55, 0.0),
        (2.0, -0.55, 0.0),
        (3.1, 0.6, 0.0),
        (4.2, -0.5, 0.02),
        (5.1, 0.25, 0.15),
        (5.5, 0.35, 0.8),
        (5.3, 0.1, 1.5),
        (5.7, -0.2, 1.9),
        (6.4, -0.3, 1.85),
    ]
    .map(|(x, y, z)| DVec3::new(x, y, z));
    let curve = CubicSpline::open(&points, Parametrization::Centripetal, EndCondition::Natural)?;
    // Stations at equal arc lengths, as on the straight snake.
    let length = ArcLength::new(&curve);
    let parameters: Vec<f64> =
        (0..=SEGMENTS).map(|i| length.parameter_at(length.total() * i as f64 / SEGMENTS as f64)).collect();
    let spine = Spine::from_jets(parameters.iter().map(|&u| curve.jet(u)), false)?;
    let minimizing =
        rotation_minimizing_frames(&spine, DVec3::Z, FrameMethod::DoubleReflection, Default::default())?.stations;
    // A natural spline has zero curvature and no Frenet frame at its ends; the neighbors' frames
    // are used.
    let mut inner = parameters.clone();
    inner[0] = parameters[1];
    inner[SEGMENTS] = parameters[SEGMENTS - 1];
    let frenet = frenet_frames(&curve, &inner)?;
    let bodies = [("rotation-minimizing", &minimizing), ("Frenet", &frenet)].map(|(name, frames)| {
        let turning = total_turning(frames);
        (format!("{name}: total rotation about the spine {turning:.4} rad"), snake(&spine, frames))
    });
    let panels: Vec<Panel> = bodies
        .iter()
        .map(|(caption, (mesh, colors))| {
            Panel::new(caption.clone()).with(Body::new(mesh).with_paint(Paint::Vertices(colors)))
        })
        .collect();
    let camera = Camera::from_direction(DVec3::new(0.7, -1.5, 0.9));
    let options = Options { width: 2000, height: 640, ..Options::default() };
    save_figure("snake", &bodies[0].1.0, &panels, &camera, &options)
}

/// The snake, with its back in the direction of r.
fn snake(spine: &Spine, frames: &[Frame]) -> (TriMesh, Vec<DVec3>) {
    let stations: Stations = (0..).map(|station| spine.point(station)).zip(frames.iter().copied()).collect();
    let mesh = varying_body(&stations, COLUMNS, |row, column| {
        let (height, width) = size(row as f64 / SEGMENTS as f64);
        let (sin, cos) = libm::sincos(angle(column));
        // A flat belly.
        DVec2::new(height * if cos < 0.0 { 0.6 * cos } else { cos }, width * sin)
    });
    let colors = (0..=SEGMENTS).flat_map(|row| (0..COLUMNS).map(move |column| color(row, column))).collect();
    (mesh, colors)
}

fn angle(column: usize) -> f64 {
    std::f64::consts::TAU * column as f64 / COLUMNS as f64
}

/// Half height and half width along the snake, from tail to head.
fn size(fraction: f64) -> (f64, f64) {
    let body = 0.21 * (fraction * (1.6 - fraction)).max(0.0).sqrt().min(0.72);
    let past_neck = (fraction - 0.9) / 0.1;
    if past_neck <= 0.0 {
        return (body.max(0.004), body.max(0.004));
    }
    // The head widens and ends round.
    let round = (1.0 - past_neck * past_neck).max(0.0).sqrt();
    let swell = libm::sin(std::f64::consts::PI * past_neck.min(1.0));
    ((body * round + 0.02 * swell).max(0.004), (body * round + 0.09 * swell).max(0.004))
}

/// Diamonds along the back, a pale belly.
fn color(row: usize, column: usize) -> DVec3 {
    let (green, dark, pale) =
        (DVec3::new(0.10, 0.26, 0.06), DVec3::new(0.02, 0.045, 0.02), DVec3::new(0.62, 0.52, 0.28));
    let from_back = (angle(column) + std::f64::consts::PI) % std::f64::consts::TAU - std::f64::consts::PI;
    if from_back.abs() > 1.9 {
        return pale;
    }
    let along = (row as f64 / 22.0).fract() - 0.5;
    if from_back.abs() < 1.0 - 2.0 * along.abs() { dark } else { green }
}
