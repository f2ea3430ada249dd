//! What it costs to carry what is left alone, and what goes with the tool.

use std::sync::Arc;

use glam::DVec3;
use isochore_bench::{interleaved_medians, print_row};
use isochore_field::{Move, Pose, Profile, Stroke, Tool, advect_points};
use isochore_mesh::{NoProgress, Sphere, primitives};

pub(crate) fn run() {
    let points = primitives::latitude_longitude_sphere(1.0, 800, 701).positions;
    // Ways of eight segments of a ball of this radius, whose support reaches half as far again.
    let dent = |radius: f64| {
        let tool = Tool::new(Arc::new(Sphere::new(radius).expect("a radius")), 0.5 * radius, Profile::Quintic);
        let keys = (0..=8).map(|key| Pose::at(DVec3::new(1.0 + radius - 0.125 * radius * f64::from(key), 0.0, 0.0)));
        Stroke::Move(Move::new(Arc::new(tool.expect("a support")), keys.collect(), 0.125).expect("a way"))
    };
    let core = {
        let tool = Tool::new(Arc::new(Sphere::new(1.5).expect("a radius")), 0.5, Profile::Quintic);
        let keys = vec![Pose::IDENTITY, Pose::at(DVec3::Z)];
        Stroke::Move(Move::new(Arc::new(tool.expect("a support")), keys, 0.125).expect("a way"))
    };
    let strokes = [("a hundredth", dent(0.2)), ("a tenth", dent(0.6)), ("in the core", core)];

    print_row(["touched", "points moved", "ms", "ns/point", "ns/point/step"]);
    for (name, stroke) in strokes {
        let carry = || advect_points(&points, std::slice::from_ref(&stroke), &NoProgress).expect("nothing cancels");
        let moved = points.iter().zip(carry()).filter(|&(&before, after)| before != after).count();
        let seconds = interleaved_medians(&mut [&mut || drop(std::hint::black_box(carry()))])[0];
        let Stroke::Move(way) = &stroke else { unreachable!("all are moves") };
        let nanoseconds = 1e9 * seconds / points.len() as f64;
        print_row([
            name,
            &moved.to_string(),
            &format!("{:.2}", 1e3 * seconds),
            &format!("{nanoseconds:.1}"),
            &format!("{:.2}", nanoseconds / way.steps() as f64),
        ]);
    }
    println!();
}
