//! Jointed tools: rigid bones that rotate about their joints, with one field for all of them.
//!
//! ```text
//! V = curl(g(u) [A₀ + Σₖ Wₖ ΔAₖ + ∇(Σᵢ wᵢ χᵢ)])
//! ```
//!
//! - u is the smooth minimum of the scaled distances dᵢ/Rᵢ to the bones.
//! - wᵢ is a partition of unity in which each bone has weight one on its own surface.
//! - Wₖ is the sum of wᵢ over the bones that joint k carries.
//! - A₀ is the potential of the motion of the first bone.
//! - ΔAₖ is the potential of the rotation about joint k, in a gauge that vanishes to second order
//!   at the joint, so that ∇Wₖ × ΔAₖ is small where Wₖ changes.
//! - χᵢ shifts the gauge of each part of the motion of bone i to the middle of all bones that the
//!   part moves, which reduces the return flow around them.
//!
//! Along the axis of a rotation, the middle of the parent is used instead. Neighboring fingers that
//! bend alike then have one potential, so the material between them moves with them.
//!
//! Two simpler constructions fail. In the sum of the fields of the bones, material within two
//! supports moves at twice the speed. A blend of their velocities is not a curl.
//!
//! The distance of each bone moves with it and is never resampled.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, section 11.2.6 (sum of
//! the fields of elements); this module blends potentials instead.

mod field;
mod motion;
mod partition;
mod smooth_minimum;

#[cfg(test)]
pub(crate) mod tests;

use std::sync::Arc;

use glam::{DQuat, DVec3};
use isochore_mesh::Aabb;

use crate::fields::{MovingField, Pose, Profile, Tool};
use motion::PostureChange;
use partition::Blend;

/// Width of the smooth minimum, relative to the radius of the thinnest bone. Larger: the union
/// bulges at the joints and its support reaches farther. Smaller: the crease between two bones
/// shows in the field.
const CREASE_WIDTH: f64 = 0.8;

/// A rigid part of a jointed tool.
#[derive(Debug, Clone)]
pub struct Bone {
    /// Shape, support and profile.
    pub tool: Arc<Tool>,
    /// World from tool, at rest.
    pub rest: Pose,
    /// Point that the bone rotates about, in world coordinates at rest.
    pub joint: DVec3,
    /// Index of the bone that carries the joint; `None` for the root bone, which carries all
    /// others.
    pub parent: Option<usize>,
}

/// Placement of a jointed tool and the rotations of its bones.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// Placement of the whole tool: current world position from the position at rest.
    pub root: Pose,
    /// Rotation of each bone about its joint relative to its parent, in the axes of the tool at
    /// rest.
    pub turns: Vec<DQuat>,
}

/// A tree of bones.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use glam::{DQuat, DVec3};
/// use isochore_field::{Bone, JointedTool, Pose, Posture, Profile, Tool, rotation_from_vector};
/// use isochore_mesh::Capsule;
///
/// let shape = Arc::new(Capsule::new(0.15, 0.25).unwrap());
/// let tool = Arc::new(Tool::new(shape, 0.25, Profile::Quintic).unwrap());
/// let bone = |z: f64, joint: f64, parent| Bone {
///     tool: Arc::clone(&tool),
///     rest: Pose::at(DVec3::Z * z),
///     joint: DVec3::Z * joint,
///     parent,
/// };
/// let finger = JointedTool::new(vec![bone(-0.25, -0.5, None), bone(0.25, 0.0, Some(0))])?;
///
/// let posture = |bend: f64| Posture {
///     root: Pose::IDENTITY,
///     turns: vec![DQuat::IDENTITY, rotation_from_vector(DVec3::X * bend)],
/// };
/// let motions = Arc::new(finger).motions(&[posture(0.0), posture(1.0)])?;
///
/// // The second bone rotates about the joint at the origin by one radian.
/// let velocity = motions[0].at(0.0).velocity(DVec3::Z * 0.4);
/// assert!(velocity.distance(-0.4 * DVec3::Y) < 1e-12);
/// # Ok::<(), isochore_field::JointedToolError>(())
/// ```
#[derive(Debug, Clone)]
pub struct JointedTool {
    bones: Vec<Bone>,
    /// Indices of the bones, parents first.
    order: Vec<usize>,
    /// Half the shortest extent of each bone.
    radii: Vec<f64>,
    /// Box of each bone's support, including the bulges at joints, in tool coordinates.
    supports: Vec<Aabb>,
    /// Box of the points that each bone influences, in tool coordinates.
    influences: Vec<Aabb>,
    profile: Profile,
    /// Width of the smooth minimum of the scaled distances.
    crease: f64,
    /// Largest width of a blend between two bones.
    widest: f64,
    /// Bones farther from a point than this do not influence it.
    influence: f64,
    /// Upper bound on the gradient of the scaled distances.
    steepness: f64,
}

impl JointedTool {
    /// A tool of `bones`, which form one tree.
    ///
    /// # Errors
    /// - [`NoFirstBone`](JointedToolError::NoFirstBone),
    ///   [`TwoFirstBones`](JointedToolError::TwoFirstBones),
    ///   [`NoParent`](JointedToolError::NoParent) or [`Circle`](JointedToolError::Circle) if the
    ///   bones do not form one tree.
    /// - [`JointedToolError::Profile`] if the profiles differ.
    /// - [`JointedToolError::NotFinite`] if a rest position or a joint is not finite.
    /// - [`JointedToolError::Reach`] if the sampled distance of a bone ends before
    ///   [`least_reach`](Self::least_reach).
    pub fn new(bones: Vec<Bone>) -> Result<Self, JointedToolError> {
        let order = parents_first(&bones)?;
        let profile = bones[order[0]].tool.profile();
        if let Some(bone) = bones.iter().position(|bone| bone.tool.profile() != profile) {
            return Err(JointedToolError::Profile { bone });
        }
        let not_finite = |bone: &Bone| !(bone.joint.is_finite() && bone.rest.translation.is_finite());
        if let Some(bone) = bones.iter().position(not_finite) {
            return Err(JointedToolError::NotFinite { bone });
        }
        let radii: Vec<f64> = bones.iter().map(|bone| radius(bone.tool.distance().bounds())).collect();
        let scaled = bones.iter().zip(&radii).map(|(bone, radius)| radius / bone.tool.support());
        let crease = CREASE_WIDTH * scaled.fold(f64::INFINITY, f64::min);
        let supports: Vec<f64> = bones.iter().map(|bone| bone.tool.support() * (1.0 + crease)).collect();
        let thickest = radii.iter().copied().fold(0.0, f64::max);
        let widest = Blend::Gap(thickest).longest();
        let influence = supports.iter().copied().fold(0.0, f64::max) + 2.0 * widest;
        if let Some(bone) = bones.iter().position(|bone| bone.tool.distance().reach() < influence) {
            let reach = bones[bone].tool.distance().reach();
            return Err(JointedToolError::Reach { bone, least: influence, reach });
        }
        let steepness =
            bones.iter().map(|bone| bone.tool.distance().lipschitz() / bone.tool.support()).fold(0.0, f64::max);
        let within = |bone: &Bone, distance: f64| bone.tool.distance().bounds_within(distance);
        let supports = bones.iter().zip(supports).map(|(bone, support)| within(bone, support)).collect();
        let influences = bones.iter().map(|bone| within(bone, influence)).collect();
        Ok(Self { bones, order, radii, supports, influences, profile, crease, widest, influence, steepness })
    }

    /// Distance beyond the surface, model units, up to which the distance of every bone must be
    /// known, from the bounds of the shape, in tool coordinates, and the support of each bone.
    pub fn least_reach(shapes: impl IntoIterator<Item = (Aabb, f64)> + Clone) -> f64 {
        let shapes = shapes.into_iter().map(|(bounds, support)| (radius(bounds), support));
        let (thickest, thinnest, widest_support) =
            shapes.fold((0.0, f64::INFINITY, 0.0), |found, (radius, support)| {
                (f64::max(found.0, radius), f64::min(found.1, radius / support), f64::max(found.2, support))
            });
        widest_support * (1.0 + CREASE_WIDTH * thinnest) + 2.0 * Blend::Gap(thickest).longest()
    }

    /// The bones.
    pub fn bones(&self) -> &[Bone] {
        &self.bones
    }

    /// The fields of the motions between successive `keys`. In each, the whole tool moves along a
    /// screw, and every bone rotates about its joint at a constant rate, by less than half a turn.
    ///
    /// # Errors
    /// - [`JointedToolError::TooFewKeys`] for fewer than two keys.
    /// - [`JointedToolError::Turns`] if a posture does not have one rotation for each bone.
    /// - [`JointedToolError::HalfTurn`] if a bone or the whole tool rotates by exactly 180° between
    ///   two keys.
    pub fn motions(self: &Arc<Self>, keys: &[Posture]) -> Result<Vec<Arc<dyn MovingField>>, JointedToolError> {
        if keys.len() < 2 {
            return Err(JointedToolError::TooFewKeys(keys.len()));
        }
        if let Some(key) = keys.iter().position(|key| key.turns.len() != self.bones.len()) {
            return Err(JointedToolError::Turns { key, turns: keys[key].turns.len(), bones: self.bones.len() });
        }
        let pairs = keys.windows(2).enumerate();
        pairs.map(|(key, pair)| Ok(Arc::new(PostureChange::new(self, &pair[0], &pair[1], key)?) as _)).collect()
    }

    /// Blend between the bones `a` and `b`.
    fn blend(&self, a: usize, b: usize) -> Blend {
        let length = self.radii[a].min(self.radii[b]);
        if self.bones[a].parent == Some(b) || self.bones[b].parent == Some(a) {
            Blend::Joint(length)
        } else {
            Blend::Gap(length)
        }
    }
}

/// Half the shortest side of a box.
fn radius(bounds: Aabb) -> f64 {
    0.5 * bounds.size().min_element()
}

/// Indices of the bones, ordered so that each follows its parent.
fn parents_first(bones: &[Bone]) -> Result<Vec<usize>, JointedToolError> {
    let mut roots = (0..bones.len()).filter(|&bone| bones[bone].parent.is_none());
    let Some(first) = roots.next() else { return Err(JointedToolError::NoFirstBone) };
    if let Some(bone) = roots.next() {
        return Err(JointedToolError::TwoFirstBones { first, bone });
    }
    if let Some(bone) = bones.iter().position(|bone| bone.parent.is_some_and(|parent| parent >= bones.len())) {
        return Err(JointedToolError::NoParent { bone });
    }
    let mut order = vec![first];
    let mut done = 0;
    while done < order.len() {
        let parent = order[done];
        order.extend((0..bones.len()).filter(|&bone| bones[bone].parent == Some(parent)));
        done += 1;
    }
    match (0..bones.len()).find(|bone| !order.contains(bone)) {
        Some(bone) => Err(JointedToolError::Circle { bone }),
        None => Ok(order),
    }
}

/// Errors when constructing a [`JointedTool`] or its motions.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum JointedToolError {
    /// Every bone has a parent, or the list of bones is empty.
    #[error("every bone has a parent; one bone must have none, to carry all others")]
    NoFirstBone,
    /// Two bones have no parent.
    #[error("bones {first} and {bone} both have no parent; only one bone can carry all others")]
    TwoFirstBones {
        /// Index of the first of them, from 0.
        first: usize,
        /// Index of the second, from 0.
        bone: usize,
    },
    /// The parent of a bone does not exist.
    #[error("the parent of bone {bone} does not exist; give the index of a bone, from 0")]
    NoParent {
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// The chain of parents of a bone is a cycle.
    #[error("the chain of parents of bone {bone} is a cycle; it must end at a bone without a parent")]
    Circle {
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// The profile of a bone differs from that of the first bone.
    #[error("the profile of bone {bone} differs from that of the bone that carries all others; all must be equal")]
    Profile {
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// A coordinate of a bone is infinite or NaN.
    #[error("the rest position and the joint of bone {bone} must be finite")]
    NotFinite {
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// The sampled distance of a bone ends where other bones still blend with it.
    #[error("the distance of bone {bone} is sampled up to {reach} beyond its surface; sample it up to {least}")]
    Reach {
        /// Index of the bone, from 0.
        bone: usize,
        /// Required reach, model units.
        least: f64,
        /// Reach of the samples, model units.
        reach: f64,
    },
    /// A motion needs at least two postures.
    #[error("the motion needs at least two postures, not {0}")]
    TooFewKeys(usize),
    /// The number of rotations in a posture differs from the number of bones.
    #[error("posture {key} has {turns} rotations for {bones} bones; give one for each bone")]
    Turns {
        /// Index of the posture, from 0.
        key: usize,
        /// Number of rotations given.
        turns: usize,
        /// Number of bones.
        bones: usize,
    },
    /// A bone or the whole tool rotates by exactly half a turn.
    #[error(
        "between postures {key} and {} the rotation of {} is exactly 180°, so its direction is ambiguous; add a posture \
         between them",
        .key + 1, .bone.map_or("the whole tool".to_owned(), |bone| format!("bone {bone}"))
    )]
    HalfTurn {
        /// Index of the first of the two postures, from 0.
        key: usize,
        /// Index of the bone, from 0; `None` for the whole tool.
        bone: Option<usize>,
    },
}
