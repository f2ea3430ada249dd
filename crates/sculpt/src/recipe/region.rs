//! Moving regions of space.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{profile::Profile, tagged::tagged};

/// See [`Stroke::Region`](super::Stroke::Region).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Motion of the region.
    pub motion: RegionMotion,
    /// Part of space that moves rigidly.
    pub inner: InnerRegion,
    /// Thickness of the layer around the inner region, over which the motion fades, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub outer_distance: f64,
    /// Falloff of the field: g of the product form. Any except `thesis`, which has a kink.
    #[serde(default = "quartic", skip_serializing_if = "is_quartic")]
    pub profile: Profile,
}

fn quartic() -> Profile {
    Profile::Quartic
}

fn is_quartic(profile: &Profile) -> bool {
    *profile == Profile::Quartic
}

/// Either a translation or a rotation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionMotion {
    /// Translation, model units. Either this or `rotate`.
    #[serde(default, skip_serializing_if = "super::defaults::is_default")]
    pub translate: Option<[f64; 3]>,
    /// Rotation about an axis. Either this or `translate`.
    #[serde(default, skip_serializing_if = "super::defaults::is_default")]
    pub rotate: Option<RegionTurn>,
}

/// Rotation about an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionTurn {
    /// Point of the axis, model units.
    pub origin: [f64; 3],
    /// Direction of the axis, of any length.
    pub axis: [f64; 3],
    /// Angle in degrees, right-handed.
    pub degrees: f64,
}

/// Part of space that moves rigidly, before the motion.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum InnerRegion {
    /// A ball.
    Sphere(SphereRegion),
    /// All points behind a plane.
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
    /// Point of the plane, model units; for a translation, also the center of the potential.
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
    /// Name of the tool, one of the recipe's `tools`. Its support and profile are ignored.
    pub tool: String,
    /// Position of the tool's origin, model units.
    pub at: [f64; 3],
    /// Axis x, y, z and angle in degrees, right-handed.
    #[serde(default = "super::rotation::no_rotation", skip_serializing_if = "super::rotation::is_no_rotation")]
    pub rotate: [f64; 4],
}
