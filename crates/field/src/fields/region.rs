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

use std::sync::Arc;

use isochore_mesh::Distance;

use crate::fields::{Pose, Profile, Tool, ToolError};

/// An inner region and the layer around it, over which its motion fades.
#[derive(Debug, Clone)]
pub struct Region {
    pub(crate) tool: Tool,
    pub(crate) placement: Pose,
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
}
