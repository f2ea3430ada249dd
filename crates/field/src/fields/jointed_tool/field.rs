//! The field of a jointed tool at one instant.
//!
//! The parent module states the formula. Potentials are accumulated per bone: the motion of a bone
//! is the sum of its parts, each the rotation about one joint on the path to the root.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, DistanceBlock, LANES, PointBlock};

use super::{
    JointedTool,
    partition::{BoneWeight, partition, softened},
    smooth_minimum::{Scalar, smooth_minimum},
};
use crate::fields::{Field, FieldBlock, NO_CORE, Pose, WeightedPotential, pose::Placement, rigid_motion::RigidMotion};

/// All bones at one instant, with their motions.
#[derive(Debug, Clone)]
pub(super) struct JointedField {
    pub(super) tool: Arc<JointedTool>,
    pub(super) bones: Vec<PlacedBone>,
    pub(super) bounds: Aabb,
}

/// A bone at one instant, in world coordinates.
#[derive(Debug, Clone)]
pub(super) struct PlacedBone {
    /// World from tool.
    pub(super) placement: Placement,
    /// Current world position from the position at rest.
    pub(super) rest: Pose,
    /// Motion of the bone.
    pub(super) motion: RigidMotion,
    /// The same motion in parts, from that of the whole tool to the rotation about the bone's own
    /// joint.
    pub(super) parts: Vec<MotionPart>,
    /// Box of the support.
    pub(super) support: Aabb,
}

/// A part of the motion, common to all bones that one joint carries, with its vector potential in
/// two gauges.
///
/// Since these bones have both potentials in common, the material between them does not shear.
#[derive(Debug, Clone, Copy)]
pub(super) struct MotionPart {
    /// The motion about a point near the middle of those bones: the gauge with the least return
    /// flow around them.
    pub(super) centered: RigidMotion,
    /// Joint that the bones rotate about; `None` for the motion of the whole tool.
    pub(super) joint: Option<DVec3>,
}

impl MotionPart {
    /// Potential in the gauge of the joint's axis, −½ ρ² ω, with the distance ρ from the axis.
    ///
    /// It vanishes to second order at the joint. Rotations about the same axis have the same
    /// potential, independent of the position of their joints on the axis.
    fn joint_potential(&self, point: DVec3) -> DVec3 {
        match self.joint {
            Some(joint) => -0.5 * self.squared_distance_from_axis(point - joint) * self.centered.angular,
            None => self.centered.potential(point).0,
        }
    }

    /// χ, whose gradient changes the gauge of the joint's axis to the centered gauge.
    ///
    /// From the joint o to the center o + a, with r = x − o:
    ///
    /// ```text
    /// χ = −⅙ ((ω×a)×a)·r − ⅙ (ω×r)·(a×r) + ⅙ (ω·r) ρ²
    /// ```
    ///
    /// The last term changes the gauge of the axis to that of the joint.
    fn gauge(&self, point: DVec3) -> f64 {
        let Some(joint) = self.joint else { return 0.0 };
        let angular = self.centered.angular;
        let (r, a) = (point - joint, self.centered.center - joint);
        (angular.dot(r) * self.squared_distance_from_axis(r)
            - angular.cross(a).cross(a).dot(r)
            - angular.cross(r).dot(a.cross(r)))
            / 6.0
    }

    fn squared_distance_from_axis(&self, r: DVec3) -> f64 {
        let angular = self.centered.angular;
        let speed = angular.length_squared();
        if speed > 0.0 { angular.cross(r).length_squared() / speed } else { 0.0 }
    }
}

impl PlacedBone {
    /// Potential of the bone's motion with all parts centered, and its curl.
    fn potential(&self, point: DVec3) -> (DVec3, DVec3) {
        self.parts.iter().fold((DVec3::ZERO, DVec3::ZERO), |sum, part| {
            let (potential, curl) = part.centered.potential(point);
            (sum.0 + potential, sum.1 + curl)
        })
    }

    /// Potential of the bone's motion in the gauge of the joints that carry it.
    fn joint_potential(&self, point: DVec3) -> DVec3 {
        self.parts.iter().map(|part| part.joint_potential(point)).sum()
    }

    /// χᵢ of this bone.
    fn gauge(&self, point: DVec3) -> f64 {
        self.parts.iter().map(|part| part.gauge(point)).sum()
    }
}

impl JointedField {
    /// Distances of all bones at `points`, with gradients in world axes. The distance of a bone
    /// beyond its influence is infinite.
    fn distances(&self, points: &PointBlock) -> Vec<DistanceBlock> {
        let influence = self.tool.influence;
        let bones = self.bones.iter().zip(self.tool.bones()).zip(&self.tool.influences);
        let sample = |((placed, bone), bounds): ((&PlacedBone, &super::Bone), &Aabb)| {
            let mut local = PointBlock::ZERO;
            let mut is_near = false;
            for lane in 0..LANES {
                let point = placed.placement.to_local(points.get(lane));
                local.set(lane, point);
                is_near |= bounds.distance(point) == 0.0;
            }
            let mut distance = DistanceBlock::FAR;
            if is_near {
                bone.tool.distance().sample_into(&local, &mut distance);
            }
            for lane in 0..LANES {
                if distance.value[lane] < influence {
                    let gradient = placed.placement.turn_to_world(distance.gradient.get(lane));
                    distance.gradient.set(lane, gradient);
                } else {
                    distance.value[lane] = f64::INFINITY;
                    distance.gradient.set(lane, DVec3::ZERO);
                }
            }
            distance
        };
        bones.map(sample).collect()
    }

    /// u, the smooth minimum of the scaled distances, in one lane.
    fn scaled_distance(&self, distances: &[DistanceBlock], lane: usize) -> Scalar {
        let scaled = distances.iter().zip(self.tool.bones()).map(|(distance, bone)| {
            let support = bone.tool.support();
            (distance.value[lane] / support, distance.gradient.get(lane) / support)
        });
        let far = (f64::INFINITY, DVec3::ZERO);
        scaled.fold(far, |union, distance| smooth_minimum(union, distance, self.tool.crease))
    }

    /// Lower bound on the distance of a point beyond the support with the scaled distance `scaled`.
    fn clearance(&self, scaled: f64, distances: &[DistanceBlock], lane: usize, point: DVec3) -> f64 {
        let near = (scaled - 1.0) / self.tool.steepness;
        // For bones beyond their influence only the box is known.
        let far = self.bones.iter().zip(distances).filter(|(_, distance)| distance.value[lane] == f64::INFINITY);
        far.map(|(bone, _)| bone.support.distance(point)).fold(near, f64::min)
    }

    /// Blended potential A at `point`, and its curl.
    fn potential(&self, weights: &[BoneWeight], point: DVec3) -> (DVec3, DVec3) {
        if let [only] = weights {
            return self.bones[only.bone].potential(point);
        }
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        for weight in weights {
            let bone = &self.bones[weight.bone];
            let (potential, curl) = bone.potential(point);
            // wᵢ Aᵢ + χᵢ ∇wᵢ equals wᵢ (Aᵢ − ∇χᵢ) + ∇(wᵢ χᵢ), where Aᵢ − ∇χᵢ is the joint potential.
            sum.0 += weight.value * potential + bone.gauge(point) * weight.gradient;
            sum.1 += weight.value * curl + weight.gradient.cross(bone.joint_potential(point));
        }
        sum
    }
}

impl Field for JointedField {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        let distances = self.distances(points);
        let mut softened_distances: Vec<Scalar> = Vec::with_capacity(distances.len());
        let mut weights = Vec::with_capacity(distances.len());
        for lane in 0..LANES {
            let point = points.get(lane);
            let (scaled, slope) = self.scaled_distance(&distances, lane);
            if scaled >= 1.0 {
                out.set_outside(lane, self.clearance(scaled, &distances, lane, point));
                continue;
            }
            let (weight, steepness) = self.tool.profile.evaluate(scaled);
            let gradient = steepness * slope;
            softened_distances.clear();
            let bones = distances.iter().zip(&self.tool.radii);
            softened_distances.extend(
                bones.map(|(distance, radius)| softened((distance.value[lane], distance.gradient.get(lane)), *radius)),
            );
            partition(&softened_distances, |a, b| self.tool.blend(a, b), self.tool.widest, &mut weights);
            let (potential, curl) = self.potential(&weights, point);
            let core = match weights[..] {
                [only] if weight == 1.0 && gradient == DVec3::ZERO => only.bone as u32,
                _ => NO_CORE,
            };
            out.set_inside(lane, WeightedPotential { weight, gradient, potential, curl }, core);
        }
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn core_pose(&self, core: u32) -> Pose {
        self.bones[core as usize].rest
    }
}
