//! The field of a jointed tool at one instant.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, DistanceBlock, LANES, PointBlock};

use super::{
    JointedTool,
    partition::{Share, partition, softened},
    smooth_minimum::{Scalar, smooth_minimum},
};
use crate::{Field, FieldBlock, NO_CORE, Pose, pose::Placement, rigid_field::RigidMotion};

/// All bones where they are, and how they move.
#[derive(Debug, Clone)]
pub(super) struct JointedField {
    pub(super) tool: Arc<JointedTool>,
    pub(super) bones: Vec<PlacedBone>,
    pub(super) bounds: Aabb,
}

/// A bone where it is, in world coordinates.
#[derive(Debug, Clone)]
pub(super) struct PlacedBone {
    /// World from tool.
    pub(super) placement: Placement,
    /// World now from world at rest.
    pub(super) rest: Pose,
    /// In the gauge of the bone's centroid.
    pub(super) motion: RigidMotion,
    /// The motion in parts, from the first bone to this one, each with the change of gauge to the bone's centroid.
    pub(super) recenterings: Vec<Recentering>,
    /// Constant that is added to the changes of gauge.
    pub(super) offset: f64,
    /// Box that holds the support.
    pub(super) support: Aabb,
}

/// A part of a bone's motion whose potential stands in one gauge, and the way to that of the bone's centroid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Recentering {
    part: RigidMotion,
    /// Whether the potential is that of a turn about an axis through the center, −½ ρ² ω with ρ the distance from the axis.
    ///
    /// Turns about the same axis then have the same potential, wherever their joints lie on it: the fingers of a hand that
    /// close together do not shear what is between them.
    is_turn: bool,
    /// From the center of the part to the centroid of the bone.
    shift: DVec3,
}

impl Recentering {
    /// A motion in the gauge of its own center.
    pub(super) fn of_motion(part: RigidMotion, center: DVec3) -> Self {
        Self { part, is_turn: false, shift: center - part.center }
    }

    /// A turn about `joint`, in the gauge of its axis.
    pub(super) fn of_turn(joint: DVec3, angular: DVec3, center: DVec3) -> Self {
        let part = RigidMotion { center: joint, linear: DVec3::ZERO, angular };
        Self { part, is_turn: true, shift: center - joint }
    }

    /// The same part for a bone with another centroid.
    pub(super) fn to(self, center: DVec3) -> Self {
        Self { shift: center - self.part.center, ..self }
    }

    /// The potential of the part.
    fn potential(&self, point: DVec3) -> DVec3 {
        if self.is_turn {
            let squared = self.squared_distance_from_axis(point - self.part.center);
            -0.5 * squared * self.part.angular
        } else {
            self.part.potential(point).0
        }
    }

    /// χ, whose gradient leads from this potential to ½ v×r + ⅓ (ω×r)×r about the bone's centroid.
    ///
    /// From the center o of the part to o + a, with r = x − o and v the velocity of o:
    ///
    /// ```text
    /// χ = −(½ v×a + ⅙ (ω×a)×a)·r − ⅙ (ω×r)·(a×r)
    /// ```
    ///
    /// and before that, from the gauge of the axis to that of the center, ⅙ (ω·r) ρ².
    pub(super) fn value(&self, point: DVec3) -> f64 {
        let RigidMotion { center, linear, angular } = self.part;
        let (r, a) = (point - center, self.shift);
        let slope = 0.5 * linear.cross(a) + angular.cross(a).cross(a) / 6.0;
        let centered = -slope.dot(r) - angular.cross(r).dot(a.cross(r)) / 6.0;
        if self.is_turn { centered + angular.dot(r) * self.squared_distance_from_axis(r) / 6.0 } else { centered }
    }

    fn squared_distance_from_axis(&self, r: DVec3) -> f64 {
        let speed = self.part.angular.length_squared();
        if speed > 0.0 { self.part.angular.cross(r).length_squared() / speed } else { 0.0 }
    }
}

impl PlacedBone {
    /// χᵢ of this bone.
    pub(super) fn gauge(&self, point: DVec3) -> f64 {
        self.recenterings.iter().map(|recentering| recentering.value(point)).sum::<f64>() + self.offset
    }

    /// The potential of the bone's motion in the gauge of the joints that carry it.
    fn joint_potential(&self, point: DVec3) -> DVec3 {
        self.recenterings.iter().map(|recentering| recentering.potential(point)).sum()
    }
}

impl JointedField {
    /// Distances of all bones at `points`, with gradients in world axes; infinite where too far to matter.
    fn distances(&self, points: &PointBlock) -> Vec<DistanceBlock> {
        let influence = self.tool.influence;
        let bones = self.bones.iter().zip(self.tool.bones());
        let sample = |(placed, bone): (&PlacedBone, &super::Bone)| {
            let mut local = PointBlock::ZERO;
            let bounds = bone.tool.distance().bounds();
            let mut is_near = false;
            for lane in 0..LANES {
                let point = placed.placement.to_local(points.get(lane));
                local.set(lane, point);
                is_near |= bounds.distance(point) < influence;
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

    /// u, the smooth minimum of the scaled distances in one lane.
    fn scaled_distance(&self, distances: &[DistanceBlock], lane: usize) -> Scalar {
        let scaled = distances.iter().zip(self.tool.bones()).map(|(distance, bone)| {
            let support = bone.tool.support();
            (distance.value[lane] / support, distance.gradient.get(lane) / support)
        });
        let far = (f64::INFINITY, DVec3::ZERO);
        scaled.fold(far, |union, distance| smooth_minimum(union, distance, self.tool.crease))
    }

    /// Lower bound on the distance from the support to a point beyond it, whose scaled distance is `scaled`.
    fn clearance(&self, scaled: f64, distances: &[DistanceBlock], lane: usize, point: DVec3) -> f64 {
        let near = (scaled - 1.0) / self.tool.steepness;
        // Of bones out of reach only the box is known.
        let far = self.bones.iter().zip(distances).filter(|(_, distance)| distance.value[lane] == f64::INFINITY);
        far.map(|(bone, _)| bone.support.distance(point)).fold(near, f64::min)
    }

    /// The blended potential A at `point`, and its curl.
    fn potential(&self, shares: &[Share], point: DVec3) -> (DVec3, DVec3) {
        if let [share] = shares {
            return self.bones[share.bone].motion.potential(point);
        }
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        for share in shares {
            let bone = &self.bones[share.bone];
            let (potential, curl) = bone.motion.potential(point);
            sum.0 += share.value * potential + bone.gauge(point) * share.gradient;
            sum.1 += share.value * curl + share.gradient.cross(bone.joint_potential(point));
        }
        sum
    }
}

impl Field for JointedField {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        let distances = self.distances(points);
        let mut softened_distances: Vec<Scalar> = Vec::with_capacity(distances.len());
        let mut shares = Vec::with_capacity(distances.len());
        for lane in 0..LANES {
            let point = points.get(lane);
            let (scaled, slope) = self.scaled_distance(&distances, lane);
            if scaled >= 1.0 {
                out.set_outside(lane, self.clearance(scaled, &distances, lane, point));
                continue;
            }
            let (share, steepness) = self.tool.profile.evaluate(scaled);
            let gradient = steepness * slope;
            softened_distances.clear();
            let bones = distances.iter().zip(&self.tool.radii);
            softened_distances.extend(
                bones.map(|(distance, radius)| softened((distance.value[lane], distance.gradient.get(lane)), *radius)),
            );
            partition(&softened_distances, |a, b| self.tool.blend(a, b), self.tool.widest, &mut shares);
            let (potential, curl) = self.potential(&shares, point);
            out.set_product(lane, share, gradient, potential, curl);
            out.clearance[lane] = 0.0;
            out.core[lane] = match shares[..] {
                [alone] if share == 1.0 && gradient == DVec3::ZERO => alone.bone as u32,
                _ => NO_CORE,
            };
        }
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn core_pose(&self, core: u32) -> Pose {
        self.bones[core as usize].rest
    }
}
