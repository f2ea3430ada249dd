//! Placement of meshes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::rotation::no_rotation;

/// Similarity transform: scaling, then rotation, then translation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Transform {
    /// Scale factor, above zero.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
    /// Axis x, y, z and angle in degrees, right-handed.
    pub rotate: [f64; 4],
    /// Translation, model units.
    pub translate: [f64; 3],
}

impl Default for Transform {
    fn default() -> Self {
        Self { scale: 1.0, rotate: no_rotation(), translate: [0.0; 3] }
    }
}
