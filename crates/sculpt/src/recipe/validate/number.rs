//! Checks of single numbers and vectors.

use glam::DVec3;

use crate::recipe::{error::RecipeError, problem::NumberProblem};

pub(super) type NumberCheck = Result<(), RecipeError<NumberProblem>>;

pub(super) fn finite(key: &str, value: f64) -> NumberCheck {
    require(value.is_finite(), key, NumberProblem::NotFinite(value))
}

pub(super) fn all_finite(key: &str, values: &[f64]) -> NumberCheck {
    values.iter().try_for_each(|&value| finite(key, value))
}

pub(super) fn positive(key: &str, value: f64) -> NumberCheck {
    finite(key, value)?;
    require(value > 0.0, key, NumberProblem::NotPositive(value))
}

pub(super) fn all_positive(key: &str, values: &[f64]) -> NumberCheck {
    values.iter().try_for_each(|&value| positive(key, value))
}

pub(super) fn not_negative(key: &str, value: f64) -> NumberCheck {
    finite(key, value)?;
    require(value >= 0.0, key, NumberProblem::Negative(value))
}

pub(super) fn at_most(key: &str, found: f64, most: f64) -> NumberCheck {
    require(found <= most, key, NumberProblem::AboveMost { found, most })
}

/// From 0 to 1.
pub(super) fn fraction(key: &str, value: f64) -> NumberCheck {
    not_negative(key, value)?;
    at_most(key, value, 1.0)
}

pub(super) fn at_least(key: &str, found: u64, least: u64) -> NumberCheck {
    require(found >= least, key, NumberProblem::TooSmall { found, least })
}

pub(super) fn all_at_least(key: &str, found: &[u32], least: &[u64]) -> NumberCheck {
    found.iter().zip(least).try_for_each(|(&found, &least)| at_least(key, found.into(), least))
}

/// A list with at least so many entries.
pub(super) fn enough(key: &str, found: usize, least: usize) -> NumberCheck {
    require(found >= least, key, NumberProblem::TooFew { found, least })
}

pub(super) fn direction(key: &str, axis: &[f64; 3]) -> NumberCheck {
    all_finite(key, axis)?;
    // The test that later computes a unit vector, so that no axis passes here and fails there.
    require(DVec3::from_array(*axis).try_normalize().is_some(), key, NumberProblem::ZeroAxis)
}

/// An axis x, y, z and an angle in degrees.
pub(super) fn rotation(key: &str, rotate: &[f64; 4]) -> NumberCheck {
    let [x, y, z, degrees] = *rotate;
    direction(key, &[x, y, z])?;
    finite(key, degrees)
}

pub(super) fn require(is_met: bool, key: &str, problem: NumberProblem) -> NumberCheck {
    if is_met { Ok(()) } else { Err(RecipeError::new(key, problem)) }
}
