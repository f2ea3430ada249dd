//! The cinquefoil and the trefoil knot, swept with closed rotation-minimizing frames and with
//! Frenet frames (figures 7.2 and 7.3 of Zheng's thesis).

use std::error::Error;

use glam::DVec3;
use isochore_curve::{
    Frame, FrameMethod, Spine, TrigonometricCurve, TwistLaw, close_frames, frenet_frames, rotation_minimizing_frames,
    total_torsion, uniform_parameters,
};
use isochore_examples::{Stations, save_figure, strap, swept_body, total_turning};
use isochore_mesh::TriMesh;
use isochore_picture::{Body, Camera, Options, Paint, Panel};

const SEGMENTS: usize = 1500;

fn main() -> Result<(), Box<dyn Error>> {
    draw("cinquefoil", &TrigonometricCurve::cinquefoil(), 0.4, DVec3::new(0.2, -0.7, 1.2))?;
    draw("trefoil", &TrigonometricCurve::trefoil(), 40.0, DVec3::new(1.0, 1.0, 1.0))
}

fn draw(name: &str, curve: &TrigonometricCurve, width: f64, view: DVec3) -> Result<(), Box<dyn Error>> {
    let spine = Spine::sample(curve, SEGMENTS)?;
    let frenet = frenet_frames(curve, &uniform_parameters(curve, SEGMENTS))?;
    let minimizing =
        rotation_minimizing_frames(&spine, frenet[0].r, FrameMethod::DoubleReflection, Default::default())?;
    let closed = close_frames(&spine, &minimizing.stations, TwistLaw::ArcLength, 0);
    let twist = closed.angles[SEGMENTS];
    // The Frenet frame rotates by the torsion; both directions of rotation count.
    let turning = total_turning(&frenet);
    let bodies = [
        (
            format!("{name}: closed rotation-minimizing frame\nuniform twist, {twist:.4} rad in total"),
            body(&spine, &closed.stations, width),
        ),
        (
            format!(
                "{name}: Frenet frame, total torsion {:.4} rad\nabsolute rotation {:.2} rad",
                total_torsion(curve),
                turning
            ),
            body(&spine, &frenet, width),
        ),
    ];
    let panels: Vec<Panel> = bodies
        .iter()
        .map(|(caption, (mesh, colors))| {
            Panel::new(caption.clone()).with(Body::new(mesh).with_paint(Paint::Triangles(colors)))
        })
        .collect();
    let options = Options { width: 1600, height: 860, ..Options::default() };
    save_figure(name, &bodies[0].1.0, &panels, &Camera::from_direction(view), &options)
}

/// A swept strap in two colors.
fn body(spine: &Spine, frames: &[Frame], width: f64) -> (TriMesh, Vec<DVec3>) {
    let stations: Stations = (0..).map(|station| spine.point(station)).zip(frames.iter().copied()).collect();
    let mesh = swept_body(&stations, &strap(width, 0.3 * width), true);
    let (blue, pale) = (DVec3::new(0.05, 0.14, 0.42), DVec3::new(0.62, 0.55, 0.42));
    let colors = (0..mesh.triangles.len()).map(|triangle| if (triangle / 2) % 4 == 0 { blue } else { pale }).collect();
    (mesh, colors)
}
