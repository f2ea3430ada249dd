//! Falloff profiles.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Falloff of a tool's field, from one at the surface to zero at the end of the support.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    /// Twice continuously differentiable; the inside of the tool moves rigidly.
    #[default]
    Quintic,
    /// Three times continuously differentiable; the inside of the tool moves rigidly.
    Septic,
    /// The polynomial of von Funck's region fields; the inside of the tool moves rigidly.
    Quartic,
    /// Steep at the surface, so that material comes close to the tool; continues into the tool
    /// without a kink.
    Contact,
    /// The quadratic of the 2008 thesis, with a kink at the surface.
    Thesis,
}

impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}
