//! Rings.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{defaults::is_default, profile::Profile};

/// See [`Stroke::Ring`](super::Stroke::Ring).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ring {
    /// Center of the ring at the beginning, model units.
    pub center: [f64; 3],
    /// Direction in which the ring moves, across its plane; of any length.
    pub axis: [f64; 3],
    /// Radius of the tube's center line, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub major: f64,
    /// Radius of the tube, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub minor: f64,
    /// Distance from the tube at which the field ends, model units. It must not reach the axis.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub support: f64,
    /// Distance that the ring moves, model units; a negative one moves it backward.
    pub distance: f64,
    /// Falloff of the field; any except `thesis`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub profile: Profile,
}
