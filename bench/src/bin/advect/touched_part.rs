//! Cost of advection for points outside the support and for points inside the core.

use std::sync::Arc;

use glam::DVec3;
use isochore_bench::{interleaved_medians, print_row};
use isochore_field::{Move, Pose, Profile, Stroke, Tool, advect_points};
use isochore_mesh::{NoProgress, Sphere, primitives};

pub(crate) fn run() {
    let points = primitives::latitude_longitude_sphere(1.0, 800, 701).positions;
    // A path of eight segments of a ball with this radius and a support of half the radius.
    let dent = |radius: f64| {
        let tool = Tool::new(Arc::new(Sphere::new(radius).expect("a positive radius")), 0.5 * radius, Profile::Quintic);
        let keys = (0..=8).map(|key| Pose::at(DVec3::new(1.0 + radius - 0.125 * radius * f64::from(key), 0.0, 0.0)));
        Stroke::Move(
            Move::new(Arc::new(tool.expect("a positive support")), keys.collect(), 0.125).expect("a valid path"),
        )
    };
    let core = {
        let tool = Tool::new(Arc::new(Sphere::new(1.5).expect("a positive radius")), 0.5, Profile::Quintic);
        let keys = vec![Pose::IDENTITY, Pose::at(DVec3::Z)];
        Stroke::Move(Move::new(Arc::new(tool.expect("a positive support")), keys, 0.125).expect("a valid path"))
    };
    let strokes = [("1/100 of points", dent(0.2)), ("1/10 of points", dent(0.6)), ("all, in the core", core)];

    print_row(["touched", "points moved", "ms", "ns/point", "ns/point/step"]);
    for (name, stroke) in strokes {
        let advect = || {
            advect_points(&points, std::slice::from_ref(&stroke), &NoProgress).expect("the advection is not canceled")
        };
        let moved = points.iter().zip(advect()).filter(|&(&before, after)| before != after).count();
        let seconds = interleaved_medians(&mut [&mut || drop(std::hint::black_box(advect()))])[0];
        let Stroke::Move(path) = &stroke else { unreachable!("all strokes are moves") };
        let nanoseconds = 1e9 * seconds / points.len() as f64;
        print_row([
            name,
            &moved.to_string(),
            &format!("{:.2}", 1e3 * seconds),
            &format!("{nanoseconds:.1}"),
            &format!("{:.2}", nanoseconds / path.steps() as f64),
        ]);
    }
    println!();
}
