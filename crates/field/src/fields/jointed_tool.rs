//! A jointed tool: rigid bones that turn about their joints, and the one field of all of them.
//!
//! ```text
//! V = curl(g(u) [A₀ + Σₖ Wₖ ΔAₖ + ∇(Σᵢ wᵢ χᵢ)])
//! ```
//!
//! u is the smooth minimum of the scaled distances dᵢ/Rᵢ to the bones, wᵢ a partition of unity that gives every bone its
//! own surface, and Wₖ the sum of wᵢ over the bones that joint k carries. A₀ is the potential of the first bone's motion, ΔAₖ
//! that of the turn about joint k, in a gauge that vanishes to second order there, so that ∇Wₖ × ΔAₖ stays small where Wₖ
//! changes; χᵢ moves the gauge of each part of bone i's motion to the middle of all bones that the part moves, which cuts the
//! flow back around them. Along the axis of a turn that middle is the parent's, so that fingers side by side which bend alike
//! have one potential, and the material between them goes with them. Summing the fields of the bones instead would move what
//! two of them share at twice the speed; blending their velocities would be no curl.
//!
//! The distances belong to the bones and move with them: they are never sampled anew.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, section 11.2.6 (the sum of the fields of elements),
//! with potentials blended in place of the sum.

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

/// Width of the smooth minimum, as a share of the thinnest bone's radius. Larger: the union bulges at the joints and its
/// support reaches farther. Smaller: the crease between two bones shows in the field.
const CREASE_WIDTH: f64 = 0.8;

/// A rigid part of a jointed tool.
#[derive(Debug, Clone)]
pub struct Bone {
    /// Shape, support and profile.
    pub tool: Arc<Tool>,
    /// World from tool at rest.
    pub rest: Pose,
    /// The point that the bone turns about, in the world at rest.
    pub joint: DVec3,
    /// Index of the bone that carries the joint; none for the first bone of all, whose joint the whole tool carries.
    pub parent: Option<usize>,
}

/// How far the bones of a jointed tool are turned.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// Where the whole tool is: the world now from the world at rest.
    pub root: Pose,
    /// The turn of each bone about its joint, past its parent, in the axes of the rest.
    pub turns: Vec<DQuat>,
}

/// Bones that hang together in a tree.
#[derive(Debug, Clone)]
pub struct JointedTool {
    bones: Vec<Bone>,
    /// Indices of the bones, parents first.
    order: Vec<usize>,
    /// Half the shortest extent of each bone.
    radii: Vec<f64>,
    /// How far each bone's support reaches beyond its surface, the bulges at joints included.
    supports: Vec<f64>,
    profile: Profile,
    /// Width of the smooth minimum of the scaled distances.
    crease: f64,
    /// The widest blend of two bones.
    widest: f64,
    /// Bones farther than this change nothing.
    influence: f64,
    /// No scaled distance grows faster than this.
    steepness: f64,
}

impl JointedTool {
    /// A tool of `bones`.
    ///
    /// # Errors
    /// [`JointedToolError`]: bones that do not form one tree, profiles that differ, a sampled distance that ends too early.
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
        Ok(Self { bones, order, radii, supports, profile, crease, widest, influence, steepness })
    }

    /// How far the distances of all bones must be known for a jointed tool of bones with these bounds of their shapes, in
    /// tool coordinates, and supports.
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

    /// The fields between neighboring `keys`, in each of which the whole moves along a screw and every bone turns about its
    /// joint at a constant rate, by less than half a turn.
    ///
    /// # Errors
    /// [`JointedToolError`]: fewer than two keys, a posture of another number of bones, a bone or the whole turned by exactly
    /// half a turn between two keys.
    pub fn motions(self: &Arc<Self>, keys: &[Posture]) -> Result<Vec<Arc<dyn MovingField>>, JointedToolError> {
        if keys.len() < 2 {
            return Err(JointedToolError::TooFewKeys(keys.len()));
        }
        if let Some(key) = keys.iter().position(|key| key.turns.len() != self.bones.len()) {
            return Err(JointedToolError::Turns { key, turns: keys[key].turns.len(), bones: self.bones.len() });
        }
        let ways = keys.windows(2).enumerate();
        ways.map(|(key, way)| Ok(Arc::new(PostureChange::new(self, &way[0], &way[1], key)?) as _)).collect()
    }

    /// How bones `a` and `b` blend.
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

/// The bones in an order in which each follows its parent.
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

/// Why bones and postures make no field.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum JointedToolError {
    /// Every bone has a parent, or there is no bone.
    #[error("no bone is without a parent, so that nothing carries the others")]
    NoFirstBone,
    /// Two bones without a parent.
    #[error("bones {first} and {bone} both lack a parent; only one bone can carry all others")]
    TwoFirstBones {
        /// The first of them, from 0.
        first: usize,
        /// The second.
        bone: usize,
    },
    /// The parent of a bone does not exist.
    #[error("the parent of bone {bone} does not exist")]
    NoParent {
        /// Which bone, from 0.
        bone: usize,
    },
    /// Following the parents of a bone leads round in a circle.
    #[error("following the parents of bone {bone} leads round in a circle")]
    Circle {
        /// Which bone, from 0.
        bone: usize,
    },
    /// The profile of a bone is not that of the first bone.
    #[error("the profile of bone {bone} differs from that of the bone that carries all others")]
    Profile {
        /// Which bone, from 0.
        bone: usize,
    },
    /// A coordinate of a bone is infinite or not a number.
    #[error("the place and the joint of bone {bone} must be finite")]
    NotFinite {
        /// Which bone, from 0.
        bone: usize,
    },
    /// The sampled distance of a bone ends where other bones still blend with it.
    #[error("the distance of bone {bone} is sampled up to {reach} beyond its surface; {least} is needed")]
    Reach {
        /// Which bone, from 0.
        bone: usize,
        /// Reach needed, model units.
        least: f64,
        /// Reach there is.
        reach: f64,
    },
    /// A motion needs two postures at least.
    #[error("the motion needs at least two postures, not {0}")]
    TooFewKeys(usize),
    /// A posture turns another number of bones than there are.
    #[error("posture {key} has {turns} turns for {bones} bones")]
    Turns {
        /// Index of the posture, from 0.
        key: usize,
        /// Turns it has.
        turns: usize,
        /// Bones there are.
        bones: usize,
    },
    /// A bone, or the whole, turned by exactly half a turn.
    #[error(
        "between postures {key} and {} the turn of {} is exactly 180°, so that the way is open; put a posture between them",
        .key + 1, .bone.map_or("the whole".to_owned(), |bone| format!("bone {bone}"))
    )]
    HalfTurn {
        /// Index of the first of the two, from 0.
        key: usize,
        /// Which bone, from 0; none for the whole.
        bone: Option<usize>,
    },
}
