//! Lanes of a packet, and vectors for loops over lanes.
//!
//! Vectors are plain arrays, because the compiler keeps only those in registers.

/// Nodes in a packet along x, y and z.
pub(super) const PACKET: [usize; 3] = [4, 2, 2];

/// Nodes in a packet.
pub(super) const LANES: usize = PACKET[0] * PACKET[1] * PACKET[2];

/// One number for each node of a packet.
pub(super) type Lanes = [f32; LANES];

pub(super) type Vector = [f64; 3];

/// One vector for each lane, component by component.
pub(super) type Lanes3 = [[f64; LANES]; 3];

/// Returns the vector in a lane.
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

/// Normalizes a vector and returns its length. The direction is `or` if the squared length
/// underflows.
#[inline(always)]
pub(super) fn direction(vector: Vector, or: Vector) -> (Vector, f64) {
    let squared = square(vector);
    let length = squared.sqrt();
    let scale = 1.0 / length;
    let scaled = [vector[0] * scale, vector[1] * scale, vector[2] * scale];
    (select(squared >= f64::MIN_POSITIVE, scaled, or), length)
}

/// Returns a unit vector perpendicular to a unit vector (J. Duff et al., *Building an Orthonormal
/// Basis, Revisited*, 2017).
#[inline(always)]
fn any_perpendicular([x, y, z]: Vector) -> Vector {
    let sign = if z < 0.0 { -1.0 } else { 1.0 };
    let scale = -1.0 / (sign + z);
    [x * y * scale, sign + y * y * scale, -y]
}

/// Square of the sine of the angle to an axis below which a vector does not define a perpendicular
/// direction. Larger: slivers are treated as segments. Smaller than 1e-18: the perpendicular
/// component is mostly rounding, and deviates from a right angle by more than the rounding of
/// `f32`.
const PARALLEL: f64 = 1e-16;

/// Returns the unit vector perpendicular to the unit vector `axis` that is nearest to `vector`. If
/// `vector` is parallel to the axis, any perpendicular vector is returned.
#[inline(always)]
pub(super) fn perpendicular(axis: Vector, vector: Vector) -> Vector {
    let along = dot(axis, vector);
    let across = minus(vector, [axis[0] * along, axis[1] * along, axis[2] * along]);
    let is_defined = square(across) > PARALLEL * square(vector);
    direction(select(is_defined, across, [0.0; 3]), any_perpendicular(axis)).0
}

#[test]
fn perpendicular_is_a_unit_vector_at_right_angles() {
    let axes = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.6, 0.0, 0.8], [0.0, -0.6, -0.8]];
    let vectors =
        [[0.0; 3], [0.3, 0.2, 0.1], [0.6, 1e-9, 0.8], [0.6, 1e-17, 0.8], [1e-170, 0.0, 1e-170], [-7.0, 0.0, 0.0]];
    for axis in axes {
        for vector in vectors {
            let across = perpendicular(axis, vector);
            assert!((square(across) - 1.0).abs() < 1e-14, "{axis:?} {vector:?}: {across:?}");
            // Rounding of 1e-16 over 1e-8, the smallest sine that defines a direction.
            assert!(dot(across, axis).abs() < 4e-8, "{axis:?} {vector:?}: {across:?}");
        }
    }
}
