//! Masks: fixed parts and planes of symmetry.

use std::fmt;

use schemars::JsonSchema;
use serde::de::{Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

/// Fixed parts and planes of symmetry, placed relative to the target at rest. They act on the
/// vector potential of every stroke, not on its velocity, so the volume is still preserved.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Mask {
    /// Balls that do not move.
    #[serde(skip_serializing_if = "super::defaults::is_default")]
    pub pins: Vec<Pin>,
    /// Planes of symmetry of the strokes, perpendicular to each other.
    #[serde(skip_serializing_if = "super::defaults::is_default")]
    pub mirror: Vec<MirrorPlane>,
    /// Weight of each vertex of the target.
    #[serde(skip_serializing_if = "super::defaults::is_default")]
    pub vertices: Option<VertexWeights>,
    /// Distance over which the weights of vertices fade in space, model units. By default a tenth
    /// of the longest side of the target's bounds, or four mean edge lengths if they are longer.
    #[serde(skip_serializing_if = "super::defaults::is_default")]
    pub fade: Option<f64>,
}

/// A ball that does not move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pin {
    /// Center, model units.
    pub center: [f64; 3],
    /// Radius, model units; zero fixes a point.
    #[schemars(range(min = 0.0))]
    pub radius: f64,
    /// Distance from the ball over which the flow is reduced, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub support: f64,
}

/// A plane of symmetry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MirrorPlane {
    /// Point of the plane, model units.
    pub point: [f64; 3],
    /// Normal of the plane, of any length.
    pub normal: [f64; 3],
}

/// One weight for each vertex of the target, from 0 (free) to 1 (fixed).
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum VertexWeights {
    /// CSV file with one number per row, relative to the recipe.
    File(String),
    /// Numbers in the order of the vertices.
    Values(Vec<f64>),
}

impl Default for VertexWeights {
    fn default() -> Self {
        Self::Values(Vec::new())
    }
}

// Implemented by hand: serde's untagged enums do not report which element of a list is wrong.
impl<'de> Deserialize<'de> for VertexWeights {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WeightsVisitor;

        impl<'de> Visitor<'de> for WeightsVisitor {
            type Value = VertexWeights;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a file or a list of numbers")
            }

            fn visit_str<E>(self, name: &str) -> Result<VertexWeights, E> {
                Ok(VertexWeights::File(name.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<VertexWeights, A::Error> {
                let mut values = Vec::new();
                while let Some(value) = list.next_element()? {
                    values.push(value);
                }
                Ok(VertexWeights::Values(values))
            }
        }

        deserializer.deserialize_any(WeightsVisitor)
    }
}
