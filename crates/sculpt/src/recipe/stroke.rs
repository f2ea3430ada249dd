//! Strokes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{pose::Pose, region::Region, ring::Ring, strip::Strip, tagged::tagged};

/// One deformation. Strokes act one after another.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Stroke {
    /// Rigid motion of a tool, which displaces the material around it.
    Move(Move),
    /// Twist of all space about an axis.
    Twist(Twist),
    /// Rotation of all space about an axis, by an angle that grows with the squared distance from a
    /// point.
    Bend(Bend),
    /// Press of a tool's relief into the surface; the displaced volume rises around it.
    Stamp(Stamp),
    /// Motion of the material around a spine, along the spine or across it.
    Strip(Strip),
    /// Motion of the material inside a ring, along the axis of the ring.
    Ring(Ring),
    /// Motion of a jointed tool.
    Pose(Pose),
    /// Rigid motion of a region of space, which fades in a layer around it.
    Region(Region),
}

tagged!(Stroke { "move" => Move(Move), "twist" => Twist(Twist), "bend" => Bend(Bend), "stamp" => Stamp(Stamp), "strip" => Strip(Strip), "ring" => Ring(Ring), "pose" => Pose(Pose), "region" => Region(Region) });

impl Stroke {
    /// Name of this kind of stroke in recipes and reports.
    ///
    /// ```
    /// use isochore_sculpt::recipe::{Stroke, Twist};
    ///
    /// let twist = Twist { origin: [0.0; 3], axis: [0.0, 0.0, 1.0], degrees_per_unit: 30.0 };
    /// assert_eq!(Stroke::Twist(twist).kind(), "twist");
    /// ```
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Move(_) => "move",
            Self::Twist(_) => "twist",
            Self::Bend(_) => "bend",
            Self::Stamp(_) => "stamp",
            Self::Strip(_) => "strip",
            Self::Ring(_) => "ring",
            Self::Pose(_) => "pose",
            Self::Region(_) => "region",
        }
    }
}

/// See [`Stroke::Move`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Move {
    /// Name of the tool, one of the recipe's `tools`.
    pub tool: String,
    /// Poses of the tool, at least two; it moves along a screw from each to the next.
    pub keys: Vec<Key>,
}

/// Pose of a tool in the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Position of the tool's origin, model units.
    pub at: [f64; 3],
    /// Axis x, y, z and angle in degrees, right-handed; absolute, not relative to the previous
    /// pose.
    #[serde(default = "super::rotation::no_rotation", skip_serializing_if = "super::rotation::is_no_rotation")]
    pub rotate: [f64; 4],
}

/// See [`Stroke::Twist`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Twist {
    /// Point of the axis, in the plane that stays fixed; model units.
    pub origin: [f64; 3],
    /// Direction of the axis, of any length.
    pub axis: [f64; 3],
    /// Angle per unit of height along the axis, right-handed.
    pub degrees_per_unit: f64,
}

/// See [`Stroke::Bend`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bend {
    /// Point that stays fixed, model units.
    pub origin: [f64; 3],
    /// Direction of the axis, of any length.
    pub axis: [f64; 3],
    /// Angle per squared unit of distance from the origin, right-handed.
    pub degrees_per_unit2: f64,
}

/// See [`Stroke::Stamp`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stamp {
    /// Name of the tool, one of the recipe's `tools`. The displaced volume rises within its
    /// support; its profile is ignored.
    pub tool: String,
    /// Poses of the tool, at least two, the first outside the target; it moves along a screw from
    /// each to the next.
    pub keys: Vec<Key>,
    /// Longest edge where the tool touches, model units: an eighth of the relief's wavelength shows
    /// it well. By default a cell of the tool's distance grid, or an eighth of the shortest extent
    /// of a shape.
    #[serde(default, skip_serializing_if = "super::defaults::is_default")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub relief: Option<f64>,
}
