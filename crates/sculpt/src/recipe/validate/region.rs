//! Checks of moving regions.

use super::{
    Check,
    number::{all_finite, direction, finite, positive, rotation},
    reference::{Tools, known_tool},
    strip::smooth_profile,
};
use crate::recipe::{
    InnerRegion, Region, RegionMotion,
    error::RecipeError,
    problem::{CombinationProblem, GeometryProblem},
};

impl Region {
    /// Keys of errors are relative to the stroke.
    pub(super) fn validate(&self, tools: &Tools) -> Check {
        self.motion.validate().map_err(|error| error.inside("motion"))?;
        self.inner.validate(tools).map_err(|error| error.inside("inner"))?;
        positive("outer_distance", self.outer_distance)?;
        smooth_profile(self.profile)
    }
}

impl RegionMotion {
    fn validate(&self) -> Check {
        match (&self.translate, &self.rotate) {
            (Some(shift), None) => Ok(all_finite("translate", shift)?),
            (None, Some(turn)) => {
                all_finite("rotate.origin", &turn.origin)?;
                direction("rotate.axis", &turn.axis)?;
                Ok(finite("rotate.degrees", turn.degrees)?)
            }
            (Some(_), Some(_)) => Err(RecipeError::new("", CombinationProblem::TranslationAndRotation)),
            (None, None) => Err(RecipeError::new("", CombinationProblem::NoMotion)),
        }
    }
}

impl InnerRegion {
    fn validate(&self, tools: &Tools) -> Check {
        match self {
            Self::Sphere(region) => {
                all_finite("center", &region.center)?;
                positive("radius", region.radius)?;
            }
            Self::HalfSpace(region) => {
                all_finite("point", &region.point)?;
                direction("normal", &region.normal)?;
            }
            Self::Capsule(region) => {
                all_finite("from", &region.from)?;
                all_finite("to", &region.to)?;
                if region.from == region.to {
                    return Err(RecipeError::new("to", GeometryProblem::EmptySegment));
                }
                positive("radius", region.radius)?;
            }
            Self::Tool(region) => {
                known_tool(tools, &region.tool)?;
                all_finite("at", &region.at)?;
                rotation("rotate", &region.rotate)?;
            }
        }
        Ok(())
    }
}
