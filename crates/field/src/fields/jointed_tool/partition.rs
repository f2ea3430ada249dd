//! Which bone a point follows: a compact partition of unity from the distances to the bones.

use glam::DVec3;

use super::smooth_minimum::Scalar;

/// Narrowest blend of two bones without a common joint, as a share of the thinner one's radius. Wider: bones closer than
/// about twice this pull at each other's surface. Narrower: the shear between bones that touch costs more time steps.
const NARROWEST_BLEND: f64 = 1.0 / 16.0;

/// How the weights of two bones turn into each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Blend {
    /// Over this length, as at a joint between them.
    Joint(f64),
    /// Over the gap between them, and at most this length: each keeps its surface to itself.
    Gap(f64),
}

impl Blend {
    /// The blend is over where one bone is nearer than the other by this much.
    pub(super) fn longest(self) -> f64 {
        match self {
            Self::Joint(length) => length,
            Self::Gap(length) => length * (1.0 + NARROWEST_BLEND),
        }
    }

    /// The share of bone `a` between the two, from their softened distances: one where `a` is clearly nearer, zero where `b` is.
    fn share(self, a: Scalar, b: Scalar) -> Scalar {
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

/// The width of a blend where the distances to the two bones add up to `sum`, and its gradient:
///
/// ```text
/// w² = ε² + q²,   q = ℓ|s|/(ℓ + |s|)
/// ```
///
/// Since q < |s|, a point on the surface of one bone belongs to it alone as soon as the other is some ε away.
fn gap_width(length: f64, sum: Scalar) -> Scalar {
    let narrowest = NARROWEST_BLEND * length;
    let size = sum.0.abs();
    let q = length / (1.0 + length / size);
    let width = (narrowest * narrowest + q * q).sqrt();
    let share = length / (length + size);
    (width, q * share * share / width * sum.0.signum() * sum.1)
}

/// The distance from a bone of this `radius`, flattened inside, so that its kink on the bone's axis does not show:
/// d + d²/2r for −r < d < 0, and constant beyond.
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

/// A bone that has a share in a point, the share wᵢ and its gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Share {
    pub(super) bone: usize,
    pub(super) value: f64,
    pub(super) gradient: DVec3,
}

/// The bones that share a point, from their softened distances there, into `shares`.
///
/// ```text
/// wᵢ = bᵢ / Σⱼ bⱼ,   bᵢ = Πⱼ (share of i between i and j)
/// ```
///
/// Of two bones this leaves the share between the two. `blend` tells how two bones blend, and `widest` bounds the
/// [longest](Blend::longest) of all.
pub(super) fn partition(
    distances: &[Scalar],
    blend: impl Fn(usize, usize) -> Blend,
    widest: f64,
    shares: &mut Vec<Share>,
) {
    shares.clear();
    let nearest = distances.iter().map(|distance| distance.0).fold(f64::INFINITY, f64::min);
    let mut sum: Scalar = (0.0, DVec3::ZERO);
    for (i, &a) in distances.iter().enumerate().filter(|(_, distance)| distance.0 <= nearest + widest) {
        let mut product: Scalar = (1.0, DVec3::ZERO);
        for (j, &b) in distances.iter().enumerate() {
            if j != i {
                let (value, gradient) = blend(i, j).share(a, b);
                product = (product.0 * value, product.1 * value + product.0 * gradient);
                if value == 0.0 {
                    break;
                }
            }
        }
        if product.0 > 0.0 {
            shares.push(Share { bone: i, value: product.0, gradient: product.1 });
            sum = (sum.0 + product.0, sum.1 + product.1);
        }
    }
    for share in shares {
        share.value /= sum.0;
        share.gradient = (share.gradient - share.value * sum.1) / sum.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distances to three spheres on a line, of radius 0.1; the first two share a joint.
    fn distances(point: DVec3) -> [Scalar; 3] {
        [-0.15, 0.0, 0.24].map(|x| {
            let offset = point - DVec3::new(x, 0.0, 0.0);
            softened((offset.length() - 0.1, offset.normalize_or_zero()), 0.1)
        })
    }

    fn shares(point: DVec3) -> [Scalar; 3] {
        let blend = |i: usize, j: usize| if i + j == 1 { Blend::Joint(0.1) } else { Blend::Gap(0.1) };
        let mut found = Vec::new();
        partition(&distances(point), blend, 0.11, &mut found);
        let mut shares = [(0.0, DVec3::ZERO); 3];
        found.iter().for_each(|share| shares[share.bone] = (share.value, share.gradient));
        shares
    }

    #[test]
    fn shares_are_between_zero_and_one_and_add_up_to_one() {
        for point in crate::fields::field::finite_differences::scattered_points(500, 0.4) {
            let shares = shares(point);
            let (sum, slope) = shares.iter().fold((0.0, DVec3::ZERO), |sum, share| (sum.0 + share.0, sum.1 + share.1));
            // Three roundings, and slopes up to 1/ε = 160.
            assert!((sum - 1.0).abs() < 4e-16 && slope.length() < 1e-12, "{point} {sum} {slope}");
            assert!(shares.iter().all(|share| (0.0..=1.0).contains(&share.0)));
        }
    }

    #[test]
    fn gradients_are_those_of_the_shares() {
        let h = 1e-6;
        for point in crate::fields::field::finite_differences::scattered_points(500, 0.3) {
            for bone in 0..3 {
                let slope = DVec3::AXES
                    .map(|axis| (shares(point + h * axis)[bone].0 - shares(point - h * axis)[bone].0) / (2.0 * h));
                // h/2 of second derivatives of the order of 1/ε² = 3e4, which jump on the surfaces.
                assert!(DVec3::from_array(slope).distance(shares(point)[bone].1) < 2e-2, "{point} {bone}");
            }
        }
    }

    #[test]
    fn a_bone_across_a_gap_leaves_the_surface_alone_and_one_at_a_joint_does_not() {
        // The gap between the second and the third sphere is 0.04 wide, more than six times ε.
        for turn in 0..20 {
            let angle = -1.5 + 0.15 * f64::from(turn);
            let on_second = DVec3::new(0.1 * libm::cos(angle), 0.1 * libm::sin(angle), 0.0);
            assert_eq!(shares(on_second)[2], (0.0, DVec3::ZERO), "{angle}");
        }
        let between = shares(DVec3::new(-0.075, 0.0, 0.0));
        assert!((between[0].0 - 0.5).abs() < 1e-12 && between[2].0 == 0.0, "{between:?}");
    }
}
