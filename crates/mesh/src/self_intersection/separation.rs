//! A fast proof that two triangles are disjoint: a separating plane.
//!
//! It handles sixteen pairs at a time in `f32`, relative to a corner of the first triangle, with a
//! bound on the rounding error. Exact predicates decide the pairs that it leaves open. So it
//! affects only speed, not results.

use glam::DVec3;

use crate::extremes::{max, min};

/// Number of pairs in a block.
pub(super) const LANES: usize = 16;

type Lanes = [f32; LANES];

/// One vector per pair, component by component.
type Vectors = [Lanes; 3];

/// Relative bound on the error of a projection onto a given direction, and of the volume spanned by
/// three vectors, both relative to the sizes of their terms. Each coordinate, product and sum is
/// rounded once, so there are at most 11 roundings of 2⁻²⁴. Larger: more pairs go to the exact
/// predicates. Smaller: touching triangles could be considered disjoint.
const ROUNDING: f32 = 16.0 / (1 << 24) as f32;

/// Bound on the loss of a sum of products by underflow. Larger: tiny triangles go to the exact
/// predicates. Smaller: it would not be a bound.
const UNDERFLOW: f32 = 1e-36;

/// Pairs of triangles with the same number of common corners. Common corners are first and in the
/// same order. All vectors are relative to the first corner of the first triangle.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(super) struct PairBlock {
    /// The second and third corner of the first triangle, then all corners of the second.
    vectors: [Vectors; 5],
    count: usize,
}

impl PairBlock {
    pub(super) const EMPTY: Self = Self { vectors: [[[0.0; LANES]; 3]; 5], count: 0 };

    /// Adds a pair: the first corner of the first triangle, and the other five corners. Lengths
    /// should be of order one.
    ///
    /// # Panics
    /// If the block is full.
    #[inline(always)]
    pub(super) fn push(&mut self, origin: &DVec3, others: [&DVec3; 5]) {
        let lane = self.count;
        for index in 0..5 {
            let vector = *others[index] - *origin;
            self.vectors[index][0][lane] = vector.x as f32;
            self.vectors[index][1][lane] = vector.y as f32;
            self.vectors[index][2][lane] = vector.z as f32;
        }
        self.count += 1;
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// For pairs without common corners, returns by lane whether they are certainly disjoint.
    /// Candidate directions are the two normals and, within the plane of each triangle, the normals
    /// of its edges.
    #[inline(always)]
    pub(super) fn are_apart(&self) -> [bool; LANES] {
        let [a1, a2, b0, b1, b2] = &self.vectors;
        let size = sizes(&self.vectors);
        let (edge_a, edge_b) = (minus(a2, a1), minus(b2, b1));
        let (b01, b02) = (minus(b1, b0), minus(b2, b0));
        let (normal_a, normal_b) = (cross(a1, a2), cross(&b01, &b02));
        let directions = [
            normal_a,
            normal_b,
            cross(a1, &normal_a),
            cross(a2, &normal_a),
            cross(&edge_a, &normal_a),
            cross(&b01, &normal_b),
            cross(&b02, &normal_b),
            cross(&edge_b, &normal_b),
        ];
        let mut apart = [false; LANES];
        for direction in &directions {
            let [on_a1, on_a2] = [dot(direction, a1), dot(direction, a2)];
            let [on_b0, on_b1, on_b2] = [dot(direction, b0), dot(direction, b1), dot(direction, b2)];
            let margin = margin(direction, &size);
            // Intervals of both projections. The first corner of the first triangle projects to
            // zero.
            for i in 0..LANES {
                let low_a = min(min(on_a1[i], on_a2[i]), 0.0);
                let high_a = max(max(on_a1[i], on_a2[i]), 0.0);
                let low_b = min(min(on_b0[i], on_b1[i]), on_b2[i]);
                let high_b = max(max(on_b0[i], on_b1[i]), on_b2[i]);
                apart[i] |= (low_b - high_a > margin[i]) | (low_a - high_b > margin[i]);
            }
        }
        apart
    }

    /// For pairs with one common corner, returns by lane whether they certainly intersect only in
    /// it. A plane through the corner has one triangle strictly on one side, and the other on the
    /// other side or on the plane.
    #[inline(always)]
    pub(super) fn meet_in_corner(&self) -> [bool; LANES] {
        let [a1, a2, _, b1, b2] = &self.vectors;
        let size = sizes(&self.vectors);
        let (normal_a, normal_b) = (cross(a1, a2), cross(b1, b2));
        let mut apart = [false; LANES];
        // The planes of both triangles.
        for (plane, x, y) in [(Plane::along(a1, a2), b1, b2), (Plane::along(b1, b2), a1, a2)] {
            let (x, y) = (plane.sides(x), plane.sides(y));
            for i in 0..LANES {
                apart[i] |= (x.left[i] & y.left[i]) | (x.right[i] & y.right[i]);
            }
        }
        // Planes through an edge and perpendicular to its triangle.
        for (edge, normal, third, x, y) in [
            (a1, &normal_a, a2, b1, b2),
            (a2, &normal_a, a1, b1, b2),
            (b1, &normal_b, b2, a1, a2),
            (b2, &normal_b, b1, a1, a2),
        ] {
            let plane = Plane::along(edge, normal);
            let (third, x, y) = (plane.sides(third), plane.sides(x), plane.sides(y));
            for i in 0..LANES {
                apart[i] |= (third.left[i] & x.right[i] & y.right[i]) | (third.right[i] & x.left[i] & y.left[i]);
            }
        }
        // The plane between triangles on opposite sides of the corner.
        let direction = minus(&plus(a1, a2), &plus(b1, b2));
        let [a1, a2, b1, b2] = [dot(&direction, a1), dot(&direction, a2), dot(&direction, b1), dot(&direction, b2)];
        let margin = margin(&direction, &size);
        for i in 0..LANES {
            let (low_a, high_b) = (min(a1[i], a2[i]), max(b1[i], b2[i]));
            apart[i] |= (low_a > margin[i]) & (high_b < -margin[i]);
        }
        apart
    }

    /// For pairs with a common edge, returns by lane whether they certainly intersect only in it:
    /// they are not in one plane, or they are on opposite sides of the edge.
    #[inline(always)]
    pub(super) fn meet_in_edge(&self) -> [bool; LANES] {
        let [edge, a, _, _, b] = &self.vectors;
        let flat = Plane::along(edge, a).sides(b);
        let across = Plane::along(edge, &cross(edge, a));
        let (a, b) = (across.sides(a), across.sides(b));
        let mut apart = [false; LANES];
        for i in 0..LANES {
            apart[i] = flat.left[i] | flat.right[i] | (a.left[i] & b.right[i]) | (a.right[i] & b.left[i]);
        }
        apart
    }
}

/// Planes through the origin spanned by two vectors.
#[derive(Debug)]
struct Plane {
    normal: Vectors,
    /// Sums of the sizes of the two products in each component of the normal.
    terms: Vectors,
}

/// Vectors that are certainly on one side of a plane.
#[derive(Debug)]
struct Sides {
    left: [bool; LANES],
    right: [bool; LANES],
}

impl Plane {
    #[inline(always)]
    fn along(a: &Vectors, b: &Vectors) -> Self {
        let mut plane = Self { normal: [[0.0; LANES]; 3], terms: [[0.0; LANES]; 3] };
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            for i in 0..LANES {
                let (one, other) = (a[next][i] * b[last][i], a[last][i] * b[next][i]);
                plane.normal[axis][i] = one - other;
                plane.terms[axis][i] = one.abs() + other.abs();
            }
        }
        plane
    }

    #[inline(always)]
    fn sides(&self, vector: &Vectors) -> Sides {
        let mut sides = Sides { left: [false; LANES], right: [false; LANES] };
        let [nx, ny, nz] = &self.normal;
        let [tx, ty, tz] = &self.terms;
        let [x, y, z] = vector;
        for i in 0..LANES {
            let volume = nx[i] * x[i] + ny[i] * y[i] + nz[i] * z[i];
            let size = tx[i] * x[i].abs() + ty[i] * y[i].abs() + tz[i] * z[i].abs();
            let bound = ROUNDING * size + UNDERFLOW;
            sides.left[i] = volume > bound;
            sides.right[i] = volume < -bound;
        }
        sides
    }
}

/// Bound on the error of the difference between the projections of two vectors of these `sizes`.
#[inline(always)]
fn margin(direction: &Vectors, sizes: &Lanes) -> Lanes {
    let mut margin = [0.0; LANES];
    for i in 0..LANES {
        let norm = direction[0][i].abs() + direction[1][i].abs() + direction[2][i].abs();
        margin[i] = ROUNDING * norm * sizes[i] + UNDERFLOW;
    }
    margin
}

/// Returns the largest absolute component of the vectors.
#[inline(always)]
fn sizes(vectors: &[Vectors; 5]) -> Lanes {
    let mut size = [0.0; LANES];
    for component in vectors.iter().flatten() {
        for i in 0..LANES {
            size[i] = max(component[i].abs(), size[i]);
        }
    }
    size
}

#[inline(always)]
fn cross(a: &Vectors, b: &Vectors) -> Vectors {
    let mut result = [[0.0; LANES]; 3];
    for axis in 0..3 {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        for i in 0..LANES {
            result[axis][i] = a[next][i] * b[last][i] - a[last][i] * b[next][i];
        }
    }
    result
}

#[inline(always)]
fn dot(a: &Vectors, b: &Vectors) -> Lanes {
    let mut result = [0.0; LANES];
    for i in 0..LANES {
        result[i] = a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i];
    }
    result
}

#[inline(always)]
fn minus(a: &Vectors, b: &Vectors) -> Vectors {
    let mut result = *a;
    for axis in 0..3 {
        for i in 0..LANES {
            result[axis][i] -= b[axis][i];
        }
    }
    result
}

#[inline(always)]
fn plus(a: &Vectors, b: &Vectors) -> Vectors {
    let mut result = *a;
    for axis in 0..3 {
        for i in 0..LANES {
            result[axis][i] += b[axis][i];
        }
    }
    result
}
