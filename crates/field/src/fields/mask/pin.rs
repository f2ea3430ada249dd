//! Pins: balls of material that do not move.
//!
//! The factor of a pin is 1 − g((|x − c| − r)/R) with the quintic profile g, center c, radius r and
//! support R.

use glam::DVec3;

use super::{Factor, MaskError};
use crate::fields::Profile;

/// Number of points around a pin at which the speed of a masked field is sampled. Larger: every
/// stroke takes longer. Smaller: the fastest flow around the pin is missed.
const PROBES: u32 = 48;

/// A ball that holds the material inside it, and a layer around it in which the hold fades.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_field::{MaskError, Pin};
///
/// assert!(Pin::new(DVec3::ZERO, 0.5, 0.2).is_ok());
/// assert_eq!(Pin::new(DVec3::ZERO, -0.5, 0.2), Err(MaskError::Radius(-0.5)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin {
    center: DVec3,
    radius: f64,
    support: f64,
}

impl Pin {
    /// A pin that holds everything within `radius` of `center`. Material farther than `radius +
    /// support` is free; lengths are in model units.
    ///
    /// # Errors
    /// [`MaskError::NotFinite`] if the center is not finite, [`MaskError::Radius`] if the radius is
    /// negative or not finite, and [`MaskError::Support`] if the support is not a positive length.
    pub fn new(center: DVec3, radius: f64, support: f64) -> Result<Self, MaskError> {
        if !center.is_finite() {
            return Err(MaskError::NotFinite("the center of a pin"));
        }
        if !(radius >= 0.0 && radius.is_finite()) {
            return Err(MaskError::Radius(radius));
        }
        if !(support > 0.0 && support.is_finite()) {
            return Err(MaskError::Support(support));
        }
        Ok(Self { center, radius, support })
    }

    pub(super) fn support(&self) -> f64 {
        self.support
    }

    /// One minus the profile of the distance from the ball: zero, with zero slope, inside the ball.
    pub(super) fn factor(&self, point: DVec3) -> Factor {
        let arm = point - self.center;
        let (held, slope) = Profile::Quintic.evaluate((arm.length() - self.radius) / self.support);
        Factor { value: 1.0 - held, gradient: -slope / self.support * arm.normalize_or_zero() }
    }

    /// Whether the factor may differ from one in a ball.
    pub(super) fn may_touch(&self, center: DVec3, radius: f64) -> bool {
        center.distance(self.center) < self.radius + self.support + radius
    }

    /// Points halfway through the layer, where the factor varies fastest, spread evenly by the
    /// golden angle.
    pub(super) fn probes(&self) -> impl Iterator<Item = DVec3> + use<> {
        const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
        let Self { center, radius, support } = *self;
        (0..PROBES).map(move |index| {
            let height = 1.0 - (2.0 * f64::from(index) + 1.0) / f64::from(PROBES);
            let ring = libm::sqrt(1.0 - height * height);
            let angle = GOLDEN_ANGLE * f64::from(index);
            center + (radius + 0.5 * support) * DVec3::new(ring * libm::cos(angle), ring * libm::sin(angle), height)
        })
    }
}
