//! Frame rate of advection: one Runge-Kutta step of an analytic tool that touches the whole object.
//!
//! Compared with the frame rates of the thesis for objects with the same number of triangles (D.
//! Zheng, 2008, table 13.1, on a 2.66 GHz Xeon). Those frames include rendering, so the ratio is
//! only context.

use std::sync::Arc;

use glam::DVec3;
use isochore_bench::{interleaved_medians, print_row};
use isochore_field::{Move, Pose, Profile, Stroke, Tool, advect_points};
use isochore_mesh::{NoProgress, Sphere, primitives};

pub(crate) fn run() {
    print_row(["triangles", "frames/s", "thesis frames/s", "ratio", "M vertex-steps/s"]);
    for (longitude, latitude, thesis) in [(80, 71, 78.0), (140, 121, 39.0), (150, 146, 30.0)] {
        let object = primitives::latitude_longitude_sphere(1.0, longitude, latitude);
        let step = one_step();
        let mut frame = || {
            std::hint::black_box(advect_points(&object.positions, std::slice::from_ref(&step), &NoProgress))
                .expect("the advection is not canceled");
        };
        let seconds = interleaved_medians(&mut [&mut frame])[0];
        print_row([
            &object.triangles.len().to_string(),
            &format!("{:.0}", 1.0 / seconds),
            &format!("{thesis:.0}"),
            &format!("{:.1}", 1.0 / seconds / thesis),
            &format!("{:.1}", 1e-6 * object.positions.len() as f64 / seconds),
        ]);
    }
    println!();
}

/// Moves a ball inside the unit sphere by less than one step. Its support contains the whole
/// sphere.
fn one_step() -> Stroke {
    let ball = Sphere::new(0.5).expect("a positive radius");
    let tool = Arc::new(Tool::new(Arc::new(ball), 1.0, Profile::Quintic).expect("a positive support"));
    let keys = vec![Pose::IDENTITY, Pose::at(DVec3::Z * 0.05)];
    let path = Move::new(tool, keys, 0.125).expect("a valid path");
    assert_eq!(path.steps(), 1, "a frame is one step");
    Stroke::Move(path)
}
