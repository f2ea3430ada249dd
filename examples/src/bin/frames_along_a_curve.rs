//! Computes rotation-minimizing frames along a torus knot, measures their error and order, closes
//! them, and sweeps a strap.

#![expect(clippy::print_stdout, reason = "the measurements are the result")]

use std::{error::Error, f64::consts::TAU};

use glam::DVec3;
use isochore_curve::{
    FrameMethod, Spine, TrigonometricCurve, TwistLaw, close_frames, closing_angle, exact_frames,
    rotation_minimizing_frames,
};
use isochore_examples::{Stations, save_mesh, strap, swept_body};

fn main() -> Result<(), Box<dyn Error>> {
    let knot = TrigonometricCurve::torus_knot();
    let start = DVec3::NEG_X;
    let exact = exact_frames(&knot, &[0.0, TAU], start)?[1];

    // Double reflection has order four: twice the segments give a sixteenth of the error.
    let mut last: Option<f64> = None;
    for segments in [128, 256, 512] {
        let spine = Spine::sample(&knot, segments)?;
        let frames = rotation_minimizing_frames(&spine, start, FrameMethod::DoubleReflection, Default::default())?;
        let error = exact.angle_to(frames.stations[segments].r).abs();
        let order = last.map_or("-".to_owned(), |last| format!("{:.2}", libm::log2(last / error)));
        println!("{segments} segments: error {error:.2e} rad, order {order}");
        last = Some(error);
    }

    // After one turn the frames differ by an angle. A twist proportional to arc length closes them.
    let spine = Spine::sample(&knot, 512)?;
    let open = rotation_minimizing_frames(&spine, start, FrameMethod::DoubleReflection, Default::default())?.stations;
    let closed = close_frames(&spine, &open, TwistLaw::ArcLength, 0).stations;
    println!("closing angle: {:.4} rad before, {:.1e} rad after", closing_angle(&open), closing_angle(&closed).abs());

    let stations: Stations = (0..).map(|station| spine.point(station)).zip(closed).collect();
    let body = swept_body(&stations, &strap(0.3, 0.06), true);
    println!("swept strap: {} triangles, volume {:.4}", body.triangles.len(), body.volume());
    save_mesh("frames_along_a_curve", &body)
}
