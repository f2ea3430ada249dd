//! Checks of targets.

use super::{
    Check,
    number::{NumberCheck, all_at_least, all_finite, all_positive, positive, require, rotation},
};
use crate::recipe::{
    Target, TargetShape, Transform,
    error::RecipeError,
    problem::{CombinationProblem, NumberProblem},
};

/// Most triangles of a generated shape. Each takes some hundred bytes in later stages: a much
/// larger limit exhausts the memory of an ordinary machine; a smaller one refuses shapes that it
/// can deform.
const MAX_SHAPE_TRIANGLES: u64 = 20_000_000;

impl Target {
    /// Checks everything that can be checked without the mesh. Keys of errors are relative to the
    /// target.
    pub(crate) fn validate(&self) -> Check {
        match (&self.mesh, &self.shape) {
            (Some(_), Some(_)) => return Err(RecipeError::new("", CombinationProblem::MeshAndShape)),
            (None, None) => return Err(RecipeError::new("", CombinationProblem::NeitherMeshNorShape)),
            (Some(_), None) => {}
            (None, Some(shape)) => self::shape(shape).map_err(|error| error.inside("shape"))?,
        }
        Ok(transform(&self.transform).map_err(|error| error.inside("transform"))?)
    }
}

fn shape(shape: &TargetShape) -> NumberCheck {
    let (triangles, key) = match shape {
        TargetShape::Icosphere(shape) => {
            positive("radius", shape.radius)?;
            (20_u64.saturating_mul(4_u64.saturating_pow(shape.subdivisions)), "subdivisions")
        }
        TargetShape::Box(shape) => {
            all_positive("half_extents", &shape.half_extents)?;
            all_at_least("segments", &shape.segments, &[1, 1, 1])?;
            let [x, y, z] = shape.segments.map(u64::from);
            let cells = x.saturating_mul(y).saturating_add(y.saturating_mul(z)).saturating_add(z.saturating_mul(x));
            (cells.saturating_mul(4), "segments")
        }
        TargetShape::Sphere(shape) => {
            positive("radius", shape.radius)?;
            all_at_least("segments", &shape.segments, &[3, 2])?;
            let [around, across] = shape.segments.map(u64::from);
            (around.saturating_mul(across - 1).saturating_mul(2), "segments")
        }
    };
    let problem = NumberProblem::TooMany { requested: triangles, most: MAX_SHAPE_TRIANGLES, what: "triangles" };
    require(triangles <= MAX_SHAPE_TRIANGLES, key, problem)
}

pub(super) fn transform(transform: &Transform) -> NumberCheck {
    positive("scale", transform.scale)?;
    rotation("rotate", &transform.rotate)?;
    all_finite("translate", &transform.translate)
}
