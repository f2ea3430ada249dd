//! Checks of jointed tools.

use super::{
    Check,
    keys::{enough_keys, is_half_turn},
    number::{all_finite, rotation},
    reference::{Tools, known_tool},
};
use crate::recipe::{
    Bone, BoneKey, Pose,
    error::RecipeError,
    pose::{ROOT, rotation_of},
    problem::{GeometryProblem, ReferenceProblem, SkeletonProblem},
    suggestion::Suggestion,
};

impl Pose {
    /// Keys of errors are relative to the stroke.
    pub(super) fn validate(&self, tools: &Tools) -> Check {
        for (index, bone) in self.bones.iter().enumerate() {
            self.validate_bone(index, bone, tools).map_err(|error| error.inside(&index.to_string()).inside("bones"))?;
        }
        self.validate_tree()?;
        enough_keys(self.keys.len())?;
        for (index, key) in self.keys.iter().enumerate() {
            for (name, bone_key) in key {
                self.validate_key(name, bone_key)
                    .map_err(|error| error.inside(name).inside(&index.to_string()).inside("keys"))?;
            }
        }
        Ok(self.validate_rotations()?)
    }

    fn validate_bone(&self, index: usize, bone: &Bone, tools: &Tools) -> Check {
        if bone.name == ROOT {
            return Err(RecipeError::new("name", SkeletonProblem::ReservedName(ROOT)));
        }
        if self.bone(&bone.name) != Some(index) {
            return Err(RecipeError::new("name", SkeletonProblem::DuplicateName(bone.name.clone())));
        }
        known_tool(tools, &bone.tool)?;
        let [profile, first] = [&bone.tool, &self.bones[0].tool].map(|name| tools[name].profile);
        if profile != first {
            let problem = SkeletonProblem::ProfilesDiffer { found: profile.to_string(), expected: first.to_string() };
            return Err(RecipeError::new("tool", problem));
        }
        all_finite("at", &bone.at)?;
        rotation("rotate", &bone.rotate)?;
        all_finite("joint", &bone.joint)?;
        match &bone.parent {
            Some(parent) if self.bone(parent).is_none() => Err(self.unknown_bone("parent", parent).widen()),
            _ => Ok(()),
        }
    }

    /// Exactly one bone is the ancestor of all others.
    fn validate_tree(&self) -> Result<(), RecipeError<SkeletonProblem>> {
        let mut root: Option<&Bone> = None;
        for (index, bone) in self.bones.iter().enumerate() {
            if bone.parent.is_none()
                && let Some(root) = root.replace(bone)
            {
                return Err(RecipeError::new(
                    &format!("bones.{index}"),
                    SkeletonProblem::SecondRoot(root.name.clone()),
                ));
            }
            if let Some(cycle) = self.cycle(bone) {
                return Err(RecipeError::new(&format!("bones.{index}.parent"), SkeletonProblem::Cycle(cycle)));
            }
        }
        match root {
            Some(_) => Ok(()),
            None => Err(RecipeError::new("bones", SkeletonProblem::NoRoot)),
        }
    }

    /// Names from `bone` through its ancestors back to itself, or `None` if it is not its own
    /// ancestor.
    fn cycle(&self, bone: &Bone) -> Option<String> {
        let mut names = vec![bone.name.as_str()];
        let mut ancestor = bone;
        // A bone outside a cycle may lead into one, in which the walk would not end.
        while names.len() <= self.bones.len() {
            ancestor = &self.bones[self.bone(ancestor.parent.as_deref()?)?];
            names.push(&ancestor.name);
            if ancestor.name == bone.name {
                return Some(names.join(", "));
            }
        }
        None
    }

    fn validate_key(&self, name: &str, key: &BoneKey) -> Check {
        if name != ROOT {
            if self.bone(name).is_none() {
                return Err(self.unknown_bone("", name).widen());
            }
            if key.at.is_some() {
                return Err(RecipeError::new("at", SkeletonProblem::PositionOfBone(ROOT)));
            }
        }
        if let Some(at) = &key.at {
            all_finite("at", at)?;
        }
        Ok(rotation("rotate", &key.rotate)?)
    }

    /// No bone rotates by exactly half a turn between keys.
    fn validate_rotations(&self) -> Result<(), RecipeError<GeometryProblem>> {
        for (index, keys) in self.keys.windows(2).enumerate() {
            for name in self.bones.iter().map(|bone| bone.name.as_str()).chain([ROOT]) {
                if is_half_turn(rotation_of(&keys[0], name), rotation_of(&keys[1], name)) {
                    let key = format!("keys.{}.{name}.rotate", index + 1);
                    return Err(RecipeError::new(&key, GeometryProblem::HalfTurn));
                }
            }
        }
        Ok(())
    }

    fn unknown_bone(&self, key: &str, name: &str) -> RecipeError<ReferenceProblem> {
        let suggestion = Suggestion::new(name, self.bones.iter().map(|bone| bone.name.as_str()));
        RecipeError::new(key, ReferenceProblem::UnknownBone { name: name.to_owned(), suggestion })
    }
}
