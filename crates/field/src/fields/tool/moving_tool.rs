//! Field of a tool that moves with a constant body twist, in world coordinates.
//!
//! [`Move`](crate::Move) integrates the same field in tool coordinates, where it is constant in
//! time, which is faster. In world coordinates the field can be combined with masks and mirror
//! planes, which are fixed in the world. Formula and source are those of
//! [`RigidField`](crate::RigidField).

use std::sync::Arc;

use glam::{DMat3, DVec3};
use isochore_mesh::{Aabb, DistanceBlock, LANES, PointBlock};

use crate::fields::{
    BodyTwist, Field, FieldBlock, MovingField, NO_CORE, Pose, Tool, WeightedPotential,
    pose::Placement,
    rigid_motion::{RigidGauge, RigidMotion},
    tool::gauge::Cubic,
};

/// A tool that moves along one screw over the time from 0 to 1.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use glam::DVec3;
/// use isochore_field::{BodyTwist, MovingField, MovingTool, Pose, Profile, Tool};
/// use isochore_mesh::Sphere;
///
/// let ball = Tool::new(Arc::new(Sphere::new(0.4).unwrap()), 0.3, Profile::Quintic).unwrap();
/// let twist = BodyTwist { linear: 2.0 * DVec3::X, angular: DVec3::ZERO };
/// let moving = MovingTool::new(Arc::new(ball), Pose::IDENTITY, twist);
///
/// // Halfway, the ball is centered at x = 1.
/// let field = moving.at(0.5);
/// assert_eq!(field.velocity(DVec3::X), 2.0 * DVec3::X);
/// assert_eq!(field.velocity(DVec3::ZERO), DVec3::ZERO);
/// ```
#[derive(Debug, Clone)]
pub struct MovingTool {
    tool: Arc<Tool>,
    start: Pose,
    twist: BodyTwist,
}

impl MovingTool {
    /// The motion of `tool` from the pose `start` (world from tool) with a constant `twist`, in
    /// tool coordinates, for one unit of time.
    pub fn new(tool: Arc<Tool>, start: Pose, twist: BodyTwist) -> Self {
        Self { tool, start, twist }
    }

    /// Motion of the tool's center, in tool coordinates.
    fn motion(&self) -> RigidMotion {
        let center = self.tool.center();
        RigidMotion { center, linear: self.twist.velocity(center), angular: self.twist.angular }
    }

    /// Gauge of the potential at `time`, or `None` if the tool is unbounded.
    pub(crate) fn gauge_at(&self, time: f64) -> Option<RigidGauge> {
        let (pose, motion) = (self.start.moved(&self.twist, time), self.motion());
        let placement = Placement::from(&pose);
        let to_world = |vector: DVec3| placement.turn_to_world(vector);
        let bounds = self.tool.support_bounds();
        let half = 0.5 * bounds.size();
        half.is_finite().then(|| RigidGauge {
            center: pose.transform(motion.center),
            linear: to_world(motion.linear),
            angular: to_world(motion.angular),
            middle: pose.transform(bounds.center()),
            half_axes: DMat3::from_cols(
                to_world(half.x * DVec3::X),
                to_world(half.y * DVec3::Y),
                to_world(half.z * DVec3::Z),
            ),
            support: self.tool.support(),
        })
    }
}

impl MovingField for MovingTool {
    fn at(&self, time: f64) -> Box<dyn Field> {
        let pose = self.start.moved(&self.twist, time);
        let motion = self.motion();
        let support = self.tool.support_bounds();
        let corners = support.corners().map(|corner| pose.transform(corner));
        // An unbounded box stays unbounded; rotating its infinite corners would give NaN.
        let bounds = if support.size().is_finite() { Aabb::of(corners) } else { support };
        let gauge = self.tool.gauge().map(|gauge| gauge.of(&motion));
        Box::new(PlacedTool {
            tool: Arc::clone(&self.tool),
            pose,
            placement: Placement::from(&pose),
            motion,
            gauge,
            bounds,
        })
    }

    fn approach_speed(&self) -> f64 {
        self.twist.top_speed(self.tool.support_bounds())
    }

    fn core_speed(&self) -> f64 {
        self.twist.top_speed(self.tool.reference())
    }

    fn feature_size(&self) -> f64 {
        self.tool.feature_size()
    }
}

/// A tool at one instant, with its motion.
#[derive(Debug, Clone)]
struct PlacedTool {
    tool: Arc<Tool>,
    pose: Pose,
    placement: Placement,
    /// Motion in tool coordinates.
    motion: RigidMotion,
    /// Polynomial whose gradient is added to the potential.
    gauge: Option<Cubic>,
    bounds: Aabb,
}

impl Field for PlacedTool {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        let mut local = PointBlock::ZERO;
        for lane in 0..LANES {
            local.set(lane, self.placement.to_local(points.get(lane)));
        }
        let mut distance = DistanceBlock::FAR;
        self.tool.distance().sample_into(&local, &mut distance);
        let support = self.tool.support();
        let profile = self.tool.profile().evaluate_block(&distance.value, support);
        for lane in 0..LANES {
            let (weight, slope) = (profile.value[lane], profile.slope[lane] / support);
            if distance.value[lane] >= support {
                let beyond = (distance.value[lane] - support) / self.tool.distance().lipschitz();
                // Beyond the samples of a grid the distance is infinite; use the box instead.
                let clearance = if beyond.is_finite() { beyond } else { self.bounds.distance(points.get(lane)) };
                out.set_outside(lane, clearance);
                continue;
            }
            let (mut potential, curl) = self.motion.potential(local.get(lane));
            if let Some(gauge) = &self.gauge {
                potential += gauge.gradient(local.get(lane) - self.motion.center);
            }
            let gradient = slope * distance.gradient.get(lane);
            let to_world = |vector: DVec3| self.placement.turn_to_world(vector);
            let core = if weight == 1.0 && gradient == DVec3::ZERO { 0 } else { NO_CORE };
            let (gradient, potential, curl) = (to_world(gradient), to_world(potential), to_world(curl));
            out.set_inside(lane, WeightedPotential { weight, gradient, potential, curl }, core);
        }
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn core_pose(&self, _core: u32) -> Pose {
        self.pose
    }
}
