use glam::DVec3;

use super::{ShapeError, inverse_or_zero, positive};
use crate::{Aabb, Distance, DistanceBlock, LANES, PointBlock};

/// Largest ratio of two radii. Larger: a rounding error of the long radius moves the short one by more than a millionth of
/// itself. Smaller: thin blades that still have good distances would be refused.
const LARGEST_ANISOTROPY: f64 = 1e6;

/// Stands for a zero coordinate along the shortest radius, so that no quotient is 0/0. Larger: points off the medial surface
/// could be taken for points on it. Smaller: its reciprocal would overflow.
const TINY: f64 = 1e-300;

/// Share of the shortest radius at which the nearest point must lie off the plane of the longer two before a point *in* that
/// plane counts as medial. Larger: points beyond the rim of the medial surface would lose their gradient. Smaller: nothing,
/// until rounding (1e-16 in the square) makes rim points pass.
const MEDIAL_HEIGHT: f64 = 1e-9;

/// Newton steps at most; 3 to 6 do except beside the rim of the medial surface, where the root is so close to a pole that this
/// many leave an error of second order in 1e-11 radii.
const NEWTON_STEPS: usize = 64;

/// An ellipsoid with its radii along the axes.
///
/// The nearest point is found through the root of the secular equation, as in D. Eberly, *Distance from a Point to an Ellipse,
/// an Ellipse, or a Hyperellipsoid* (Geometric Tools, 2013), but with Newton steps on the reciprocal norm, which is concave and
/// nearly linear (J. Moré and D. Sorensen, *Computing a Trust Region Step*, 1983), and with the unknown measured from the pole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    radii: DVec3,
    /// Axis numbers, shortest radius first.
    order: [usize; 3],
    /// (eᵢ/e₀)² − 1 in that order: zero, then not negative.
    offset: [f64; 3],
}

impl Ellipsoid {
    /// An ellipsoid with the given radii, model units.
    ///
    /// # Errors
    /// [`ShapeError::NotPositive`]; [`ShapeError::TooAnisotropic`] if one radius is more than 10⁶ times another.
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
        // As a product, so that nearly equal radii keep a precise difference.
        let offset = order.map(|axis| (radii[axis] - shortest) * (radii[axis] + shortest) / (shortest * shortest));
        Ok(Self { radii, order, offset })
    }

    /// Radii along x, y and z, model units.
    pub fn radii(&self) -> DVec3 {
        self.radii
    }
}

impl Distance for Ellipsoid {
    /// With y the point, e₀ the shortest radius, bᵢ = (eᵢ/e₀)² − 1 and zᵢ = |yᵢ|/eᵢ, the largest root q of
    ///
    /// ```text
    /// Σ pᵢ² = 1,  pᵢ = (1 + bᵢ) zᵢ / (q + bᵢ)
    /// ```
    ///
    /// gives the nearest point eᵢ pᵢ. The offset from it is (q − 1) w with wᵢ = yᵢ / (q + bᵢ), parallel to the normal there.
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
            // No pᵢ exceeds one at the root: three lower bounds.
            let bound = |axis: usize| 1.0 + (1.0 + b[axis]) * (z[axis] - 1.0);
            q[i] = pole[i].max(bound(1)).max(bound(2));
        }

        // Newton on the concave, increasing 1/|p| − 1. From the left it rises to the root and never passes it; a start that
        // rounding put on the right falls to the left in the first step. A lane that has stopped rising stays where it is, so
        // further steps for the other lanes' sake do not change it.
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
            // In the plane of the two longer radii, with a nearest point off it, its mirror image is as near.
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
