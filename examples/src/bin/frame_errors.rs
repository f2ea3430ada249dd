//! The torus knot, swept with frames of four methods and colored by their error (figures 6.5 to 6.8
//! of Zheng's thesis).

use std::error::Error;

use glam::DVec3;
use isochore_curve::{
    Frame, FrameMethod, Spine, TrigonometricCurve, exact_frames, rotation_minimizing_frames, runge_kutta_frames,
    uniform_parameters,
};
use isochore_examples::{Stations, save_figure, scale_color, strap, swept_body};
use isochore_mesh::TriMesh;
use isochore_picture::{Body, Camera, Options, Paint, Panel};

const SEGMENTS: usize = 256;

/// Errors at the ends of the color scale, radians.
const SCALE: (f64, f64) = (1e-8, 1e-1);

fn main() -> Result<(), Box<dyn Error>> {
    let knot = TrigonometricCurve::torus_knot();
    let start = -DVec3::X;
    let parameters = uniform_parameters(&knot, SEGMENTS);
    let exact = exact_frames(&knot, &parameters, start)?;
    let spine = Spine::sample(&knot, SEGMENTS)?;
    let sampled =
        |method| rotation_minimizing_frames(&spine, start, method, Default::default()).map(|frames| frames.stations);
    let methods = [
        ("double reflection", sampled(FrameMethod::DoubleReflection)?),
        ("Runge-Kutta", runge_kutta_frames(&knot, &parameters, start)?),
        ("projection", sampled(FrameMethod::Projection)?),
        ("rotation", sampled(FrameMethod::Rotation)?),
    ];
    let bodies: Vec<(String, TriMesh, Vec<DVec3>)> =
        methods.iter().map(|(name, frames)| colored(name, &spine, frames, &exact)).collect();
    let panels: Vec<Panel> = bodies
        .iter()
        .map(|(caption, mesh, colors)| {
            Panel::new(caption.clone()).with(Body::new(mesh).with_paint(Paint::Vertices(colors)))
        })
        .collect();
    let camera = Camera::from_direction(DVec3::new(0.5, -0.8, 1.6));
    let options = Options { width: 2000, height: 620, ..Options::default() };
    save_figure("frame_errors", &bodies[0].1, &panels, &camera, &options)
}

/// The swept strap with one color per vertex, by the logarithm of the error.
fn colored(name: &str, spine: &Spine, frames: &[Frame], exact: &[Frame]) -> (String, TriMesh, Vec<DVec3>) {
    let errors: Vec<f64> = frames.iter().zip(exact).map(|(frame, exact)| exact.angle_to(frame.r).abs()).collect();
    let largest = errors.iter().copied().fold(0.0, f64::max);
    let stations: Stations = (0..).map(|station| spine.point(station)).zip(frames.iter().copied()).collect();
    let mesh = swept_body(&stations, &strap(0.16, 0.02), false);
    let (low, high) = SCALE;
    let colors = errors
        .iter()
        .flat_map(|error| {
            let fraction = libm::log(error.max(low) / low) / libm::log(high / low);
            [scale_color(fraction); 4]
        })
        .collect();
    (format!("{name}\nlargest error {largest:.2e} rad"), mesh, colors)
}
