//! The stroke that moves a region of space.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Profile, Recipe,
    error::RecipeProblem,
    tagged::tagged,
    validate::{Check, all_finite, direction, fail, finite, positive, rotation},
};

/// See [`Stroke::Region`](super::Stroke::Region).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// What the region does; it travels with the motion.
    pub motion: RegionMotion,
    /// What moves rigidly.
    pub inner: InnerRegion,
    /// Thickness of the layer around the inner region, over which the motion fades, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub outer_distance: f64,
    /// How the field fades: g of the product form. Any but the kinked `thesis`.
    #[serde(default = "quartic", skip_serializing_if = "is_quartic")]
    pub profile: Profile,
}

fn quartic() -> Profile {
    Profile::Quartic
}

fn is_quartic(profile: &Profile) -> bool {
    *profile == Profile::Quartic
}

/// A translation or a rotation, one of them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionMotion {
    /// Displacement, model units. Either this or `rotate`.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub translate: Option<[f64; 3]>,
    /// Turn about an axis. Either this or `translate`.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub rotate: Option<RegionTurn>,
}

/// A turn about an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionTurn {
    /// A point of the axis, model units.
    pub origin: [f64; 3],
    /// Direction of the axis, of any length.
    pub axis: [f64; 3],
    /// Angle, right-handed.
    pub degrees: f64,
}

/// The part of space that moves rigidly, as it lies at the beginning.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum InnerRegion {
    /// A ball.
    Sphere(SphereRegion),
    /// Everything behind a plane.
    HalfSpace(HalfSpaceRegion),
    /// All points near a segment.
    Capsule(CapsuleRegion),
    /// The inside of a tool.
    Tool(ToolRegion),
}

tagged!(InnerRegion {
    "sphere" => Sphere(SphereRegion),
    "half_space" => HalfSpace(HalfSpaceRegion),
    "capsule" => Capsule(CapsuleRegion),
    "tool" => Tool(ToolRegion),
});

/// See [`InnerRegion::Sphere`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereRegion {
    /// Center, model units.
    pub center: [f64; 3],
    /// Radius, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

/// See [`InnerRegion::HalfSpace`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HalfSpaceRegion {
    /// A point of the plane, model units; of a translation, also the center of the potential.
    pub point: [f64; 3],
    /// Direction away from the half-space, of any length.
    pub normal: [f64; 3],
}

/// See [`InnerRegion::Capsule`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CapsuleRegion {
    /// One end of the segment, model units.
    pub from: [f64; 3],
    /// The other end.
    pub to: [f64; 3],
    /// Distance of the surface from the segment, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

/// See [`InnerRegion::Tool`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ToolRegion {
    /// Name of the tool, one of the recipe's `tools`. Its support and profile play no part.
    pub tool: String,
    /// Place of the tool's origin, model units.
    pub at: [f64; 3],
    /// Axis x, y, z and angle in degrees, right-handed.
    #[serde(default = "super::rotation::no_rotation", skip_serializing_if = "super::rotation::is_no_rotation")]
    pub rotate: [f64; 4],
}

impl Region {
    pub(super) fn validate(&self, recipe: &Recipe) -> Check {
        match (&self.motion.translate, &self.motion.rotate) {
            (Some(shift), None) => all_finite("motion.translate", shift)?,
            (None, Some(turn)) => {
                all_finite("motion.rotate.origin", &turn.origin)?;
                direction("motion.rotate.axis", &turn.axis)?;
                finite("motion.rotate.degrees", turn.degrees)?;
            }
            (Some(_), Some(_)) => {
                let text = "names both a translation and a rotation; make two strokes of them";
                return fail("motion", RecipeProblem::Other(text.to_owned()));
            }
            (None, None) => {
                let text = "names neither `translate` nor `rotate`; add one of them";
                return fail("motion", RecipeProblem::Other(text.to_owned()));
            }
        }
        self.inner.validate(recipe).map_err(|error| error.inside("inner"))?;
        positive("outer_distance", self.outer_distance)?;
        if self.profile == Profile::Thesis {
            let text = "`thesis` has a kink, which this field cannot have; choose another";
            return fail("profile", RecipeProblem::Other(text.to_owned()));
        }
        Ok(())
    }
}

impl InnerRegion {
    fn validate(&self, recipe: &Recipe) -> Check {
        match self {
            Self::Sphere(region) => {
                all_finite("center", &region.center)?;
                positive("radius", region.radius)
            }
            Self::HalfSpace(region) => {
                all_finite("point", &region.point)?;
                direction("normal", &region.normal)
            }
            Self::Capsule(region) => {
                all_finite("from", &region.from)?;
                all_finite("to", &region.to)?;
                if region.from == region.to {
                    let text = "is where the segment begins; choose another point, or a sphere";
                    return fail("to", RecipeProblem::Other(text.to_owned()));
                }
                positive("radius", region.radius)
            }
            Self::Tool(region) => {
                recipe.tool(&region.tool)?;
                all_finite("at", &region.at)?;
                rotation("rotate", &region.rotate)
            }
        }
    }
}
