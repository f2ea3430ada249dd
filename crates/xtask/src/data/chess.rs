//! Three chess pieces on the same turned base, z upward from the foot at 0, about two units high.

use glam::{DVec2, DVec3};

use super::solid::{chain, difference, ellipsoid, frustum, intersection, limb, rounded_box, sphere, union, union_of};

/// Fillets between turned parts.
const FILLET: f64 = 0.22;

/// A disk about the z axis.
fn disk(point: DVec3, radius: f64, [low, high]: [f64; 2], rounding: f64) -> f64 {
    frustum(point, DVec2::new(radius, low), DVec2::new(radius, high), rounding)
}

fn base(point: DVec3) -> f64 {
    let foot = disk(point, 0.62, [0.0, 0.2], 0.07);
    let step = frustum(point, DVec2::new(0.54, 0.1), DVec2::new(0.42, 0.36), 0.05);
    union(foot, step, FILLET)
}

/// A pawn.
pub(crate) fn pawn(point: DVec3) -> f64 {
    let body = frustum(point, DVec2::new(0.40, 0.25), DVec2::new(0.16, 1.25), 0.04);
    let collar = disk(point, 0.31, [1.10, 1.25], 0.07);
    let head = sphere(point, DVec3::new(0.0, 0.0, 1.52), 0.33);
    union_of([base(point), body, collar, head], FILLET)
}

/// A rook: a tower with six battlements.
pub(crate) fn rook(point: DVec3) -> f64 {
    let body = frustum(point, DVec2::new(0.42, 0.25), DVec2::new(0.30, 1.30), 0.04);
    let collar = disk(point, 0.43, [1.14, 1.29], 0.07);
    let tower = frustum(point, DVec2::new(0.38, 1.20), DVec2::new(0.49, 1.82), 0.07);
    let solid = union_of([base(point), body, collar, tower], FILLET);

    let well = disk(point, 0.29, [1.52, 2.20], 0.06);
    let gaps = (0..3).map(|gap| {
        let (sine, cosine) = libm::sincos(f64::from(gap) * std::f64::consts::PI / 3.0);
        let turned = DVec3::new(cosine * point.x + sine * point.y, cosine * point.y - sine * point.x, point.z);
        rounded_box(turned, DVec3::new(0.0, 0.0, 1.86), DVec3::new(0.8, 0.10, 0.26), 0.06)
    });
    difference(solid, union(well, union_of(gaps, 0.10), 0.10), 0.14)
}

/// A knight: the head of a horse that faces along x.
pub(crate) fn knight(point: DVec3) -> f64 {
    // Both sides at once: the head is symmetric.
    let side = DVec3::new(point.x, point.y.abs(), point.z);
    // The horse is slimmer across than along.
    let slim = DVec3::new(point.x, 1.22 * point.y, point.z);

    let neck = chain(
        slim,
        &[
            (DVec3::new(0.00, 0.0, 0.40), 0.37),
            (DVec3::new(-0.06, 0.0, 0.75), 0.34),
            (DVec3::new(-0.10, 0.0, 1.15), 0.30),
            (DVec3::new(-0.02, 0.0, 1.52), 0.25),
        ],
        0.10,
    ) / 1.22;
    let chest = sphere(slim, DVec3::new(0.14, 0.0, 0.72), 0.27) / 1.22;
    let face = limb(slim, [DVec3::new(0.06, 0.0, 1.58), DVec3::new(0.56, 0.0, 1.24)], [0.23, 0.145]) / 1.22;
    let jaw = limb(slim, [DVec3::new(0.14, 0.0, 1.36), DVec3::new(0.48, 0.0, 1.18)], [0.19, 0.12]) / 1.22;
    let muzzle = ellipsoid(side, DVec3::new(0.60, 0.0, 1.20), DVec3::new(0.13, 0.13, 0.14));
    let brow = limb(side, [DVec3::new(0.08, 0.13, 1.70), DVec3::new(0.28, 0.13, 1.58)], [0.07, 0.05]);
    let ears = limb(side, [DVec3::new(-0.06, 0.11, 1.72), DVec3::new(-0.02, 0.15, 1.98)], [0.105, 0.060]);
    let horse = union_of([union_of([neck, chest, face, jaw, muzzle], 0.16), brow, ears], 0.14);

    // The mane: locks side by side along the crest of the neck.
    let crest = [
        DVec3::new(-0.08, 0.0, 1.80),
        DVec3::new(-0.27, 0.0, 1.66),
        DVec3::new(-0.40, 0.0, 1.46),
        DVec3::new(-0.46, 0.0, 1.24),
        DVec3::new(-0.46, 0.0, 1.02),
        DVec3::new(-0.43, 0.0, 0.80),
    ];
    let locks = crest.map(|at| ellipsoid(side, at, DVec3::new(0.14, 0.115, 0.14)));
    let horse = union(horse, union_of(locks, 0.12), 0.14);

    let eye = sphere(side, DVec3::new(0.24, 0.205, 1.53), 0.07);
    let nostril = sphere(side, DVec3::new(0.70, 0.10, 1.26), 0.06);
    let mouth = limb(side, [DVec3::new(0.76, 0.22, 1.13), DVec3::new(0.44, 0.22, 1.17)], [0.045, 0.03]).min(limb(
        side,
        [DVec3::new(0.78, 0.0, 1.12), DVec3::new(0.76, 0.22, 1.13)],
        [0.045, 0.045],
    ));
    let horse = union(difference(horse, nostril.min(mouth), 0.12), eye, 0.09);

    let plinth = disk(point, 0.44, [0.30, 0.44], 0.06);
    union_of([base(point), plinth, intersection(horse, 0.3 - point.z, 0.05)], FILLET)
}
