use glam::DVec3;

use super::{ShapeError, inverse_or_zero, positive};
use crate::{Aabb, Distance, DistanceBlock, LANES, PointBlock};

/// Largest accepted ratio of two radii. Larger: a rounding error of the longest radius moves the
/// shortest by more than a millionth of itself. Smaller: thin blades with accurate distances would
/// be rejected.
const LARGEST_ANISOTROPY: f64 = 1e6;

/// Replaces a zero coordinate along the shortest radius, so that no quotient is 0/0. Larger: points
/// off the medial surface could be treated as medial. Smaller: its reciprocal would overflow.
const TINY: f64 = 1e-300;

/// Smallest height of the nearest point above the plane of the two longer radii, relative to the
/// shortest radius, for which a point *in* that plane is medial. Larger: points beyond the rim of
/// the medial surface would lose their gradient. Smaller: no effect until rounding (1e-16 in the
/// square) makes points on the rim medial.
const MEDIAL_HEIGHT: f64 = 1e-9;

/// Maximum number of Newton steps. 3 to 6 suffice except close to the rim of the medial surface,
/// where the root is very close to a pole. There, this number leaves a second-order error of 1e-11
/// radii.
const NEWTON_STEPS: usize = 64;

/// An ellipsoid with its radii along the axes.
///
/// The nearest point follows from the root of the secular equation, as in D. Eberly, *Distance from
/// a Point to an Ellipse, an Ellipse, or a Hyperellipsoid* (Geometric Tools, 2013). In contrast to
/// that paper, the root is found by Newton steps on the reciprocal norm, which is concave and
/// nearly linear (J. Moré and D. Sorensen, *Computing a Trust Region Step*, 1983), and the unknown
/// is measured from the pole.
///
/// ```
/// use glam::{DVec3, dvec3};
/// use isochore_mesh::{Distance, Ellipsoid};
///
/// let ellipsoid = Ellipsoid::new(dvec3(3.0, 2.0, 1.0))?;
/// let (value, gradient) = ellipsoid.sample(DVec3::X * 5.0);
/// assert!((value - 2.0).abs() < 1e-12);
/// assert!((gradient - DVec3::X).length() < 1e-12);
/// # Ok::<(), isochore_mesh::ShapeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    radii: DVec3,
    /// Axis indices, shortest radius first.
    order: [usize; 3],
    /// (eᵢ/e₀)² − 1 in that order: the first is zero, the others are not negative.
    offset: [f64; 3],
}

impl Ellipsoid {
    /// An ellipsoid with the given radii along x, y and z, model units.
    ///
    /// # Errors
    /// [`ShapeError::NotPositive`] if a radius is not positive and finite;
    /// [`ShapeError::TooAnisotropic`] if one radius is more than 10⁶ times another.
    pub fn new(radii: DVec3) -> Result<Self, ShapeError> {
        for radius in radii.to_array() {
            positive("ellipsoid", "radii", radius)?;
        }
        let ratio = radii.max_element() / radii.min_element();
        if ratio > LARGEST_ANISOTROPY {
            return Err(ShapeError::TooAnisotropic { ratio, limit: LARGEST_ANISOTROPY });
        }
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| radii[a].total_cmp(&radii[b]));
        let shortest = radii[order[0]];
        // Factored, so that nearly equal radii keep an accurate difference.
        let offset = order.map(|axis| (radii[axis] - shortest) * (radii[axis] + shortest) / (shortest * shortest));
        Ok(Self { radii, order, offset })
    }

    /// Radii along x, y and z, model units.
    pub fn radii(&self) -> DVec3 {
        self.radii
    }
}

impl Distance for Ellipsoid {
    /// Solves the secular equation for the nearest point.
    ///
    /// Let y be the point, e₀ the shortest radius, bᵢ = (eᵢ/e₀)² − 1 and zᵢ = |yᵢ|/eᵢ. Let q be the
    /// largest root of
    ///
    /// ```text
    /// Σ pᵢ² = 1,  pᵢ = (1 + bᵢ) zᵢ / (q + bᵢ)
    /// ```
    ///
    /// Then the nearest point is eᵢ pᵢ. The offset from it is (q − 1) w with wᵢ = yᵢ / (q + bᵢ),
    /// which is parallel to the normal at the nearest point.
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        let coordinates = self.order.map(|axis| [&points.x, &points.y, &points.z][axis]);
        let radii = self.order.map(|axis| self.radii[axis]);
        let b = self.offset;

        let mut numerator = [[0.0; LANES]; 3]; // (1 + bᵢ) zᵢ
        let mut pole = [0.0; LANES];
        let mut q = [0.0; LANES];
        for i in 0..LANES {
            let z = [0, 1, 2].map(|axis| coordinates[axis][i].abs() / radii[axis]);
            pole[i] = z[0].max(TINY);
            numerator[0][i] = pole[i];
            numerator[1][i] = (1.0 + b[1]) * z[1];
            numerator[2][i] = (1.0 + b[2]) * z[2];
            // No pᵢ exceeds one at the root, which gives three lower bounds of q.
            let bound = |axis: usize| 1.0 + (1.0 + b[axis]) * (z[axis] - 1.0);
            q[i] = pole[i].max(bound(1)).max(bound(2));
        }

        // Newton steps on the concave, increasing function 1/|p| − 1. From the left, they rise to
        // the root and never pass it. A start on the right, due to rounding, falls to the left in
        // the first step. A lane that has stopped rising keeps its value, so steps for other lanes
        // do not change it.
        for step in 0..NEWTON_STEPS {
            let mut rose = false;
            for i in 0..LANES {
                let inverse = [1.0 / q[i], 1.0 / (q[i] + b[1]), 1.0 / (q[i] + b[2])];
                let square = [0, 1, 2].map(|axis| {
                    let p = numerator[axis][i] * inverse[axis];
                    p * p
                });
                let norm2 = square[0] + square[1] + square[2];
                let slope = square[0] * inverse[0] + square[1] * inverse[1] + square[2] * inverse[2];
                let next = (q[i] + (norm2.sqrt() - 1.0) * norm2 / slope).max(pole[i]);
                let moves = next > q[i] || (step == 0 && next < q[i]);
                q[i] = if moves { next } else { q[i] };
                rose |= moves;
            }
            if !rose {
                break;
            }
        }

        let mut normal = [[0.0; LANES]; 3];
        for i in 0..LANES {
            let shortest = coordinates[0][i];
            let w0 = (radii[0] * pole[i]).copysign(shortest) / q[i];
            let w1 = coordinates[1][i] / (q[i] + b[1]);
            let w2 = coordinates[2][i] / (q[i] + b[2]);
            let length = (w0 * w0 + w1 * w1 + w2 * w2).sqrt();
            out.value[i] = (q[i] - 1.0) * length;
            // In the plane of the two longer radii, a nearest point off the plane has an equally
            // near mirror image. The point is medial and has no gradient.
            let medial = shortest == 0.0 && pole[i] / q[i] > MEDIAL_HEIGHT;
            let inverse = if medial { 0.0 } else { inverse_or_zero(length) };
            normal[0][i] = if shortest == 0.0 { 0.0 } else { w0 * inverse };
            normal[1][i] = w1 * inverse;
            normal[2][i] = w2 * inverse;
        }
        let gradient = [&mut out.gradient.x, &mut out.gradient.y, &mut out.gradient.z];
        for (axis, lanes) in self.order.into_iter().zip(normal) {
            *gradient[axis] = lanes;
        }
    }

    fn bounds(&self) -> Aabb {
        Aabb { min: -self.radii, max: self.radii }
    }

    fn centroid(&self) -> DVec3 {
        DVec3::ZERO
    }
}
