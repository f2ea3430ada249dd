//! A closed spine whose rotation-minimizing frame does not close, and frames that do: with the
//! minimal twist and with one and two additional turns, proportional to the turning angle and to
//! arc length (figure 13 of Wang et al. 2008).

use std::error::Error;

use glam::DVec3;
use isochore_curve::{
    Curve, Frame, FrameMethod, Spine, TrigonometricCurve, TrigonometricTerm, TwistLaw, close_frames, closing_angle,
    rotation_minimizing_frames, total_angular_speed, total_squared_angular_speed,
};
use isochore_examples::{Stations, joined, save_figure, small, strap, swept_body};
use isochore_mesh::TriMesh;
use isochore_picture::{Body, Camera, Options, Paint, Panel};

const SEGMENTS: usize = 600;

fn main() -> Result<(), Box<dyn Error>> {
    let curve = bent_ellipse();
    let spine = Spine::sample(&curve, SEGMENTS)?;
    let start = curve.jet(0.0).normal().ok_or("the curve is straight at its start")?;
    let frames = rotation_minimizing_frames(&spine, start, FrameMethod::DoubleReflection, Default::default())?.stations;
    for (name, law) in [("closed_frames_turning", TwistLaw::Curvature), ("closed_frames_arc", TwistLaw::ArcLength)] {
        let mut bodies = vec![(
            format!("rotation-minimizing\ngap {:.4} rad", closing_angle(&frames)),
            banded(&spine, &frames, false),
        )];
        for turns in 0..=2 {
            let twisted = close_frames(&spine, &frames, law, turns);
            let gap = closing_angle(&twisted.stations).abs();
            let speed = total_angular_speed(&spine, &twisted.angles);
            let squared = total_squared_angular_speed(&spine, &twisted.angles);
            bodies.push((
                format!("{turns} additional turns: gap {}\nspeed {speed:.3}, squared {squared:.3}", small(gap)),
                banded(&spine, &twisted.stations, true),
            ));
        }
        let panels: Vec<Panel> = bodies
            .iter()
            .map(|(caption, (mesh, colors))| {
                Panel::new(caption.clone()).with(Body::new(mesh).with_paint(Paint::Triangles(colors)))
            })
            .collect();
        let camera = Camera::from_direction(DVec3::new(0.25, -0.7, 1.1));
        let options = Options { width: 2000, height: 560, ..Options::default() };
        let all = bodies.iter().skip(1).fold(TriMesh::default(), |all, (_, (mesh, _))| joined(all, mesh));
        save_figure(name, &all, &panels, &camera, &options)?;
    }
    Ok(())
}

/// A closed space curve with two sharp and two gentle bends.
fn bent_ellipse() -> TrigonometricCurve {
    let term = |frequency, cosine, sine| TrigonometricTerm { frequency, cosine, sine };
    TrigonometricCurve::new(
        vec![
            term(1.0, DVec3::X * 2.0, DVec3::Y),
            term(2.0, DVec3::Z * 0.2, DVec3::Z * 0.5),
            term(3.0, DVec3::Z * 0.25, DVec3::ZERO),
        ],
        DVec3::ZERO,
        (0.0, std::f64::consts::TAU),
        true,
    )
}

/// A swept strap with one red side.
fn banded(spine: &Spine, frames: &[Frame], closes: bool) -> (TriMesh, Vec<DVec3>) {
    let stations: Stations = (0..).map(|station| spine.point(station)).zip(frames.iter().copied()).collect();
    let mesh = swept_body(&stations, &strap(0.36, 0.07), closes);
    let (red, pale) = (DVec3::new(0.55, 0.06, 0.03), DVec3::new(0.62, 0.55, 0.42));
    // A row has four cells of two triangles; the first cell is on the upper side.
    let colors = (0..mesh.triangles.len()).map(|triangle| if (triangle / 2) % 4 == 0 { red } else { pale }).collect();
    (mesh, colors)
}
