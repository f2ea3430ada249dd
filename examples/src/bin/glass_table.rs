//! The frame of a glass table: a closed rod with three contact lines at the glass and three at the
//! ground (figure 7.5 of Zheng's thesis).

use std::{error::Error, f64::consts::TAU};

use glam::DVec3;
use isochore_curve::{
    FrameMethod, Spine, TrigonometricCurve, TrigonometricTerm, TwistConstraint, TwistLaw, closing_angle,
    meet_constraints, rotation_minimizing_frames,
};
use isochore_examples::{Stations, save_figure, small, strap, swept_body};
use isochore_picture::{Body, Camera, Options, Panel};

const SEGMENTS: usize = 600;

/// Height and thickness of the rod, and radius of the glass.
const HEIGHT: f64 = 0.9;
const THICKNESS: f64 = 0.08;
const GLASS: f64 = 1.25;

fn main() -> Result<(), Box<dyn Error>> {
    let spine = Spine::sample(&ring(), SEGMENTS)?;
    let frames =
        rotation_minimizing_frames(&spine, DVec3::Z, FrameMethod::DoubleReflection, Default::default())?.stations;
    // At the alternating highest and lowest points, the flat side of the rod touches the glass and
    // the ground.
    let constraints: Vec<TwistConstraint> =
        (0..6).map(|i| TwistConstraint { station: i * SEGMENTS / 6, direction: DVec3::Z, turns: 0 }).collect();
    let twisted = meet_constraints(&spine, &frames, &constraints, TwistLaw::ArcLength)?;
    let outline = strap(THICKNESS, 2.5 * THICKNESS);
    let body = |frames: &[isochore_curve::Frame]| {
        let stations: Stations = (0..).map(|station| spine.point(station)).zip(frames.iter().copied()).collect();
        swept_body(&stations, &outline, true)
    };
    let tilt = |frames: &[isochore_curve::Frame]| {
        constraints.iter().map(|c| frames[c.station].angle_to(DVec3::Z).abs()).fold(0.0, f64::max)
    };
    let bodies = [
        (
            format!(
                "rotation-minimizing: error at most {:.3} rad at six contacts,\ngap {} rad by symmetry",
                tilt(&frames),
                small(closing_angle(&frames).abs())
            ),
            body(&frames),
        ),
        (
            format!(
                "six conditions: error at most {} rad,\ngap {} rad",
                small(tilt(&twisted.stations)),
                small(closing_angle(&twisted.stations).abs())
            ),
            body(&twisted.stations),
        ),
    ];
    let circle = |z: f64| -> Vec<DVec3> {
        (0..=120)
            .map(|i| libm::sincos(TAU * f64::from(i) / 120.0))
            .map(|(s, c)| DVec3::new(GLASS * c, GLASS * s, z))
            .collect()
    };
    let (top, ground) = (0.5 * (HEIGHT + THICKNESS), -0.5 * (HEIGHT + THICKNESS));
    let panels: Vec<Panel> = bodies
        .iter()
        .map(|(caption, mesh)| {
            Panel::new(caption.clone())
                .with(Body::new(mesh))
                .with(Body::polyline(&circle(top + 0.012), 0.012, DVec3::new(0.15, 0.45, 0.5)))
                .with(Body::polyline(&circle(ground - 0.006), 0.006, DVec3::splat(0.25)))
        })
        .collect();
    let camera = Camera::from_direction(DVec3::new(0.5, -1.4, 0.55));
    let options = Options { width: 1700, height: 700, ..Options::default() };
    save_figure("glass_table", &bodies[1].1, &panels, &camera, &options)
}

/// A ring that rises and falls three times and is wider at the bottom.
fn ring() -> TrigonometricCurve {
    let term = |frequency, cosine, sine| TrigonometricTerm { frequency, cosine, sine };
    // (1 − 0.2 cos 3θ)(cos θ, sin θ), (HEIGHT/2) cos 3θ
    TrigonometricCurve::new(
        vec![
            term(1.0, DVec3::X, DVec3::Y),
            term(4.0, DVec3::X * -0.1, DVec3::Y * -0.1),
            term(2.0, DVec3::X * -0.1, DVec3::Y * 0.1),
            term(3.0, DVec3::Z * 0.5 * HEIGHT, DVec3::ZERO),
        ],
        DVec3::ZERO,
        (0.0, TAU),
        true,
    )
}
