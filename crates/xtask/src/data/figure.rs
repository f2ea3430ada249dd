//! A standing figure, z upward from the soles at 0, facing -y.

use glam::DVec3;

use super::solid::{chain, ellipsoid, intersection, limb, sphere, union_of};

/// The figure.
pub(crate) fn figure(point: DVec3) -> f64 {
    // Both sides at once.
    let side = DVec3::new(point.x.abs(), point.y, point.z);
    let leg = chain(
        side,
        &[
            (DVec3::new(0.125, 0.0, 1.00), 0.150),
            (DVec3::new(0.165, -0.02, 0.56), 0.105),
            (DVec3::new(0.185, 0.02, 0.12), 0.070),
        ],
        0.12,
    );
    let calf = ellipsoid(side, DVec3::new(0.175, 0.035, 0.42), DVec3::new(0.088, 0.095, 0.17));
    let foot = limb(side, [DVec3::new(0.19, 0.04, 0.07), DVec3::new(0.225, -0.19, 0.05)], [0.085, 0.07]);
    let legs = intersection(union_of([leg, calf, foot], 0.12), -point.z, 0.08);

    let pelvis = ellipsoid(side, DVec3::new(0.0, 0.01, 1.02), DVec3::new(0.255, 0.185, 0.19));
    let buttock = sphere(side, DVec3::new(0.10, 0.09, 0.97), 0.13);
    let waist = ellipsoid(point, DVec3::new(0.0, 0.0, 1.24), DVec3::new(0.19, 0.14, 0.24));
    let chest = ellipsoid(point, DVec3::new(0.0, 0.0, 1.50), DVec3::new(0.265, 0.175, 0.26));
    let breast = ellipsoid(side, DVec3::new(0.11, -0.10, 1.55), DVec3::new(0.12, 0.085, 0.09));
    let shoulders = limb(side, [DVec3::new(0.0, 0.02, 1.68), DVec3::new(0.29, 0.02, 1.63)], [0.12, 0.105]);
    let trunk = union_of([pelvis, buttock, waist, chest, breast, shoulders], 0.14);

    let arm = chain(
        side,
        &[
            (DVec3::new(0.30, 0.02, 1.63), 0.100),
            (DVec3::new(0.47, 0.04, 1.28), 0.075),
            (DVec3::new(0.58, -0.08, 0.99), 0.055),
        ],
        0.12,
    );
    let hand = ellipsoid(side, DVec3::new(0.61, -0.12, 0.89), DVec3::new(0.055, 0.075, 0.11));
    let neck = limb(point, [DVec3::new(0.0, 0.02, 1.66), DVec3::new(0.0, 0.0, 1.88)], [0.10, 0.08]);
    let skull = ellipsoid(point, DVec3::new(0.0, 0.0, 2.04), DVec3::new(0.135, 0.160, 0.180));
    let jaw = ellipsoid(point, DVec3::new(0.0, -0.05, 1.94), DVec3::new(0.095, 0.105, 0.10));
    let nose = limb(point, [DVec3::new(0.0, -0.135, 2.06), DVec3::new(0.0, -0.155, 2.00)], [0.030, 0.045]);
    let head = union_of([union_of([skull, jaw], 0.06), nose], 0.09);

    union_of([legs, trunk, union_of([arm, hand], 0.12), neck, head], 0.14)
}
