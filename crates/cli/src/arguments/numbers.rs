//! Parsers of numbers, whose errors name the remedy.

use std::num::NonZeroUsize;

/// Parses a number of threads.
pub(super) fn threads(text: &str) -> Result<NonZeroUsize, &'static str> {
    text.parse().map_err(|_| "give a whole number, 1 or more; without this option, all cores are used")
}

/// Parses a number of samples.
pub(super) fn samples(text: &str) -> Result<NonZeroUsize, &'static str> {
    text.parse().map_err(|_| "give a whole number, 1 or more")
}

/// Parses a number of cells. Their minimum is checked when the grid is built.
pub(super) fn cells(text: &str) -> Result<u32, &'static str> {
    text.parse().map_err(|_| "give a whole number of cells, such as 64")
}

/// Parses a length of zero or more, model units.
pub(super) fn length(text: &str) -> Result<f64, &'static str> {
    let length = text.parse().ok().filter(|length: &f64| length.is_finite() && *length >= 0.0);
    length.ok_or("give a finite length, 0 or more")
}

/// Parses a number above zero.
pub(super) fn positive(text: &str) -> Result<f64, &'static str> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or("give a finite number above 0")
}
