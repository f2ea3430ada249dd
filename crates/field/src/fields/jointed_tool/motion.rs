//! Motion of a jointed tool from one posture to the next.
//!
//! The root moves along a screw. Bone i has the rotation Qᵢ exp(t ωᵢ) relative to its parent, so
//! its angular velocity ωᵢ is constant in its own axes.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::Aabb;

use super::{
    JointedTool, JointedToolError, Posture,
    field::{JointedField, MotionPart, PlacedBone},
};
use crate::fields::{
    BodyTwist, Field, MovingField, Pose, pose::Placement, rigid_motion::RigidMotion, rotation_from_vector,
};

/// A motion in which the whole tool moves along a screw and every bone rotates about its joint at a
/// constant rate.
#[derive(Debug, Clone)]
pub(super) struct PostureChange {
    tool: Arc<JointedTool>,
    start: Posture,
    root: BodyTwist,
    /// Angular velocity of each bone relative to its parent, in the bone's own axes, radians per
    /// unit of time.
    turns: Vec<DVec3>,
}

impl PostureChange {
    pub(super) fn new(
        tool: &Arc<JointedTool>,
        start: &Posture,
        end: &Posture,
        key: usize,
    ) -> Result<Self, JointedToolError> {
        // If nothing moves, the logarithm of a rotation times its inverse would leave a rounding
        // error that moves points at rest.
        let twist = |start: &Pose, end: &Pose, bone: Option<usize>| {
            let rest = BodyTwist { linear: DVec3::ZERO, angular: DVec3::ZERO };
            if start == end { Ok(rest) } else { start.twist_to(end).ok_or(JointedToolError::HalfTurn { key, bone }) }
        };
        let root = twist(&start.root, &end.root, None)?;
        let turned = |rotation| Pose { rotation, translation: DVec3::ZERO };
        let turns = start.turns.iter().zip(&end.turns).enumerate();
        let turns = turns
            .map(|(bone, (&start, &end))| Ok(twist(&turned(start), &turned(end), Some(bone))?.angular))
            .collect::<Result<_, _>>()?;
        Ok(Self { tool: Arc::clone(tool), start: start.clone(), root, turns })
    }

    /// Current world position from the position at rest, for each bone.
    fn poses(&self, time: f64) -> Vec<Pose> {
        let root = self.start.root.moved(&self.root, time);
        let mut poses = vec![root; self.tool.bones().len()];
        for &index in &self.tool.order {
            let bone = &self.tool.bones()[index];
            let parent = bone.parent.map_or(root, |parent| poses[parent]);
            let turn = (self.start.turns[index] * rotation_from_vector(time * self.turns[index])).normalize();
            let rotation = (parent.rotation * turn).normalize();
            poses[index] = Pose { rotation, translation: parent.transform(bone.joint) - rotation * bone.joint };
        }
        poses
    }

    /// Middle of each bone with all bones that it carries, in current world coordinates: the mean
    /// of the centroids, weighted by the volumes of the boxes.
    fn middles(&self, poses: &[Pose]) -> Vec<DVec3> {
        let bones = self.tool.bones();
        let mut sums: Vec<(DVec3, f64)> = bones
            .iter()
            .zip(poses)
            .map(|(bone, pose)| {
                let weight = bone.tool.distance().bounds().size().element_product();
                (weight * pose.transform(bone.rest.transform(bone.tool.center())), weight)
            })
            .collect();
        for &index in self.tool.order.iter().rev() {
            if let Some(parent) = bones[index].parent {
                let (sum, weight) = sums[index];
                sums[parent].0 += sum;
                sums[parent].1 += weight;
            }
        }
        sums.into_iter().map(|(sum, weight)| sum / weight).collect()
    }

    /// Upper bound, over all times, on the speed of the points of a box of each bone, in its tool
    /// coordinates.
    fn top_speed(&self, bounds: impl Fn(usize) -> Aabb) -> f64 {
        let bones = self.tool.bones();
        let speed = |index: usize| {
            let bone = &bones[index];
            let corners = bounds(index).corners().map(|corner| bone.rest.transform(corner).distance(bone.joint));
            // Successive joints keep their distance, so the length of the chain bounds the distance
            // from each.
            let mut reach = corners.into_iter().fold(0.0, f64::max);
            let mut speed = 0.0;
            let mut ancestor = index;
            loop {
                speed += self.turns[ancestor].length() * reach;
                let Some(parent) = bones[ancestor].parent else { break };
                reach += bones[ancestor].joint.distance(bones[parent].joint);
                ancestor = parent;
            }
            speed + self.root.velocity(bones[ancestor].joint).length() + self.root.angular.length() * reach
        };
        (0..bones.len()).map(speed).fold(0.0, f64::max)
    }
}

impl MovingField for PostureChange {
    fn at(&self, time: f64) -> Box<dyn Field> {
        let bones = self.tool.bones();
        let poses = self.poses(time);
        let root = self.start.root.moved(&self.root, time);
        let angular = root.rotation * self.root.angular;
        // Motion of the whole tool, described about the origin of the world.
        let linear = root.rotation * self.root.linear - angular.cross(root.translation);
        let frame = RigidMotion { center: DVec3::ZERO, linear, angular };

        let middles = self.middles(&poses);
        let mut placed: Vec<Option<PlacedBone>> = vec![None; bones.len()];
        for &index in &self.tool.order {
            let bone = &bones[index];
            let rest = poses[index];
            let parent = bone.parent.and_then(|parent| placed[parent].as_ref());
            let carrier = parent.map_or(frame, |parent| parent.motion);
            let joint = rest.transform(bone.joint);
            let turn = rest.rotation * self.turns[index];
            let motion =
                RigidMotion { center: joint, linear: carrier.velocity(joint), angular: carrier.angular + turn };
            let part = own_part(parent.and_then(|parent| parent.parts.last()), &motion, turn, middles[index]);
            let parts = parent.map_or(&[][..], |parent| &parent.parts).iter().copied().chain([part]).collect();
            let pose = Pose {
                rotation: (rest.rotation * bone.rest.rotation).normalize(),
                translation: rest.transform(bone.rest.translation),
            };
            let support = self.tool.supports[index];
            placed[index] = Some(PlacedBone {
                placement: Placement::from(&pose),
                rest,
                motion,
                parts,
                support: Aabb::of(support.corners().map(|corner| pose.transform(corner))),
            });
        }
        let placed: Vec<PlacedBone> = placed.into_iter().flatten().collect();
        let bounds = placed.iter().fold(Aabb::EMPTY, |bounds, bone| bounds.union(bone.support));
        Box::new(JointedField { tool: Arc::clone(&self.tool), bones: placed, bounds })
    }

    fn approach_speed(&self) -> f64 {
        self.top_speed(|index| self.tool.supports[index])
    }

    fn core_speed(&self) -> f64 {
        self.top_speed(|index| self.tool.bones()[index].tool.distance().bounds())
    }

    fn feature_size(&self) -> f64 {
        self.tool.bones().iter().map(|bone| bone.tool.feature_size()).fold(f64::INFINITY, f64::min)
    }
}

/// The part that a bone's own joint adds to the `motion` of the bone, which is about that joint:
/// the rotation `turn`, in a gauge centered near the `middle` of the bones that the joint carries.
fn own_part(carrier: Option<&MotionPart>, motion: &RigidMotion, turn: DVec3, middle: DVec3) -> MotionPart {
    // The root bone's own rotation is a motion of the whole tool.
    let Some(carrier) = carrier else { return MotionPart { centered: motion.about(middle), joint: None } };
    // Along the axis of the rotation the center is that of the carrier, so that parallel fingers
    // which bend alike have one potential.
    let axis = turn.normalize_or_zero();
    let along = axis.dot(carrier.centered.center - middle) * axis;
    let joint = motion.center;
    let rotation = RigidMotion { center: joint, linear: DVec3::ZERO, angular: turn };
    MotionPart { centered: rotation.about(middle + along), joint: Some(joint) }
}
