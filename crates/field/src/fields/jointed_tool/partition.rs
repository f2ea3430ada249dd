//! Partition of unity over the bones, from the distances to them.
//!
//! ```text
//! wᵢ = bᵢ / Σⱼ bⱼ,   bᵢ = Πⱼ bᵢⱼ
//! ```
//!
//! bᵢⱼ is the weight of bone i in the blend with bone j: a quintic step of the difference of the
//! two distances. The partition has compact support: distant bones have weight exactly zero.

use glam::DVec3;

use super::smooth_minimum::Scalar;

/// Narrowest blend ε of two bones without a common joint, relative to the radius of the thinner
/// one. Larger: bones closer than about twice this move each other's surface. Smaller: the shear
/// between touching bones needs more time steps.
const NARROWEST_BLEND: f64 = 1.0 / 16.0;

/// Transition between the weights of two bones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Blend {
    /// Over this length, at a joint between the bones.
    Joint(f64),
    /// Over the gap between the bones, and at most this length, so that each bone has weight one on
    /// its surface.
    Gap(f64),
}

impl Blend {
    /// Largest difference of the two distances at which the weights are still blended.
    pub(super) fn longest(self) -> f64 {
        match self {
            Self::Joint(length) => length,
            Self::Gap(length) => length * (1.0 + NARROWEST_BLEND),
        }
    }

    /// Weight of bone `a` and its gradient, from the softened distances of both bones: one where
    /// `a` is clearly nearer, zero where `b` is.
    fn weight(self, a: Scalar, b: Scalar) -> Scalar {
        let (difference, slope) = (b.0 - a.0, b.1 - a.1);
        let (width, width_slope) = match self {
            Self::Joint(length) => (length, DVec3::ZERO),
            Self::Gap(length) => gap_width(length, (a.0 + b.0, a.1 + b.1)),
        };
        let t = 0.5 + difference / (2.0 * width);
        if t >= 1.0 {
            return (1.0, DVec3::ZERO);
        }
        if t.is_nan() || t <= 0.0 {
            return (0.0, DVec3::ZERO);
        }
        let t_slope = (slope - difference / width * width_slope) / (2.0 * width);
        let rest = 1.0 - t;
        (t * t * t * (10.0 - t * (15.0 - 6.0 * t)), 30.0 * (t * rest) * (t * rest) * t_slope)
    }
}

/// Width of a blend, and its gradient, where the distances to the two bones have the sum s:
///
/// ```text
/// w² = ε² + q²,   q = ℓ|s|/(ℓ + |s|)
/// ```
///
/// Since q < |s|, a point on the surface of one bone belongs to it alone if the other is at least a
/// few ε away.
fn gap_width(length: f64, sum: Scalar) -> Scalar {
    let narrowest = NARROWEST_BLEND * length;
    let size = sum.0.abs();
    let q = length / (1.0 + length / size);
    let width = (narrowest * narrowest + q * q).sqrt();
    let ratio = length / (length + size);
    (width, q * ratio * ratio / width * sum.0.signum() * sum.1)
}

/// Distance from a bone of this `radius`, flattened inside so that the kink on the axis of the bone
/// does not show: d + d²/2r for −r < d < 0, and constant below.
pub(super) fn softened(distance: Scalar, radius: f64) -> Scalar {
    let (value, gradient) = distance;
    if value >= 0.0 {
        distance
    } else if value > -radius {
        (value + value * value / (2.0 * radius), (1.0 + value / radius) * gradient)
    } else {
        (-0.5 * radius, DVec3::ZERO)
    }
}

/// A bone with its nonzero weight wᵢ at a point and the gradient of the weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BoneWeight {
    pub(super) bone: usize,
    pub(super) value: f64,
    pub(super) gradient: DVec3,
}

/// Writes the bones with nonzero weight at a point, from the softened distances there, to
/// `weights`.
///
/// With two bones, the weights are those of their blend. `blend` returns the blend of two bones,
/// and `widest` bounds the [longest](Blend::longest) of all.
pub(super) fn partition(
    distances: &[Scalar],
    blend: impl Fn(usize, usize) -> Blend,
    widest: f64,
    weights: &mut Vec<BoneWeight>,
) {
    weights.clear();
    let nearest = distances.iter().map(|distance| distance.0).fold(f64::INFINITY, f64::min);
    let mut sum: Scalar = (0.0, DVec3::ZERO);
    for (i, &a) in distances.iter().enumerate().filter(|(_, distance)| distance.0 <= nearest + widest) {
        let mut product: Scalar = (1.0, DVec3::ZERO);
        for (j, &b) in distances.iter().enumerate() {
            if j != i {
                let (value, gradient) = blend(i, j).weight(a, b);
                product = (product.0 * value, product.1 * value + product.0 * gradient);
                if value == 0.0 {
                    break;
                }
            }
        }
        if product.0 > 0.0 {
            weights.push(BoneWeight { bone: i, value: product.0, gradient: product.1 });
            sum = (sum.0 + product.0, sum.1 + product.1);
        }
    }
    for weight in weights {
        weight.value /= sum.0;
        weight.gradient = (weight.gradient - weight.value * sum.1) / sum.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distances to three spheres of radius 0.1 on a line. The first two have a common joint.
    fn distances(point: DVec3) -> [Scalar; 3] {
        [-0.15, 0.0, 0.24].map(|x| {
            let offset = point - DVec3::new(x, 0.0, 0.0);
            softened((offset.length() - 0.1, offset.normalize_or_zero()), 0.1)
        })
    }

    fn weights(point: DVec3) -> [Scalar; 3] {
        let blend = |i: usize, j: usize| if i + j == 1 { Blend::Joint(0.1) } else { Blend::Gap(0.1) };
        let mut found = Vec::new();
        partition(&distances(point), blend, 0.11, &mut found);
        let mut weights = [(0.0, DVec3::ZERO); 3];
        found.iter().for_each(|weight| weights[weight.bone] = (weight.value, weight.gradient));
        weights
    }

    #[test]
    fn weights_are_a_partition_of_unity() {
        for point in crate::fields::field::finite_differences::scattered_points(500, 0.4) {
            let weights = weights(point);
            let (sum, slope) =
                weights.iter().fold((0.0, DVec3::ZERO), |sum, weight| (sum.0 + weight.0, sum.1 + weight.1));
            // Three roundings, and slopes up to 1/ε = 160.
            assert!((sum - 1.0).abs() < 4e-16 && slope.length() < 1e-12, "{point} {sum} {slope}");
            assert!(weights.iter().all(|weight| (0.0..=1.0).contains(&weight.0)));
        }
    }

    #[test]
    fn gradients_are_the_derivatives_of_the_weights() {
        let h = 1e-6;
        for point in crate::fields::field::finite_differences::scattered_points(500, 0.3) {
            for bone in 0..3 {
                let slope = DVec3::AXES
                    .map(|axis| (weights(point + h * axis)[bone].0 - weights(point - h * axis)[bone].0) / (2.0 * h));
                // Truncation: h/2 of second derivatives of the order of 1/ε² = 3e4, which jump on
                // the surfaces.
                assert!(DVec3::from_array(slope).distance(weights(point)[bone].1) < 2e-2, "{point} {bone}");
            }
        }
    }

    #[test]
    fn only_a_bone_at_a_joint_has_weight_on_its_neighbors_surface() {
        // The gap between the second and the third sphere is 0.04 wide, more than six times ε.
        for turn in 0..20 {
            let angle = -1.5 + 0.15 * f64::from(turn);
            let on_second = DVec3::new(0.1 * libm::cos(angle), 0.1 * libm::sin(angle), 0.0);
            assert_eq!(weights(on_second)[2], (0.0, DVec3::ZERO), "{angle}");
        }
        let between = weights(DVec3::new(-0.075, 0.0, 0.0));
        assert!((between[0].0 - 0.5).abs() < 1e-12 && between[2].0 == 0.0, "{between:?}");
    }
}
