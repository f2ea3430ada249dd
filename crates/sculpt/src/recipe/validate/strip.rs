//! Checks of strips and rings.

use super::{
    Check,
    number::{NumberCheck, all_finite, direction, enough, finite, positive},
};
use crate::recipe::{
    Profile, Radius, Ring, SpinePoints, Strip, StripMode,
    error::RecipeError,
    problem::{CombinationProblem, GeometryProblem},
};

impl Strip {
    /// Checks everything except the name of the tool. Keys of errors are relative to the stroke.
    pub(super) fn validate(&self) -> Check {
        spine("spine", &self.spine)?;
        if let Some(end) = &self.spine_end {
            spine("spine_end", end)?;
        }
        self.validate_spine_lengths()?;
        self.validate_cross_section()?;
        finite("distance", self.distance)?;
        self.validate_direction()
    }

    fn validate_spine_lengths(&self) -> Check {
        let (SpinePoints::Points(start), Some(SpinePoints::Points(end))) = (&self.spine, &self.spine_end) else {
            return Ok(());
        };
        let (found, expected) = (end.len(), start.len());
        if found == expected {
            return Ok(());
        }
        Err(RecipeError::new("spine_end", CombinationProblem::SpinesDiffer { found, expected }))
    }

    /// Checks the shape around the spine.
    fn validate_cross_section(&self) -> Check {
        let given = [self.radius.is_some(), self.section.is_some(), self.tool.is_some()];
        match given.iter().filter(|is_given| **is_given).count() {
            0 => return combination("", CombinationProblem::NoCrossSection),
            1 => {}
            _ => return combination("", CombinationProblem::SeveralCrossSections),
        }
        self.validate_support()?;
        if let Some(radius) = &self.radius {
            radii(radius)?;
        }
        if let Some(section) = &self.section {
            enough("section", section.len(), 3)?;
            for (index, point) in section.iter().enumerate() {
                all_finite(&format!("section.{index}"), point)?;
            }
        }
        if let Some(reference) = &self.reference {
            if self.section.is_none() {
                return combination("reference", CombinationProblem::OnlyWithSection);
            }
            direction("reference", reference)?;
        }
        smooth_profile(self.profile.unwrap_or_default())
    }

    /// A tool determines support and profile.
    fn validate_support(&self) -> Check {
        match (&self.tool, self.support) {
            (Some(_), Some(_)) => combination("support", CombinationProblem::SetByTool),
            (Some(_), None) if self.profile.is_some() => combination("profile", CombinationProblem::SetByTool),
            (Some(_), None) => Ok(()),
            (None, Some(support)) => Ok(positive("support", support)?),
            (None, None) => combination("support", CombinationProblem::Missing),
        }
    }

    fn validate_direction(&self) -> Check {
        match (self.mode, self.direction) {
            (StripMode::Along, None) => Ok(()),
            (StripMode::Along, Some(_)) => combination("direction", CombinationProblem::OnlyAcross),
            (StripMode::Across, Some(vector)) => Ok(direction("direction", &vector)?),
            // A spine that deforms need not travel as well.
            (StripMode::Across, None) if self.distance == 0.0 && self.spine_end.is_some() => Ok(()),
            (StripMode::Across, None) => combination("direction", CombinationProblem::Missing),
        }
    }
}

impl Ring {
    /// Keys of errors are relative to the stroke.
    pub(super) fn validate(&self) -> Check {
        all_finite("center", &self.center)?;
        direction("axis", &self.axis)?;
        positive("major", self.major)?;
        positive("minor", self.minor)?;
        positive("support", self.support)?;
        finite("distance", self.distance)?;
        smooth_profile(self.profile)
    }
}

fn spine(key: &str, spine: &SpinePoints) -> NumberCheck {
    let SpinePoints::Points(points) = spine else { return Ok(()) };
    enough(key, points.len(), 2)?;
    points.iter().enumerate().try_for_each(|(index, point)| all_finite(&format!("{key}.{index}"), point))
}

fn radii(radius: &Radius) -> NumberCheck {
    let values = radius.values();
    enough("radius", values.len(), 1)?;
    for (index, &value) in values.iter().enumerate() {
        let key = if values.len() == 1 { "radius".to_owned() } else { format!("radius.{index}") };
        positive(&key, value)?;
    }
    Ok(())
}

/// Refuses the profile with a kink, which tears fields that are not rigid motions.
pub(super) fn smooth_profile(profile: Profile) -> Check {
    match profile {
        Profile::Thesis => Err(RecipeError::new("profile", GeometryProblem::KinkedProfile)),
        _ => Ok(()),
    }
}

fn combination(key: &str, problem: CombinationProblem) -> Check {
    Err(RecipeError::new(key, problem))
}
