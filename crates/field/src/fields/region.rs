//! Region fields: the inside of a region moves rigidly, and the motion fades to zero over a layer
//! around it.
//!
//! ```text
//! V = ∇p × ∇q,   p = g α,  q = g β,   g = g((r(x) − rᵢ)/(rₒ − rᵢ))
//! ```
//!
//! For a translation along u × w, α = u·x and β = w·x. For a rotation about the axis a through c, α
//! = a·(x − c) and β = ½|a × (x − c)|². The product is the curl of g² ½(α ∇β − β ∇α), so a region
//! is a [`Tool`] with the squared profile, the distance r(x) − rᵢ and the support rₒ − rᵢ. The
//! region moves with the motion.
//!
//! Source: W. von Funck, H. Theisel, H.-P. Seidel, *Vector Field Based Shape Deformations*, 2006,
//! with half the β of the rotation, so that its angular velocity is one.

use std::sync::Arc;

use isochore_mesh::Distance;

use crate::fields::{Pose, Profile, Tool, ToolError};

/// An inner region and the layer around it in which its motion fades.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use isochore_field::{Pose, Profile, Region, ToolError};
/// use isochore_mesh::Sphere;
///
/// let ball = Arc::new(Sphere::new(0.4).unwrap());
/// assert!(Region::new(ball.clone(), Pose::IDENTITY, 0.3, Profile::Quintic).is_ok());
///
/// let kinked = Region::new(ball, Pose::IDENTITY, 0.3, Profile::Thesis);
/// assert_eq!(kinked.unwrap_err(), ToolError::NoSquare(Profile::Thesis));
/// ```
#[derive(Debug, Clone)]
pub struct Region {
    pub(crate) tool: Tool,
    pub(crate) placement: Pose,
}

impl Region {
    /// A region with the signed distance `inner`, placed in the world by `placement` (world from
    /// region). Its motion fades over a layer of thickness `outer_distance`, model units.
    ///
    /// # Errors
    /// [`ToolError::NoSquare`] if the profile has a kink and hence no square,
    /// [`ToolError::Support`] if `outer_distance` is not a positive length, [`ToolError::Reach`] if
    /// the distance is not known that far outside, and [`ToolError::Empty`] if the region has no
    /// volume.
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
