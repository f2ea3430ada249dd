//! Jointed tools.

use std::collections::BTreeMap;

use glam::DQuat;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::rotation::quaternion;

/// Name of the whole tool in the keys.
pub(crate) const ROOT: &str = "root";

/// See [`Stroke::Pose`](super::Stroke::Pose).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Rigid parts. All except one name a parent.
    pub bones: Vec<Bone>,
    /// Postures of the tool, at least two: the rotations of bones by name, and of the whole tool by
    /// the name `root`. A bone that a key omits is not rotated.
    pub keys: Vec<BTreeMap<String, BoneKey>>,
}

/// A rigid part of a jointed tool.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bone {
    /// Name, any but `root`.
    pub name: String,
    /// Name of the tool that gives its shape, one of the recipe's `tools`. All bones have the same
    /// profile.
    pub tool: String,
    /// Position of the tool's origin in the world at rest, model units.
    pub at: [f64; 3],
    /// Rotation of the tool at rest: axis x, y, z and angle in degrees, right-handed.
    #[serde(default = "super::rotation::no_rotation", skip_serializing_if = "super::rotation::is_no_rotation")]
    pub rotate: [f64; 4],
    /// Point that the bone rotates about, in the world at rest, model units.
    pub joint: [f64; 3],
    /// Name of the bone with the joint. Exactly one bone has no parent.
    #[serde(default, skip_serializing_if = "super::defaults::is_default")]
    pub parent: Option<String>,
}

/// Rotation of a bone or of the whole tool.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoneKey {
    /// Only for `root`: image of the world's origin at rest, model units.
    #[serde(default, skip_serializing_if = "super::defaults::is_default")]
    pub at: Option<[f64; 3]>,
    /// Axis x, y, z in the world at rest and angle in degrees, right-handed. A bone rotates
    /// relative to its parent about its joint, and the whole tool about the world's origin.
    /// Absolute, not relative to the previous key.
    #[serde(default = "super::rotation::no_rotation", skip_serializing_if = "super::rotation::is_no_rotation")]
    pub rotate: [f64; 4],
}

impl Pose {
    /// Index of the bone with this name.
    pub(crate) fn bone(&self, name: &str) -> Option<usize> {
        self.bones.iter().position(|bone| bone.name == name)
    }
}

/// Rotation of a bone or of the whole tool in a key; the identity if the key omits it.
pub(crate) fn rotation_of(key: &BTreeMap<String, BoneKey>, name: &str) -> DQuat {
    key.get(name).map_or(DQuat::IDENTITY, |turn| quaternion(turn.rotate))
}
