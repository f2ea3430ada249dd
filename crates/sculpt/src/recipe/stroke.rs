//! The strokes: one entry of the log for each thing done to the mesh.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{pose::Pose, region::Region, ring::Ring, strip::Strip, tagged::tagged};

/// One deformation. Strokes act one after the other.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Stroke {
    /// The rigid motion of a tool, which carries the material around it along.
    Move(Move),
    /// A twist of all space about an axis.
    Twist(Twist),
    /// A swirl of all space about an axis that grows with the squared distance from a point.
    Bend(Bend),
    /// A tool presses its relief into the surface, and what it displaces is raised around it.
    Stamp(Stamp),
    /// A solid about a spine carries the material inside it, along the spine or across it.
    Strip(Strip),
    /// A ring carries the material inside it along its axis.
    Ring(Ring),
    /// A jointed tool goes through postures.
    Pose(Pose),
    /// A region of space moves rigidly, and what surrounds it gives way.
    Region(Region),
}

tagged!(Stroke { "move" => Move(Move), "twist" => Twist(Twist), "bend" => Bend(Bend), "stamp" => Stamp(Stamp), "strip" => Strip(Strip), "ring" => Ring(Ring), "pose" => Pose(Pose), "region" => Region(Region) });

impl Stroke {
    /// The name that recipes and reports use for this kind of stroke.
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
    /// Poses that the tool goes through, at least two; between neighbors it moves along a screw.
    pub keys: Vec<Key>,
}

/// A pose of a tool in the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Place of the tool's origin, model units.
    pub at: [f64; 3],
    /// Axis x, y, z and angle in degrees, right-handed; absolute, not added to the pose before.
    #[serde(default = "super::rotation::no_rotation", skip_serializing_if = "super::rotation::is_no_rotation")]
    pub rotate: [f64; 4],
}

/// See [`Stroke::Twist`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Twist {
    /// A point of the axis, in the plane that stays in place; model units.
    pub origin: [f64; 3],
    /// Direction of the axis, of any length.
    pub axis: [f64; 3],
    /// Angle for each unit of height along the axis, right-handed.
    pub degrees_per_unit: f64,
}

/// See [`Stroke::Bend`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bend {
    /// The point that stays in place, model units.
    pub origin: [f64; 3],
    /// Direction of the axis, of any length.
    pub axis: [f64; 3],
    /// Angle for each squared unit of distance from the origin, right-handed.
    pub degrees_per_unit2: f64,
}

/// See [`Stroke::Stamp`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stamp {
    /// Name of the tool, one of the recipe's `tools`. What it displaces is raised within its support; its profile plays no part.
    pub tool: String,
    /// Poses that the tool goes through, at least two, the first outside the target; between neighbors it moves along a screw.
    pub keys: Vec<Key>,
    /// Longest edge where the tool touches, model units: an eighth of the relief's wavelength shows it well. Without it, a cell of
    /// the tool's distance grid, or an eighth of the shortest extent of a shape.
    #[serde(default, skip_serializing_if = "super::is_default")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub relief: Option<f64>,
}
