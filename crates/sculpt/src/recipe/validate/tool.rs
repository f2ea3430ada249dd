//! Checks of tools.

use super::{
    Check,
    number::{all_positive, at_least, fraction, not_negative, positive, require},
    target::transform,
};
use crate::recipe::{
    MeshTool, Tool, ToolShape,
    error::RecipeError,
    problem::{GeometryProblem, NumberProblem},
};

/// Coarsest distance grid of a tool mesh, in cells along its longest side. With fewer, no cell's
/// spline depends on both the inside and the outside.
const MIN_RESOLUTION: u64 = 4;

/// Finest distance grid of a tool mesh, in cells along its longest side. The samples of a cube take
/// at most 4 GiB without padding; a larger limit needs more memory.
const MAX_RESOLUTION: u64 = 1024;

impl Tool {
    /// Checks everything that can be checked without the mesh. Keys of errors are relative to the
    /// tool.
    pub(crate) fn validate(&self) -> Check {
        shape(&self.shape).map_err(|error| error.inside("shape"))?;
        positive("support", self.support)?;
        Ok(fraction("free_form", self.free_form)?)
    }
}

fn shape(shape: &ToolShape) -> Check {
    match shape {
        ToolShape::Sphere(shape) => positive("radius", shape.radius)?,
        ToolShape::Capsule(shape) => {
            positive("radius", shape.radius)?;
            not_negative("half_length", shape.half_length)?;
        }
        ToolShape::Box(shape) => {
            all_positive("half_extents", &shape.half_extents)?;
            not_negative("rounding", shape.rounding)?;
            let most = shape.half_extents.into_iter().fold(f64::INFINITY, f64::min);
            if shape.rounding > most {
                let problem = GeometryProblem::RoundingTooLarge { found: shape.rounding, most };
                return Err(RecipeError::new("rounding", problem));
            }
        }
        ToolShape::Torus(shape) => {
            positive("major", shape.major)?;
            positive("minor", shape.minor)?;
            if shape.minor >= shape.major {
                return Err(RecipeError::new("minor", GeometryProblem::NoHole(shape.minor)));
            }
        }
        ToolShape::Ellipsoid(shape) => all_positive("radii", &shape.radii)?,
        ToolShape::Host(_) => {}
        ToolShape::Mesh(shape) => mesh(shape)?,
    }
    Ok(())
}

fn mesh(shape: &MeshTool) -> Result<(), RecipeError<NumberProblem>> {
    let resolution = shape.resolution.into();
    at_least("resolution", resolution, MIN_RESOLUTION)?;
    let what = "cells on the longest side";
    let problem = NumberProblem::TooMany { requested: resolution, most: MAX_RESOLUTION, what };
    require(resolution <= MAX_RESOLUTION, "resolution", problem)?;
    transform(&shape.transform).map_err(|error| error.inside("transform"))
}
