//! An open right hand in the plane z = 0, fingers along y, seen from its back side from +z.

use glam::DVec3;

use super::solid::{chain, ellipsoid, intersection, limb, union_of};

/// Knuckle, middle joint and tip of each finger, with radii, from the index finger to the little finger.
const FINGERS: [[(DVec3, f64); 3]; 4] = [
    [
        (DVec3::new(-0.31, 0.42, 0.02), 0.135),
        (DVec3::new(-0.47, 0.86, 0.07), 0.115),
        (DVec3::new(-0.56, 1.20, 0.03), 0.090),
    ],
    [
        (DVec3::new(-0.11, 0.50, 0.03), 0.140),
        (DVec3::new(-0.15, 1.00, 0.09), 0.120),
        (DVec3::new(-0.17, 1.42, 0.04), 0.095),
    ],
    [
        (DVec3::new(0.10, 0.48, 0.03), 0.135),
        (DVec3::new(0.19, 0.96, 0.08), 0.115),
        (DVec3::new(0.25, 1.34, 0.03), 0.090),
    ],
    [
        (DVec3::new(0.30, 0.38, 0.01), 0.120),
        (DVec3::new(0.48, 0.73, 0.05), 0.100),
        (DVec3::new(0.60, 1.01, 0.01), 0.080),
    ],
];

const THUMB: [(DVec3, f64); 3] = [
    (DVec3::new(-0.28, -0.25, -0.03), 0.20),
    (DVec3::new(-0.62, 0.08, -0.05), 0.145),
    (DVec3::new(-0.90, 0.36, -0.02), 0.105),
];

/// The hand with a piece of its wrist.
pub(crate) fn hand(point: DVec3) -> f64 {
    // Palm and wrist are flatter than they are wide.
    let flat = DVec3::new(point.x, point.y, 1.9 * point.z);
    let palm = union_of(
        [
            limb(flat, [DVec3::new(-0.17, 0.22, 0.0), DVec3::new(-0.12, -0.28, 0.0)], [0.27, 0.30]),
            limb(flat, [DVec3::new(0.17, 0.20, 0.0), DVec3::new(0.12, -0.28, 0.0)], [0.25, 0.28]),
        ],
        0.1,
    ) / 1.9;
    let wrist = limb(
        DVec3::new(point.x, point.y, 1.4 * point.z),
        [DVec3::new(0.0, -0.40, 0.0), DVec3::new(0.0, -1.30, 0.0)],
        [0.31, 0.30],
    ) / 1.4;
    let ball_of_thumb = ellipsoid(point, DVec3::new(-0.24, -0.16, -0.10), DVec3::new(0.20, 0.30, 0.13));
    let fingers = union_of(FINGERS.iter().map(|joints| chain(point, joints, 0.07)), 0.06);
    let thumb = chain(point, &THUMB, 0.14);
    let whole = union_of([union_of([palm, wrist, ball_of_thumb], 0.18), fingers, thumb], 0.22);
    let wrist_end = -1.0 - point.y;
    intersection(whole, wrist_end, 0.2)
}
