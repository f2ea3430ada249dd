//! The stroke of a jointed tool.

use std::collections::BTreeMap;

use glam::DQuat;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Recipe,
    error::{RecipeError, RecipeProblem, nearest},
    rotation::quaternion,
    validate::{Check, all_finite, fail, is_half_turn, rotation},
};

/// The name in the keys that stands for the whole tool.
pub(crate) const ROOT: &str = "root";

/// See [`Stroke::Pose`](super::Stroke::Pose).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// The rigid parts. All but one name a parent.
    pub bones: Vec<Bone>,
    /// Postures that the tool goes through, at least two, each with the turns of bones by name, and `root` for the whole. What a
    /// key leaves out is not turned.
    pub keys: Vec<BTreeMap<String, BoneKey>>,
}

/// A rigid part of a jointed tool.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bone {
    /// Name, any but `root`.
    pub name: String,
    /// Name of the tool that gives its shape, one of the recipe's `tools`. All bones have the same profile.
    pub tool: String,
    /// Place of the tool's origin in the world at rest, model units.
    pub at: [f64; 3],
    /// Turn of the tool at rest: axis x, y, z and angle in degrees, right-handed.
    #[serde(default = "super::rotation::no_rotation", skip_serializing_if = "super::rotation::is_no_rotation")]
    pub rotate: [f64; 4],
    /// The point that the bone turns about, in the world at rest, model units.
    pub joint: [f64; 3],
    /// Name of the bone that carries the joint. Exactly one bone has none.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub parent: Option<String>,
}

/// How far a bone, or the whole, is turned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoneKey {
    /// Only of `root`: where the world's origin at rest has come to, model units.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub at: Option<[f64; 3]>,
    /// Axis x, y, z in the world at rest and angle in degrees, right-handed: of a bone past its parent about its joint, of the
    /// whole about the world's origin. Absolute, not added to the key before.
    #[serde(default = "super::rotation::no_rotation", skip_serializing_if = "super::rotation::is_no_rotation")]
    pub rotate: [f64; 4],
}

impl Pose {
    /// The number of the bone with this name.
    pub(crate) fn bone(&self, name: &str) -> Option<usize> {
        self.bones.iter().position(|bone| bone.name == name)
    }

    pub(super) fn validate(&self, recipe: &Recipe) -> Check {
        for (index, bone) in self.bones.iter().enumerate() {
            let inside = |error: RecipeError| error.inside(&index.to_string()).inside("bones");
            self.validate_bone(index, bone, recipe).map_err(inside)?;
        }
        self.validate_tree()?;
        if self.keys.len() < 2 {
            return fail("keys", RecipeProblem::TooFewKeys(self.keys.len()));
        }
        for (index, key) in self.keys.iter().enumerate() {
            for (name, turn) in key {
                let inside = |error: RecipeError| error.inside(name).inside(&index.to_string()).inside("keys");
                self.validate_turn(name, turn).map_err(inside)?;
            }
        }
        self.validate_ways()
    }

    fn validate_bone(&self, index: usize, bone: &Bone, recipe: &Recipe) -> Check {
        if bone.name == ROOT {
            let text = format!("`{ROOT}` stands for the whole tool in the keys; give the bone another name");
            return fail("name", RecipeProblem::Other(text));
        }
        if self.bone(&bone.name) != Some(index) {
            let text = format!("there is a bone `{}` already; names must differ", bone.name);
            return fail("name", RecipeProblem::Other(text));
        }
        recipe.tool(&bone.tool)?;
        let [profile, first] = [&bone.tool, &self.bones[0].tool].map(|name| recipe.tools[name].profile);
        if profile != first {
            let text =
                format!("its profile {profile} differs from {first}, that of the first bone; one stroke has one");
            return fail("tool", RecipeProblem::Other(text));
        }
        all_finite("at", &bone.at)?;
        rotation("rotate", &bone.rotate)?;
        all_finite("joint", &bone.joint)?;
        match &bone.parent {
            Some(parent) if self.bone(parent).is_none() => fail("parent", self.unknown_bone(parent)),
            _ => Ok(()),
        }
    }

    /// Exactly one bone carries all others.
    fn validate_tree(&self) -> Check {
        let mut first = None;
        for (index, bone) in self.bones.iter().enumerate() {
            if bone.parent.is_none()
                && let Some(first) = first.replace(index)
            {
                let text =
                    format!("lacks a parent, as `{}` does; only one bone can carry all others", self.bones[first].name);
                return fail(&format!("bones.{index}"), RecipeProblem::Other(text));
            }
            let mut names = vec![bone.name.as_str()];
            let mut at = bone;
            while let Some(parent) = at.parent.as_deref().and_then(|parent| self.bone(parent)) {
                at = &self.bones[parent];
                names.push(&at.name);
                if at.name == bone.name {
                    let text = format!("leads round in a circle: {}", names.join(", "));
                    return fail(&format!("bones.{index}.parent"), RecipeProblem::Other(text));
                }
                if names.len() > self.bones.len() {
                    break;
                }
            }
        }
        match first {
            Some(_) => Ok(()),
            None => fail("bones", RecipeProblem::Other("has no bone; add one without a parent".to_owned())),
        }
    }

    fn validate_turn(&self, name: &str, turn: &BoneKey) -> Check {
        if name != ROOT {
            if self.bone(name).is_none() {
                return fail("", self.unknown_bone(name));
            }
            if turn.at.is_some() {
                let text = format!("only `{ROOT}` has a place of its own; a bone turns about its joint");
                return fail("at", RecipeProblem::Other(text));
            }
        }
        turn.at.map_or(Ok(()), |at| all_finite("at", &at))?;
        rotation("rotate", &turn.rotate)
    }

    /// No bone turns by exactly half a turn between keys.
    fn validate_ways(&self) -> Check {
        let names = || self.bones.iter().map(|bone| bone.name.as_str()).chain([ROOT]);
        for (index, keys) in self.keys.windows(2).enumerate() {
            for name in names() {
                let [before, after] = [0, 1].map(|key| turn_of(&keys[key], name));
                if is_half_turn(before, after) {
                    return fail(&format!("keys.{}.{name}.rotate", index + 1), RecipeProblem::HalfTurn);
                }
            }
        }
        Ok(())
    }

    fn unknown_bone(&self, name: &str) -> RecipeProblem {
        let known: Vec<String> = self.bones.iter().map(|bone| bone.name.clone()).collect();
        let nearest = nearest(name, known.iter().map(String::as_str));
        RecipeProblem::UnknownBone { name: name.to_owned(), nearest, known }
    }
}

/// The turn of a bone, or of the whole, in a key; none where the key leaves it out.
pub(crate) fn turn_of(key: &BTreeMap<String, BoneKey>, name: &str) -> DQuat {
    key.get(name).map_or(DQuat::IDENTITY, |turn| quaternion(turn.rotate))
}
