//! A coin with relief.

use glam::{DVec2, DVec3};

use super::solid::{extruded, intersection, polygon, smooth_step};

/// Width of the flanks of the relief, and its height.
const FLANK: f64 = 0.13;
const RELIEF: f64 = 0.07;

/// A coin in the plane z = 0: a raised rim and a star on the front, a ring on the back.
pub(crate) fn coin(point: DVec3) -> f64 {
    let flat = DVec2::new(point.x, point.y);
    let radius = flat.length();
    let raised = |distance: f64| 1.0 - smooth_step(-0.5 * FLANK, 0.5 * FLANK, distance);

    let rim = raised(0.84 - radius);
    let star: [DVec2; 10] = std::array::from_fn(|corner| {
        let (sine, cosine) = libm::sincos(corner as f64 * std::f64::consts::PI / 5.0);
        let reach = if corner % 2 == 0 { 0.66 } else { 0.29 };
        reach * DVec2::new(sine, cosine)
    });
    let emblem = if point.z > 0.0 { raised(polygon(flat, &star)) } else { raised((radius - 0.45).abs() - 0.09) };
    let height = 0.11 + RELIEF * (rim + emblem);
    // The flanks of the relief rise by up to 1.5 RELIEF/FLANK: the vertical distance is that much too large.
    let slope = 1.5 * RELIEF / FLANK;
    let faces = (point.z.abs() - height) / (1.0 + slope * slope).sqrt();
    let edge = extruded(radius - 1.0, point.z, 0.19, 0.07);
    intersection(faces, edge, 0.05)
}
