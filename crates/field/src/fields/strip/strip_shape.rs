//! What surrounds the spine of a strip.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{StripError, radius_law::RadiusLaw, section::Section};
use crate::fields::{Profile, Tool};

/// The solid around a spine, and how the field fades beyond it.
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
    /// A round strip of one `radius`, with a `support` beyond it; model units.
    ///
    /// # Errors
    /// [`StripError::Radius`], [`StripError::Support`], [`StripError::Profile`].
    pub fn round(radius: f64, support: f64, profile: Profile) -> Result<Self, StripError> {
        Self::varying(&[radius], support, profile)
    }

    /// A round strip whose radius varies smoothly, through `radii` at equal distances along the spine.
    ///
    /// # Errors
    /// [`StripError::NoRadius`], [`StripError::Radius`], [`StripError::RadiusSwings`], [`StripError::Support`],
    /// [`StripError::Profile`].
    pub fn varying(radii: &[f64], support: f64, profile: Profile) -> Result<Self, StripError> {
        Self::new(CrossSection::Round(RadiusLaw::new(radii)?), support, profile)
    }

    /// A strip whose section in the spine's normal planes is a closed `polygon`, its corners and hollows rounded by an eighth
    /// of the support, or of the polygon's width where that is less. The plane's origin is on the spine; its x axis points along
    /// the part of `reference` normal to the spine where that begins (along its curvature where none is given), and from there on
    /// it turns about the spine no more than it must.
    ///
    /// # Errors
    /// [`StripError::SectionPoints`], [`StripError::SectionEmpty`], [`StripError::SectionCells`], [`StripError::Support`],
    /// [`StripError::Profile`].
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

    /// The shape, support and profile of a tool, whose coordinates are those of the world: the form of the thesis, in which the
    /// spine only says where to.
    ///
    /// # Errors
    /// [`StripError::Profile`].
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

    /// Length over which the field changes.
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
