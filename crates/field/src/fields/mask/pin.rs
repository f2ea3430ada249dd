//! Pins: balls that hold what is in them.

use glam::DVec3;

use super::{Factor, MaskError};
use crate::fields::Profile;

/// Points about a pin at which the speed of a masked field is looked up. More costs time for every stroke; fewer misses where
/// the flow around the pin is fastest.
const PROBES: u32 = 48;

/// A ball that does not move, and the shell around it in which the flow grows free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin {
    center: DVec3,
    radius: f64,
    support: f64,
}

impl Pin {
    /// A pin that holds everything within `radius` of `center`, and nothing farther than `support` beyond that.
    ///
    /// # Errors
    /// [`MaskError::NotFinite`], [`MaskError::Radius`], [`MaskError::Support`].
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

    /// One minus the profile of the distance from the ball: zero, with zero slope, all through the ball.
    pub(super) fn factor(&self, point: DVec3) -> Factor {
        let arm = point - self.center;
        let (held, slope) = Profile::Quintic.evaluate((arm.length() - self.radius) / self.support);
        Factor { value: 1.0 - held, gradient: -slope / self.support * arm.normalize_or_zero() }
    }

    /// Whether the factor changes somewhere in a ball.
    pub(super) fn may_touch(&self, center: DVec3, radius: f64) -> bool {
        center.distance(self.center) < self.radius + self.support + radius
    }

    /// Points in the middle of the shell, where the factor changes fastest, evenly spread by the golden angle.
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
