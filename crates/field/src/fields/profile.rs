//! Profiles: how a field fades from the surface of a tool to the edge of its support.
//!
//! A profile is a function g(u) of the scaled distance u = d/R, with the signed distance d from the
//! surface and the support R.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, chapter 11; W. von
//! Funck, H. Theisel, H.-P. Seidel, *Vector Field Based Shape Deformations*, 2006 (the quartic).

use std::{fmt, str::FromStr};

use isochore_mesh::LANES;

/// A profile g(u) of the scaled distance u = d/R: the weight of the motion at distance d.
///
/// g and its derivative are exactly zero for u ≥ 1. Quintic, septic and quartic are exactly one for
/// u ≤ 0, so the inside of the tool is a rigid core.
///
/// # Examples
/// ```
/// use isochore_field::Profile;
///
/// let profile: Profile = "quintic".parse()?;
/// assert_eq!(profile.evaluate(0.0).0, 1.0);
/// assert_eq!(profile.evaluate(0.5), (0.5, -1.875));
/// assert_eq!(profile.evaluate(1.0).0, 0.0);
/// # Ok::<(), isochore_field::UnknownProfile>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Profile {
    /// 1 − 10u³ + 15u⁴ − 6u⁵: twice continuously differentiable everywhere.
    #[default]
    Quintic,
    /// 1 − 35u⁴ + 84u⁵ − 70u⁶ + 20u⁷: three times continuously differentiable everywhere.
    Septic,
    /// 1 − 4u³ + 3u⁴: one minus von Funck's blend.
    Quartic,
    /// (1−u)³(1+u), continued into the tool down to u = −½ and constant below: material in contact
    /// approaches the surface exponentially fast. A tool thinner than the support does not reach u
    /// = −½, and its field tears material inside it along its medial axis.
    Contact,
    /// (1−|u|)²: has a kink on the surface, as in the thesis.
    Thesis,
    /// Square of the quintic; see [`squared`](Self::squared).
    QuinticSquared,
    /// Square of the septic.
    SepticSquared,
    /// (1 − 4u³ + 3u⁴)²: von Funck's product form written as a curl.
    QuarticSquared,
    /// Square of the contact profile.
    ContactSquared,
    /// (1−u)² with a rigid core.
    #[cfg(test)]
    Quad,
}

/// Values g(u) and derivatives dg/du of a profile for a block of points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProfileBlock {
    pub(crate) value: [f64; LANES],
    pub(crate) slope: [f64; LANES],
}

impl Profile {
    /// Profiles that a recipe can name.
    pub const ALL: [Self; 5] = [Self::Quintic, Self::Septic, Self::Quartic, Self::Contact, Self::Thesis];

    /// Name in recipes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quintic => "quintic",
            Self::Septic => "septic",
            Self::Quartic => "quartic",
            Self::Contact => "contact",
            Self::Thesis => "thesis",
            Self::QuinticSquared => "quintic²",
            Self::SepticSquared => "septic²",
            Self::QuarticSquared => "quartic²",
            Self::ContactSquared => "contact²",
            #[cfg(test)]
            Self::Quad => "quad",
        }
    }

    /// The profile g², for the field ∇(g p) × ∇(g q), which is the curl of g² ½ (p ∇q − q ∇p).
    ///
    /// Returns `None` if g has a kink or is already a square.
    pub fn squared(self) -> Option<Self> {
        match self {
            Self::Quintic => Some(Self::QuinticSquared),
            Self::Septic => Some(Self::SepticSquared),
            Self::Quartic => Some(Self::QuarticSquared),
            Self::Contact => Some(Self::ContactSquared),
            _ => None,
        }
    }

    /// Values g(u) and dg/du.
    pub fn evaluate(self, u: f64) -> (f64, f64) {
        match self {
            Self::Quintic => quintic(u),
            Self::Septic => septic(u),
            Self::Quartic => quartic(u),
            Self::Contact => contact(u),
            Self::Thesis => thesis(u),
            Self::QuinticSquared => square(quintic(u)),
            Self::SepticSquared => square(septic(u)),
            Self::QuarticSquared => square(quartic(u)),
            Self::ContactSquared => square(contact(u)),
            #[cfg(test)]
            Self::Quad => {
                let rest = 1.0 - u.clamp(0.0, 1.0);
                (rest * rest, if u > 0.0 { -2.0 * rest } else { 0.0 })
            }
        }
    }

    /// Evaluates the profile for the distances of a block, with the support R.
    #[inline(always)]
    pub(crate) fn evaluate_block(self, distances: &[f64; LANES], support: f64) -> ProfileBlock {
        // One loop per profile: the branch is taken once per block, and each loop vectorizes.
        match self {
            Self::Quintic => lanes(distances, support, quintic),
            Self::Septic => lanes(distances, support, septic),
            Self::Quartic => lanes(distances, support, quartic),
            Self::Contact => lanes(distances, support, contact),
            Self::Thesis => lanes(distances, support, thesis),
            Self::QuinticSquared => lanes(distances, support, |u| square(quintic(u))),
            Self::SepticSquared => lanes(distances, support, |u| square(septic(u))),
            Self::QuarticSquared => lanes(distances, support, |u| square(quartic(u))),
            Self::ContactSquared => lanes(distances, support, |u| square(contact(u))),
            #[cfg(test)]
            Self::Quad => lanes(distances, support, |u| self.evaluate(u)),
        }
    }
}

#[inline(always)]
fn lanes(distances: &[f64; LANES], support: f64, profile: impl Fn(f64) -> (f64, f64)) -> ProfileBlock {
    let mut block = ProfileBlock { value: [0.0; LANES], slope: [0.0; LANES] };
    for lane in 0..LANES {
        (block.value[lane], block.slope[lane]) = profile(distances[lane] / support);
    }
    block
}

#[inline(always)]
fn square((value, slope): (f64, f64)) -> (f64, f64) {
    (value * value, 2.0 * value * slope)
}

#[inline(always)]
fn quintic(u: f64) -> (f64, f64) {
    let u = u.clamp(0.0, 1.0);
    let rest = 1.0 - u;
    (1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u)), -30.0 * (u * rest) * (u * rest))
}

#[inline(always)]
fn septic(u: f64) -> (f64, f64) {
    let u = u.clamp(0.0, 1.0);
    let square = u * u;
    let hill = u * (1.0 - u);
    (1.0 - square * square * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u))), -140.0 * hill * hill * hill)
}

#[inline(always)]
fn quartic(u: f64) -> (f64, f64) {
    let u = u.clamp(0.0, 1.0);
    let square = u * u;
    (1.0 - square * u * (4.0 - 3.0 * u), -12.0 * square * (1.0 - u))
}

#[inline(always)]
fn contact(u: f64) -> (f64, f64) {
    let u = u.clamp(-0.5, 1.0);
    let rest = 1.0 - u;
    let square = rest * rest;
    (square * rest * (1.0 + u), -square * (2.0 + 4.0 * u))
}

#[inline(always)]
fn thesis(u: f64) -> (f64, f64) {
    let u = u.clamp(-1.0, 1.0);
    let rest = 1.0 - u.abs();
    (rest * rest, -2.0 * rest * if u < 0.0 { -1.0 } else { 1.0 })
}

impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Error when parsing a name that is not the name of a profile.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown profile `{0}`; the profiles are quintic, septic, quartic, contact and thesis")]
pub struct UnknownProfile(pub String);

impl FromStr for Profile {
    type Err = UnknownProfile;

    fn from_str(name: &str) -> Result<Self, UnknownProfile> {
        Self::ALL.into_iter().find(|profile| profile.name() == name).ok_or_else(|| UnknownProfile(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_the_derivatives() {
        for profile in Profile::ALL {
            for i in 1..60 {
                let u = -0.951 + 0.0371 * f64::from(i);
                let h = 1e-6;
                let expected = (profile.evaluate(u + h).0 - profile.evaluate(u - h).0) / (2.0 * h);
                let (_, slope) = profile.evaluate(u);
                // Truncation h²|g‴|/6 < 1e-10, plus rounding of polynomials whose coefficients sum
                // to 200, over h.
                assert!((slope - expected).abs() < 5e-8, "{profile} at {u}: {slope} against {expected}");
            }
        }
    }

    #[test]
    fn profiles_are_zero_from_the_edge_of_the_support() {
        for profile in Profile::ALL {
            for u in [1.0, 1.0 + 1e-15, 3.0, f64::INFINITY] {
                assert_eq!(profile.evaluate(u), (0.0, -0.0), "{profile} at {u}");
            }
        }
    }

    #[test]
    fn only_smooth_profiles_have_a_rigid_core() {
        for profile in [Profile::Quintic, Profile::Septic, Profile::Quartic] {
            for u in [0.0, -1e-9, -0.7, f64::NEG_INFINITY] {
                assert_eq!(profile.evaluate(u), (1.0, -0.0), "{profile} at {u}");
            }
        }
        assert_eq!(Profile::Contact.evaluate(0.0), (1.0, -2.0));
        assert_eq!(Profile::Contact.evaluate(-0.5), (1.6875, -0.0));
    }

    #[test]
    fn names_parse_to_their_profile() {
        for profile in Profile::ALL {
            assert_eq!(profile.name().parse(), Ok(profile));
        }
        assert!("quntic".parse::<Profile>().is_err());
    }

    #[test]
    fn a_block_has_the_bits_of_single_points() {
        let distances: [f64; LANES] = std::array::from_fn(|lane| -0.2 + 0.04 * lane as f64);
        for profile in Profile::ALL {
            let block = profile.evaluate_block(&distances, 0.3);
            for lane in 0..LANES {
                let (value, slope) = profile.evaluate(distances[lane] / 0.3);
                assert_eq!(
                    (block.value[lane].to_bits(), block.slope[lane].to_bits()),
                    (value.to_bits(), slope.to_bits())
                );
            }
        }
    }
}
