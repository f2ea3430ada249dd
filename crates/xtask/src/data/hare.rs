//! A sitting hare that faces along x, z upward from the ground at 0.

use glam::DVec3;

use super::solid::{chain, difference, ellipsoid, intersection, limb, sphere, union, union_of};

/// The hare.
pub(crate) fn hare(point: DVec3) -> f64 {
    // Both sides at once.
    let side = DVec3::new(point.x, point.y.abs(), point.z);
    let trunk = chain(
        point,
        &[
            (DVec3::new(-0.32, 0.0, 0.50), 0.46),
            (DVec3::new(0.05, 0.0, 0.58), 0.40),
            (DVec3::new(0.34, 0.0, 0.72), 0.29),
        ],
        0.10,
    );
    let haunch = ellipsoid(side, DVec3::new(-0.30, 0.30, 0.36), DVec3::new(0.36, 0.23, 0.34));
    let hind_foot = limb(side, [DVec3::new(-0.42, 0.38, 0.09), DVec3::new(0.12, 0.40, 0.08)], [0.12, 0.10]);
    let fore_leg = chain(
        side,
        &[
            (DVec3::new(0.38, 0.17, 0.58), 0.155),
            (DVec3::new(0.44, 0.17, 0.14), 0.105),
            (DVec3::new(0.58, 0.17, 0.08), 0.095),
        ],
        0.06,
    );
    let tail = sphere(point, DVec3::new(-0.84, 0.0, 0.36), 0.18);
    let body = union_of([union(trunk, haunch, 0.14), hind_foot, fore_leg, tail], 0.16);

    let skull = ellipsoid(point, DVec3::new(0.56, 0.0, 1.16), DVec3::new(0.31, 0.25, 0.265));
    let snout = ellipsoid(point, DVec3::new(0.80, 0.0, 1.07), DVec3::new(0.17, 0.155, 0.15));
    let cheek = sphere(side, DVec3::new(0.66, 0.12, 1.03), 0.15);
    let head = union_of([skull, snout, cheek], 0.16);
    let eye = sphere(side, DVec3::new(0.70, 0.205, 1.22), 0.065);
    let nose = sphere(point, DVec3::new(0.955, 0.0, 1.12), 0.05);

    // An ear is flat across and hollow in front.
    let ear = {
        let local = DVec3::new(1.5 * (side.x + 0.35 * side.z), side.y, side.z);
        let place = |x: f64, y: f64, z: f64| DVec3::new(1.5 * (x + 0.35 * z), y, z);
        let joints =
            [(place(0.42, 0.11, 1.34), 0.12), (place(0.28, 0.19, 1.66), 0.185), (place(0.17, 0.24, 2.00), 0.10)];
        chain(local, &joints, 0.16) / 1.5
    };
    let front = DVec3::new(0.075, 0.0, 0.03);
    let hollow = {
        let moved = side - front;
        let local = DVec3::new(1.5 * (moved.x + 0.35 * moved.z), moved.y, moved.z);
        let place = |x: f64, y: f64, z: f64| DVec3::new(1.5 * (x + 0.35 * z), y, z);
        limb(local, [place(0.31, 0.17, 1.56), place(0.20, 0.225, 1.88)], [0.085, 0.055]) / 1.5
    };
    let ears = difference(ear, hollow, 0.10);

    let whole = union_of([union(body, head, 0.24), ears, eye.min(nose)], 0.12);
    intersection(whole, -point.z, 0.14)
}
