//! Region fields: everything inside a region moves rigidly, nothing outside a larger one moves at all.
//!
//! ```text
//! V = ∇p × ∇q,   p = g α,  q = g β,   g = g((r(x) − rᵢ)/(rₒ − rᵢ))
//! ```
//!
//! with α = u·x and β = w·x for a translation along u × w, and α = a·(x − c) and β = ½|a × (x − c)|² for a rotation about the
//! axis a through c. This product is the curl of g² ½(α ∇β − β ∇α), so a region is a [`Tool`] with the squared profile whose
//! distance is r(x) − rᵢ and whose support is rₒ − rᵢ. The region travels with the motion.
//!
//! Source: W. von Funck, H. Theisel, H.-P. Seidel, *Vector Field Based Shape Deformations*, 2006, with the rotation's β halved,
//! which makes its angular velocity one.

#[cfg(test)]
mod tests;

use std::{f64::consts::TAU, sync::Arc};

use glam::DVec3;
use isochore_mesh::{Aabb, Distance};

use crate::{Move, Pose, Profile, StrokeError, Tool, ToolError, gauge::Gauge, rotation_from_vector};

/// The longest turn between two keys, in radians: less than half a turn, beyond which the way would be another.
const LONGEST_TURN: f64 = TAU / 3.0;

/// An inner region and the layer around it, over which its motion fades.
#[derive(Debug, Clone)]
pub struct Region {
    tool: Tool,
    placement: Pose,
}

/// How a region moves, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RegionMotion {
    /// By this vector.
    Translation(DVec3),
    /// About the line through `origin` along `axis`, of any length.
    Rotation {
        /// A point of the axis.
        origin: DVec3,
        /// Direction of the axis.
        axis: DVec3,
        /// Radians, right-handed.
        angle: f64,
    },
}

impl Region {
    /// What lies inside `inner`, whose coordinates `placement` carries to the world, and a layer of thickness `outer_distance`
    /// around it.
    ///
    /// # Errors
    /// [`ToolError`], also where the `profile` has a kink and hence no square.
    pub fn new(
        inner: Arc<dyn Distance>,
        placement: Pose,
        outer_distance: f64,
        profile: Profile,
    ) -> Result<Self, ToolError> {
        let squared = profile.squared().ok_or(ToolError::NoSquare(profile))?;
        Ok(Self { tool: Tool::new(inner, outer_distance, squared)?, placement })
    }

    /// The stroke in which the region moves.
    ///
    /// A half-space that turns is faster the farther one looks: then the time step is measured by the points of `reference`, a
    /// box in the world that holds what is deformed. Elsewhere it plays no part.
    ///
    /// # Errors
    /// [`StrokeError`]: an axis without direction, a number that is not finite, and what [`Move::new`] refuses.
    pub fn stroke(self, motion: RegionMotion, step: f64, reference: Aabb) -> Result<Move, StrokeError> {
        let Self { tool, placement } = self;
        let tool = if tool.distance().bounds().size().is_finite() {
            tool
        } else {
            let back = placement.rotation.conjugate();
            let corners = reference.corners();
            tool.with_reference(Aabb::of(corners.map(|corner| back * (corner - placement.translation))))
        };
        match motion {
            RegionMotion::Translation(shift) => {
                let end = Pose { translation: placement.translation + shift, ..placement };
                Move::new(Arc::new(tool), vec![placement, end], step)
            }
            RegionMotion::Rotation { origin, axis, angle } => {
                let axis = axis.try_normalize().ok_or(StrokeError::ZeroAxis)?;
                if !(origin.is_finite() && angle.is_finite()) {
                    return Err(StrokeError::NotFinite("the rotation"));
                }
                let back = placement.rotation.conjugate();
                let center = back * (origin - placement.translation);
                let tool = tool.with_gauge(center, Some(Gauge::of_product(back * axis)));
                let parts = (angle.abs() / LONGEST_TURN).ceil().clamp(1.0, MOST_PARTS);
                let key = |part: usize| {
                    let turn = rotation_from_vector(axis * (angle * (part as f64 / parts)));
                    let rotation = (turn * placement.rotation).normalize();
                    Pose { rotation, translation: origin + turn * (placement.translation - origin) }
                };
                Move::new(Arc::new(tool), (0..=parts as usize).map(key).collect(), step)
            }
        }
    }
}

/// Keys of a rotation at most, which are as many turns of 120°. More is a mistake; a turn beyond is refused for its steps.
const MOST_PARTS: f64 = 1e5;
