//! The solid around the spine of a strip.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{StripError, radius_law::RadiusLaw, section::Section};
use crate::fields::{Profile, Tool};

/// The solid around a spine, and the profile by which the field fades beyond it.
///
/// # Examples
/// ```
/// use isochore_field::{Profile, StripError, StripShape};
///
/// assert!(StripShape::varying(&[0.1, 0.2, 0.1], 0.3, Profile::Quintic).is_ok());
/// let error = StripShape::round(0.2, 0.3, Profile::Thesis).unwrap_err();
/// assert_eq!(error, StripError::Profile(Profile::Thesis));
/// ```
#[derive(Debug, Clone)]
pub struct StripShape {
    pub(super) cross_section: CrossSection,
    pub(super) support: f64,
    pub(super) profile: Profile,
}

#[derive(Debug, Clone)]
pub(super) enum CrossSection {
    Round(RadiusLaw),
    Polygon { section: Arc<Section>, reference: Option<DVec3> },
    Tool(Arc<Tool>),
}

impl StripShape {
    /// A round strip with a constant `radius` and a `support` beyond it, model units.
    ///
    /// # Errors
    /// [`StripError::Radius`] or [`StripError::Support`] if a length is not positive, and
    /// [`StripError::Profile`] for the profile with a kink.
    pub fn round(radius: f64, support: f64, profile: Profile) -> Result<Self, StripError> {
        Self::varying(&[radius], support, profile)
    }

    /// A round strip whose radius varies smoothly through `radii`, evenly spaced along the spine.
    ///
    /// # Errors
    /// [`StripError::NoRadius`] if the list is empty, [`StripError::RadiusSwings`] if the smooth
    /// curve through the radii falls to zero, and the errors of [`round`](Self::round).
    pub fn varying(radii: &[f64], support: f64, profile: Profile) -> Result<Self, StripError> {
        Self::new(CrossSection::Round(RadiusLaw::new(radii)?), support, profile)
    }

    /// A strip with a closed `polygon` as its cross-section in the normal planes of the spine.
    /// Convex and concave corners are rounded by an eighth of the support, or of the polygon's
    /// width if that is smaller.
    ///
    /// The origin of the plane is on the spine. At the start of the spine, the x axis is along the
    /// part of `reference` normal to the spine, by default along the curvature. From there it
    /// follows the rotation-minimizing frame.
    ///
    /// # Errors
    /// [`StripError::SectionPoints`], [`StripError::SectionEmpty`] or [`StripError::SectionCells`]
    /// if the polygon has too few or nonfinite points, encloses no area or needs too many samples.
    /// [`StripError::Support`] if the support is not a positive length, and [`StripError::Profile`]
    /// for the profile with a kink.
    pub fn polygon(
        polygon: &[DVec2],
        reference: Option<DVec3>,
        support: f64,
        profile: Profile,
    ) -> Result<Self, StripError> {
        check_support(support)?;
        let section = Arc::new(Section::new(polygon, support)?);
        Self::new(CrossSection::Polygon { section, reference }, support, profile)
    }

    /// The shape, support and profile of a tool whose coordinates are world coordinates. This is
    /// the form of the thesis, in which the spine only defines the direction of motion.
    ///
    /// # Errors
    /// [`StripError::Profile`] for the profile with a kink.
    pub fn tool(tool: Arc<Tool>) -> Result<Self, StripError> {
        let (support, profile) = (tool.support(), tool.profile());
        Self::new(CrossSection::Tool(tool), support, profile)
    }

    fn new(cross_section: CrossSection, support: f64, profile: Profile) -> Result<Self, StripError> {
        check_support(support)?;
        if profile == Profile::Thesis {
            return Err(StripError::Profile(profile));
        }
        Ok(Self { cross_section, support, profile })
    }

    /// Length over which the field varies.
    pub(super) fn feature_size(&self) -> f64 {
        match &self.cross_section {
            CrossSection::Round(law) => self.support.min(law.smallest()),
            CrossSection::Polygon { section, .. } => self.support.min(section.feature_size()),
            CrossSection::Tool(tool) => tool.feature_size(),
        }
    }
}

fn check_support(support: f64) -> Result<(), StripError> {
    if support > 0.0 && support.is_finite() { Ok(()) } else { Err(StripError::Support(support)) }
}
