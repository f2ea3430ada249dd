//! A rocker arm: a hub with a bore, a bored boss at one end, a pad at the other, webs in between.

use glam::{DVec2, DVec3};

use super::solid::{difference, extruded, limb, rounded_box, union, union_of};

/// Centers of the boss and of the pad; the hub is at the origin, its bore along z.
const BOSS: DVec3 = DVec3::new(-1.05, 0.22, 0.0);
const PAD: DVec3 = DVec3::new(0.98, 0.12, 0.0);

/// A round bar along z.
fn bar(point: DVec3, center: DVec3, radius: f64, half_length: f64, rounding: f64) -> f64 {
    let flat = DVec2::new(point.x - center.x, point.y - center.y);
    extruded(flat.length() - radius, point.z, half_length, rounding)
}

/// An arm of flat section from the hub to `end`.
fn arm(point: DVec3, end: DVec3, radii: [f64; 2], half_thickness: f64) -> f64 {
    let flat = limb(DVec3::new(point.x, point.y, 0.0), [DVec3::ZERO, end], radii);
    extruded(flat, point.z, half_thickness, 0.07)
}

/// The rocker arm.
pub(crate) fn rocker_arm(point: DVec3) -> f64 {
    let hub = bar(point, DVec3::ZERO, 0.42, 0.34, 0.08);
    let boss = bar(point, BOSS, 0.26, 0.25, 0.07);
    let arms = union(arm(point, BOSS, [0.33, 0.20], 0.17), arm(point, PAD, [0.33, 0.17], 0.17), 0.05);
    let foot = rounded_box(point, PAD - DVec3::new(0.0, 0.10, 0.0), DVec3::new(0.16, 0.24, 0.21), 0.07);
    let tip = bar(point, PAD - DVec3::new(0.0, 0.32, 0.0), 0.17, 0.21, 0.06);
    let solid = union_of([hub, boss, arms, union(foot, tip, 0.12)], 0.20);

    // Pockets on both faces leave ribs along the edges of the arms.
    let mirrored = DVec3::new(point.x, point.y, point.z.abs() - 0.20);
    let pocket = |start: f64, end: f64, along: DVec3, radii: [f64; 2]| {
        let flat = limb(DVec3::new(point.x, point.y, 0.0), [start * along, end * along], radii);
        extruded(flat, mirrored.z, 0.11, 0.05)
    };
    let pockets = pocket(0.50, 0.68, BOSS, [0.135, 0.11]).min(pocket(0.52, 0.72, PAD, [0.115, 0.085]));
    let bores = bar(point, DVec3::ZERO, 0.23, 1.0, 0.0).min(bar(point, BOSS, 0.125, 1.0, 0.0));
    difference(difference(solid, pockets, 0.10), bores, 0.14)
}
