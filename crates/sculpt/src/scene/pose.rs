//! Strokes of jointed tools.

use std::{collections::BTreeMap, sync::Arc};

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::Aabb;

use crate::recipe::{
    BoneKey, Pose,
    pose::{ROOT, rotation_of},
    rotation::quaternion,
};

/// The stroke that `pose` describes. The outer error refers to the jointed tool, the inner one to
/// its motion.
pub(super) fn stroke(
    pose: &Pose,
    tools: &BTreeMap<&str, Arc<field::Tool>>,
    step: f64,
) -> Result<Result<field::Stroke, field::StrokeError>, field::JointedToolError> {
    let bones = pose.bones.iter().map(|bone| field::Bone {
        tool: Arc::clone(&tools[bone.tool.as_str()]),
        rest: field::Pose { rotation: quaternion(bone.rotate), translation: bone.at.into() },
        joint: bone.joint.into(),
        parent: bone.parent.as_deref().and_then(|parent| pose.bone(parent)),
    });
    let jointed = Arc::new(field::JointedTool::new(bones.collect())?);
    let postures: Vec<_> = pose.keys.iter().map(|key| posture(pose, key)).collect();
    Ok(field::FieldStroke::new(jointed.motions(&postures)?, step).map(field::Stroke::Field).map_err(Into::into))
}

fn posture(pose: &Pose, key: &BTreeMap<String, BoneKey>) -> field::Posture {
    let at = key.get(ROOT).and_then(|root| root.at).map_or(DVec3::ZERO, DVec3::from_array);
    field::Posture {
        root: field::Pose { rotation: rotation_of(key, ROOT), translation: at },
        turns: pose.bones.iter().map(|bone| rotation_of(key, &bone.name)).collect(),
    }
}

/// Distance from its shape up to which every bone must be sampled. `shape` returns bounds and
/// support of a tool.
pub(super) fn least_reach<E>(pose: &Pose, shape: impl Fn(&str) -> Result<(Aabb, f64), E>) -> Result<f64, E> {
    let shapes: Vec<_> = pose.bones.iter().map(|bone| shape(&bone.tool)).collect::<Result<_, _>>()?;
    Ok(field::JointedTool::least_reach(shapes))
}
