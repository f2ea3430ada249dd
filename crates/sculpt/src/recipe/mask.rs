//! What holds the deformation back.

use std::fmt;

use schemars::JsonSchema;
use serde::de::{Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

/// What is held, and planes of symmetry. Both act on the vector potential of every stroke, never on its velocity, so that the
/// volume is kept all the same; they stand where the target stands at rest.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Mask {
    /// Balls that do not move.
    #[serde(skip_serializing_if = "super::is_default")]
    pub pins: Vec<Pin>,
    /// Planes that the strokes are made symmetric about, perpendicular to each other.
    #[serde(skip_serializing_if = "super::is_default")]
    pub mirror: Vec<MirrorPlane>,
    /// How much each vertex of the target is held.
    #[serde(skip_serializing_if = "super::is_default")]
    pub vertices: Option<VertexWeights>,
    /// Length, model units, over which the vertices' hold fades in space; without it a tenth of the longest side of the target's
    /// bounds, or four mean edges where that is more.
    #[serde(skip_serializing_if = "super::is_default")]
    pub fade: Option<f64>,
}

/// A ball that does not move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pin {
    /// Center, model units.
    pub center: [f64; 3],
    /// Radius, model units; zero holds a point.
    #[schemars(range(min = 0.0))]
    pub radius: f64,
    /// How far beyond the ball the flow is held back, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub support: f64,
}

/// A plane of symmetry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MirrorPlane {
    /// A point of the plane.
    pub point: [f64; 3],
    /// Normal of the plane, of any length.
    pub normal: [f64; 3],
}

/// A weight for each vertex of the target in its order, from 0, free, to 1, held.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum VertexWeights {
    /// CSV file with one number a row, relative to the recipe.
    File(String),
    /// The numbers themselves.
    Values(Vec<f64>),
}

impl Default for VertexWeights {
    fn default() -> Self {
        Self::Values(Vec::new())
    }
}

// Serde's untagged enums forget which element of a list was wrong.
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
