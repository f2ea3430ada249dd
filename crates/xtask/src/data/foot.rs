//! A right foot on the plane z = 0, toes along y, big toe toward −x; the sole faces −z.

use glam::DVec3;

use super::solid::{chain, difference, ellipsoid, intersection, limb, union_of};

/// Base, middle joint and tip of each toe, with radii, from the big toe to the little toe. The pads of the tips reach the
/// ground, the joints behind them do not.
const TOES: [[(DVec3, f64); 3]; 5] = [
    [
        (DVec3::new(-0.22, 0.50, 0.17), 0.130),
        (DVec3::new(-0.26, 0.76, 0.15), 0.110),
        (DVec3::new(-0.27, 0.94, 0.125), 0.127),
    ],
    [
        (DVec3::new(-0.05, 0.56, 0.16), 0.085),
        (DVec3::new(-0.035, 0.82, 0.14), 0.066),
        (DVec3::new(-0.03, 0.96, 0.085), 0.078),
    ],
    [
        (DVec3::new(0.10, 0.52, 0.15), 0.080),
        (DVec3::new(0.14, 0.76, 0.13), 0.062),
        (DVec3::new(0.155, 0.89, 0.08), 0.072),
    ],
    [
        (DVec3::new(0.24, 0.44, 0.14), 0.075),
        (DVec3::new(0.305, 0.67, 0.12), 0.060),
        (DVec3::new(0.33, 0.785, 0.074), 0.067),
    ],
    [
        (DVec3::new(0.36, 0.34, 0.12), 0.075),
        (DVec3::new(0.45, 0.55, 0.105), 0.058),
        (DVec3::new(0.485, 0.65, 0.068), 0.062),
    ],
];

/// The foot with a piece of its leg.
pub(crate) fn foot(point: DVec3) -> f64 {
    let heel = ellipsoid(point, DVec3::new(0.03, -0.88, 0.24), DVec3::new(0.25, 0.31, 0.25));
    let ball = union_of(
        [
            ellipsoid(point, DVec3::new(-0.20, 0.50, 0.17), DVec3::new(0.22, 0.25, 0.18)),
            ellipsoid(point, DVec3::new(0.05, 0.48, 0.17), DVec3::new(0.24, 0.24, 0.16)),
            ellipsoid(point, DVec3::new(0.29, 0.36, 0.145), DVec3::new(0.19, 0.26, 0.145)),
        ],
        0.12,
    );
    // The outer edge touches the ground, the arch on the inner side does not.
    let outer_edge = limb(point, [DVec3::new(0.24, 0.30, 0.14), DVec3::new(0.15, -0.75, 0.17)], [0.135, 0.165]);
    let instep = limb(point, [DVec3::new(-0.10, 0.42, 0.20), DVec3::new(0.0, -0.62, 0.48)], [0.17, 0.30]);
    let leg = limb(point, [DVec3::new(0.0, -0.72, 0.45), DVec3::new(0.0, -0.76, 1.4)], [0.28, 0.25]);
    let body = union_of([heel, ball, outer_edge, instep, leg], 0.16);
    let arch = ellipsoid(point, DVec3::new(-0.30, -0.17, 0.02), DVec3::new(0.36, 0.48, 0.22));
    let toes = union_of(TOES.iter().map(|joints| chain(point, joints, 0.05)), 0.05);
    let whole = union_of([difference(body, arch, 0.14), toes], 0.09);
    // Weight flattens the sole a little; the leg is cut off.
    let sole = 0.02 - point.z;
    let cut = point.z - 0.85;
    intersection(intersection(whole, sole, 0.06), cut, 0.12)
}
