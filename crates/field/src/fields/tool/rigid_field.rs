//! Kernel of tool strokes: the divergence-free field of a rigidly moving tool.
//!
//! ```text
//! V = curl(g(d/R) A) = g (v + ω×r) + (g′/R) n × A,   A = ½ v×r + ⅓ (ω×r)×r
//! ```
//!
//! d is the signed distance, n its gradient, R the support and g the profile. v is the velocity of
//! the tool's center, ω its angular velocity and r the position relative to the center.
//!
//! Where g is one, the field is the rigid motion of the tool; beyond the support it is zero. As a
//! curl, it is divergence-free for any shape. The gradient n must be that of the very function that
//! gives d; with any other gradient the field is not a curl.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, equations 12.2 (ω = 0)
//! and 12.3 (v = 0), with the factors −1/(2R²) and −1/(3R²) for which the surface moves at the
//! speed of the tool.

use glam::DVec3;
use isochore_mesh::{DistanceBlock, LANES, PointBlock};
use multiversion::multiversion;

use super::{Tool, gauge::Cubic};
use crate::fields::{BodyTwist, field::curl_of_product, rigid_motion::RigidMotion};

/// The field of a tool that moves with a constant twist, in tool coordinates, in which the field
/// does not change with time.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use glam::DVec3;
/// use isochore_field::{BodyTwist, Profile, RigidField, Tool};
/// use isochore_mesh::Sphere;
///
/// let tool = Tool::new(Arc::new(Sphere::new(0.4).unwrap()), 0.3, Profile::Quintic).unwrap();
/// let field = RigidField::new(&tool, BodyTwist { linear: DVec3::X, angular: DVec3::ZERO });
///
/// assert_eq!(field.velocity(DVec3::ZERO), DVec3::X); // the core moves with the tool
/// assert!(field.velocity(DVec3::Y * 0.5).x < 0.0); // the material beside it flows back
/// assert_eq!(field.velocity(DVec3::Y), DVec3::ZERO); // beyond the support
/// ```
#[derive(Debug, Clone, Copy)]
pub struct RigidField<'a> {
    tool: &'a Tool,
    twist: BodyTwist,
    /// Motion about the tool's center.
    motion: RigidMotion,
    /// Polynomial whose gradient is added to the potential.
    gauge: Option<Cubic>,
}

/// Values of a [`RigidField`] at the points of a block.
#[derive(Debug, Clone, Copy)]
pub struct VelocityBlock {
    /// Velocity relative to the tool, V − (v + ω×y), in tool axes: the rate of change of the tool
    /// coordinates y of a point.
    pub relative: PointBlock,
    /// Signed distance from the tool.
    pub distance: [f64; LANES],
    /// Whether the point is beyond the support, where the field is exactly zero.
    pub is_outside: [bool; LANES],
}

impl VelocityBlock {
    pub(crate) const REST: Self =
        Self { relative: PointBlock::ZERO, distance: [f64::INFINITY; LANES], is_outside: [true; LANES] };
}

impl<'a> RigidField<'a> {
    /// The field of `tool` moving with `twist`, in tool coordinates.
    pub fn new(tool: &'a Tool, twist: BodyTwist) -> Self {
        let center = tool.center();
        let motion = RigidMotion { center, linear: twist.velocity(center), angular: twist.angular };
        Self { tool, twist, motion, gauge: tool.gauge().map(|gauge| gauge.of(&motion)) }
    }

    /// The moving tool.
    pub fn tool(&self) -> &'a Tool {
        self.tool
    }

    /// Evaluates the field at `points`, given in tool coordinates.
    ///
    /// In the rigid core the relative velocity is exactly zero.
    pub fn evaluate_into(&self, points: &PointBlock, out: &mut VelocityBlock) {
        let mut distance = DistanceBlock::FAR;
        self.tool.distance().sample_single_into(points, &mut distance);
        relative_velocity(self.tool, &self.motion, points, &distance, out);
        if let Some(gauge) = &self.gauge {
            let (support, profile) = (self.tool.support(), self.tool.profile());
            let profile = profile.evaluate_block(&distance.value, support);
            for lane in 0..LANES {
                let gradient = profile.slope[lane] / support * distance.gradient.get(lane);
                let added = gradient.cross(gauge.gradient(points.get(lane) - self.motion.center));
                out.relative.set(lane, out.relative.get(lane) + added);
            }
        }
    }

    /// Velocity V at one point, in tool coordinates and tool axes.
    pub fn velocity(&self, point: DVec3) -> DVec3 {
        let mut block = VelocityBlock::REST;
        self.evaluate_into(&PointBlock::splat(point), &mut block);
        if block.is_outside[0] { DVec3::ZERO } else { block.relative.get(0) + self.twist.velocity(point) }
    }
}

/// The field without the added gauge, from the distances at `points`.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
fn relative_velocity(
    tool: &Tool,
    motion: &RigidMotion,
    points: &PointBlock,
    distance: &DistanceBlock,
    out: &mut VelocityBlock,
) {
    let (support, inverse) = (tool.support(), 1.0 / tool.support());
    let profile = tool.profile().evaluate_block(&distance.value, support);
    for lane in 0..LANES {
        let (potential, curl) = motion.potential(points.get(lane));
        let gradient = profile.slope[lane] * inverse * distance.gradient.get(lane);
        // V − (v + ω×r) = (g − 1)(v + ω×r) + (g′/R) n × A
        out.relative.set(lane, curl_of_product(profile.value[lane] - 1.0, gradient, potential, curl));
    }
    out.distance = distance.value;
    for lane in 0..LANES {
        out.is_outside[lane] = profile.value[lane] == 0.0 && profile.slope[lane] == 0.0;
    }
}

#[cfg(test)]
mod tests;
