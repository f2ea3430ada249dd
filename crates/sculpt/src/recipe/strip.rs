//! Strips around a spine.

use std::fmt;

use schemars::JsonSchema;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error, SeqAccess, Visitor, value::SeqAccessDeserializer},
};

use super::{defaults::is_default, profile::Profile};

/// See [`Stroke::Strip`](super::Stroke::Strip).
///
/// One of `radius`, `section` and `tool` gives the solid around the spine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Strip {
    /// Direction of the motion.
    pub mode: StripMode,
    /// Points of the spine, at least two, through which a smooth curve passes; or the name of a CSV
    /// file with three columns, relative to the recipe.
    pub spine: SpinePoints,
    /// Spine at the end of the stroke, with as many points; each moves along a straight line. The
    /// travel by `distance` is added to it.
    #[serde(default, skip_serializing_if = "is_default")]
    pub spine_end: Option<SpinePoints>,
    /// Radius of a round strip, model units; or radii at equal distances along the spine, which are
    /// interpolated smoothly.
    #[serde(default, skip_serializing_if = "is_default")]
    pub radius: Option<Radius>,
    /// Cross-section of the strip: corners of a polygon around the origin, which is on the spine;
    /// model units.
    #[serde(default, skip_serializing_if = "is_default")]
    pub section: Option<Vec<[f64; 2]>>,
    /// Direction of the cross-section's x axis at the beginning of the spine; by default the
    /// direction in which the spine bends at this point.
    #[serde(default, skip_serializing_if = "is_default")]
    pub reference: Option<[f64; 3]>,
    /// Name of a tool, one of the recipe's `tools`, whose shape, support and profile are used. Its
    /// origin is that of the world.
    #[serde(default, skip_serializing_if = "is_default")]
    pub tool: Option<String>,
    /// Distance from the radius or section at which the field ends, model units.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub support: Option<f64>,
    /// Falloff of the field; `quintic` by default, and any except `thesis`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub profile: Option<Profile>,
    /// Distance that the core moves, model units; a negative one moves it backward.
    pub distance: f64,
    /// Direction in which the spine moves sideways, of any length.
    #[serde(default, skip_serializing_if = "is_default")]
    pub direction: Option<[f64; 3]>,
}

/// Direction in which a strip moves the material inside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StripMode {
    /// Along the spine, which stays fixed.
    Along,
    /// Across the spine, which moves with the material.
    Across,
}

/// Points of a spine, or the file that contains them.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum SpinePoints {
    /// Points in order, model units.
    Points(Vec<[f64; 3]>),
    /// Name of a file, relative to the recipe.
    File(String),
}

/// One radius or several.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Radius {
    /// Equal along the spine.
    Constant(f64),
    /// At equal distances from the beginning of the spine to its end.
    Varying(Vec<f64>),
}

impl SpinePoints {
    /// The points; empty if they are in a file.
    pub fn points(&self) -> &[[f64; 3]] {
        match self {
            Self::Points(points) => points,
            Self::File(_) => &[],
        }
    }

    /// Name of the file, if there is one.
    pub fn file(&self) -> Option<&str> {
        match self {
            Self::Points(_) => None,
            Self::File(name) => Some(name),
        }
    }
}

impl Radius {
    /// The radii, in order.
    pub fn values(&self) -> &[f64] {
        match self {
            Self::Constant(radius) => std::slice::from_ref(radius),
            Self::Varying(radii) => radii,
        }
    }
}

// Implemented by hand: serde's untagged enums do not report which element of a list is wrong.
impl<'de> Deserialize<'de> for SpinePoints {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PointsOrName;
        impl<'de> Visitor<'de> for PointsOrName {
            type Value = SpinePoints;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of points or the name of a file")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<SpinePoints, E> {
                Ok(SpinePoints::File(name.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, points: A) -> Result<SpinePoints, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(points)).map(SpinePoints::Points)
            }
        }
        deserializer.deserialize_any(PointsOrName)
    }
}

impl<'de> Deserialize<'de> for Radius {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMany;
        impl<'de> Visitor<'de> for OneOrMany {
            type Value = Radius;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a list of numbers")
            }

            fn visit_f64<E: Error>(self, radius: f64) -> Result<Radius, E> {
                Ok(Radius::Constant(radius))
            }

            fn visit_i64<E: Error>(self, radius: i64) -> Result<Radius, E> {
                Ok(Radius::Constant(radius as f64))
            }

            fn visit_u64<E: Error>(self, radius: u64) -> Result<Radius, E> {
                Ok(Radius::Constant(radius as f64))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, radii: A) -> Result<Radius, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(radii)).map(Radius::Varying)
            }
        }
        deserializer.deserialize_any(OneOrMany)
    }
}
