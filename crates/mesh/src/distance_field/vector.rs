//! Vectors for loops over lanes, which the compiler keeps in registers only if they are plain arrays.

use super::packet::LANES;

pub(super) type Vector = [f64; 3];

/// Coordinates of a vector in each lane.
pub(super) type Lanes3 = [[f64; LANES]; 3];

/// The vector in a lane.
#[inline(always)]
pub(super) fn at(lanes: &Lanes3, lane: usize) -> Vector {
    [lanes[0][lane], lanes[1][lane], lanes[2][lane]]
}

#[inline(always)]
pub(super) fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
pub(super) fn square(a: Vector) -> f64 {
    dot(a, a)
}

#[inline(always)]
pub(super) fn select(condition: bool, one: Vector, other: Vector) -> Vector {
    [
        if condition { one[0] } else { other[0] },
        if condition { one[1] } else { other[1] },
        if condition { one[2] } else { other[2] },
    ]
}

/// The vector over its length, and that length; `or` in place of a direction that underflow leaves none of.
#[inline(always)]
pub(super) fn direction(vector: Vector, or: Vector) -> (Vector, f64) {
    let squared = square(vector);
    let length = squared.sqrt();
    let scale = 1.0 / length;
    let scaled = [vector[0] * scale, vector[1] * scale, vector[2] * scale];
    (select(squared >= f64::MIN_POSITIVE, scaled, or), length)
}

/// A unit vector at right angles to this one. J. Duff et al., *Building an Orthonormal Basis, Revisited* (2017).
#[inline(always)]
fn any_across([x, y, z]: Vector) -> Vector {
    let sign = if z < 0.0 { -1.0 } else { 1.0 };
    let share = -1.0 / (sign + z);
    [x * y * share, sign + y * y * share, -y]
}

/// Square of the sine of the angle to an axis below which a vector does not tell a direction across it. Larger: slivers are taken for
/// segments. Smaller than 1e-18: what is left across the axis is so much rounding that it leans against it by more than `f32` rounds.
const PARALLEL: f64 = 1e-16;

/// The unit vector at right angles to the unit vector `axis` that is nearest to `vector`; any where that is not told.
#[inline(always)]
pub(super) fn perpendicular(axis: Vector, vector: Vector) -> Vector {
    let along = dot(axis, vector);
    let across = minus(vector, [axis[0] * along, axis[1] * along, axis[2] * along]);
    let is_told = square(across) > PARALLEL * square(vector);
    direction(select(is_told, across, [0.0; 3]), any_across(axis)).0
}

#[test]
fn axes_are_at_right_angles_whatever_the_vector() {
    let axes = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.6, 0.0, 0.8], [0.0, -0.6, -0.8]];
    let vectors =
        [[0.0; 3], [0.3, 0.2, 0.1], [0.6, 1e-9, 0.8], [0.6, 1e-17, 0.8], [1e-170, 0.0, 1e-170], [-7.0, 0.0, 0.0]];
    for axis in axes {
        for vector in vectors {
            let across = perpendicular(axis, vector);
            assert!((square(across) - 1.0).abs() < 1e-14, "{axis:?} {vector:?}: {across:?}");
            // Rounding of 1e-16 over the least sine that tells a direction, 1e-8.
            assert!(dot(across, axis).abs() < 4e-8, "{axis:?} {vector:?}: {across:?}");
        }
    }
}
