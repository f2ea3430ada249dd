//! Strips about a spine.

use std::fmt;

use schemars::JsonSchema;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error, SeqAccess, Visitor, value::SeqAccessDeserializer},
};

use super::{
    Profile,
    error::RecipeProblem,
    is_default,
    ring::smooth_profile,
    validate::{Check, all_finite, direction, fail, finite, positive},
};

/// See [`Stroke::Strip`](super::Stroke::Strip).
///
/// The solid about the spine is given by one of `radius`, `section` and `tool`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Strip {
    /// Which way the material is carried.
    pub mode: StripMode,
    /// The spine, at least two points; a smooth curve goes through them. Or the name of a file of them, relative to the recipe:
    /// three columns, separated by commas.
    pub spine: SpinePoints,
    /// The spine at the end of the stroke, as many points; each moves there straight. What it travels across by `distance` comes
    /// on top.
    #[serde(default, skip_serializing_if = "is_default")]
    pub spine_end: Option<SpinePoints>,
    /// Radius of a round strip, model units; or radii at equal distances along the spine, between which it changes smoothly.
    #[serde(default, skip_serializing_if = "is_default")]
    pub radius: Option<Radius>,
    /// Section of the strip across the spine: corners of a polygon around the origin, which is on the spine; model units.
    #[serde(default, skip_serializing_if = "is_default")]
    pub section: Option<Vec<[f64; 2]>>,
    /// Direction of the section's x axis where the spine begins; without it, the direction in which the spine bends there.
    #[serde(default, skip_serializing_if = "is_default")]
    pub reference: Option<[f64; 3]>,
    /// Name of a tool, one of the recipe's `tools`, whose shape, support and profile are taken, where its own origin is the
    /// world's.
    #[serde(default, skip_serializing_if = "is_default")]
    pub tool: Option<String>,
    /// How far the field reaches beyond radius or section, model units.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub support: Option<f64>,
    /// How the field fades; `quintic` without it, and any but `thesis`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub profile: Option<Profile>,
    /// How far the core is carried, model units; backwards where it is negative.
    pub distance: f64,
    /// Direction in which the spine travels across; of any length.
    #[serde(default, skip_serializing_if = "is_default")]
    pub direction: Option<[f64; 3]>,
}

/// Which way a strip carries the material inside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StripMode {
    /// Along the spine, which stays in place.
    Along,
    /// Across the spine, which travels with what it carries.
    Across,
}

/// Points of a spine, or the file that has them.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum SpinePoints {
    /// Points, in order, model units.
    Points(Vec<[f64; 3]>),
    /// Name of a file, relative to the recipe.
    File(String),
}

/// One radius, or several.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Radius {
    /// The same all along.
    Constant(f64),
    /// At equal distances from the beginning of the spine to its end.
    Varying(Vec<f64>),
}

impl SpinePoints {
    /// The points; none where they are in a file.
    pub fn points(&self) -> &[[f64; 3]] {
        match self {
            Self::Points(points) => points,
            Self::File(_) => &[],
        }
    }

    /// The name of the file, where there is one.
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

// Read by hand: serde's untagged enums forget which element of a list was wrong.
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

pub(super) fn validate(strip: &Strip) -> Check {
    spine("spine", &strip.spine)?;
    strip.spine_end.as_ref().map_or(Ok(()), |end| spine("spine_end", end))?;
    if let (SpinePoints::Points(start), Some(SpinePoints::Points(end))) = (&strip.spine, &strip.spine_end)
        && start.len() != end.len()
    {
        return fail("spine_end", RecipeProblem::WrongLength { found: end.len(), expected: start.len() });
    }
    shape(strip)?;
    finite("distance", strip.distance)?;
    match (strip.mode, strip.direction) {
        (StripMode::Along, None) => Ok(()),
        (StripMode::Along, Some(_)) => other("direction", "is for mode = \"across\"; remove it"),
        (StripMode::Across, Some(vector)) => direction("direction", &vector),
        // A spine that changes its shape need not travel besides.
        (StripMode::Across, None) if strip.distance == 0.0 && strip.spine_end.is_some() => Ok(()),
        (StripMode::Across, None) => fail("direction", RecipeProblem::Missing),
    }
}

fn spine(key: &str, spine: &SpinePoints) -> Check {
    let SpinePoints::Points(points) = spine else { return Ok(()) };
    if points.len() < 2 {
        return fail(key, RecipeProblem::TooSmall { found: points.len() as u64, least: 2 });
    }
    points.iter().enumerate().try_for_each(|(index, point)| all_finite(&format!("{key}.{index}"), point))
}

fn shape(strip: &Strip) -> Check {
    let given = [strip.radius.is_some(), strip.section.is_some(), strip.tool.is_some()];
    match given.iter().filter(|is_given| **is_given).count() {
        0 => return other("", "says nothing of what is about the spine; add one of radius, section and tool"),
        1 => {}
        _ => return other("", "has more than one of radius, section and tool; keep one of them"),
    }
    if strip.tool.is_some() {
        let keys = [("support", strip.support.is_some()), ("profile", strip.profile.is_some())];
        if let Some((key, _)) = keys.iter().find(|(_, is_given)| *is_given) {
            return other(key, "is that of the tool; remove it here");
        }
    } else {
        match strip.support {
            Some(support) => positive("support", support)?,
            None => return fail("support", RecipeProblem::Missing),
        }
    }
    if let Some(radius) = &strip.radius {
        if radius.values().is_empty() {
            return fail("radius", RecipeProblem::TooSmall { found: 0, least: 1 });
        }
        for (index, &value) in radius.values().iter().enumerate() {
            let key = if radius.values().len() == 1 { "radius".to_owned() } else { format!("radius.{index}") };
            positive(&key, value)?;
        }
    }
    if let Some(section) = &strip.section {
        if section.len() < 3 {
            return fail("section", RecipeProblem::TooSmall { found: section.len() as u64, least: 3 });
        }
        for (index, point) in section.iter().enumerate() {
            all_finite(&format!("section.{index}"), point)?;
        }
    }
    match strip.reference {
        Some(_) if strip.section.is_none() => other("reference", "is for strips with a section; remove it"),
        Some(reference) => direction("reference", &reference),
        None => Ok(()),
    }?;
    smooth_profile(strip.profile.unwrap_or_default())
}

fn other(key: &str, text: &str) -> Check {
    fail(key, RecipeProblem::Other(text.to_owned()))
}
