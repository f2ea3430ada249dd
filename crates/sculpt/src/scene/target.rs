//! The target placed in the world.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{TriMesh, primitives};

use super::{
    SceneError,
    meshes::{Meshes, transformed},
};
use crate::recipe::{CombinationProblem, InvalidRecipe, RecipeError, Target, TargetShape, Transform};

/// The mesh of `target` in world coordinates.
pub(super) fn build(target: &Target, meshes: &Meshes) -> Result<Arc<TriMesh>, SceneError> {
    let mesh = match (&target.mesh, &target.shape) {
        (Some(name), _) => {
            Arc::clone(meshes.get(name).ok_or_else(|| SceneError::MissingMesh { name: name.to_owned() })?)
        }
        (None, Some(shape)) => Arc::new(shape_mesh(shape)),
        (None, None) => {
            let problem = CombinationProblem::NeitherMeshNorShape;
            return Err(RecipeError::<InvalidRecipe>::new("target", problem).into());
        }
    };
    // Even the identity rounds: a mesh that is not placed must keep the bits of its file.
    Ok(if target.transform == Transform::default() { mesh } else { Arc::new(transformed(&mesh, &target.transform)) })
}

/// `points` of the target's file in world coordinates.
pub(crate) fn place(target: &Target, points: Vec<DVec3>) -> Vec<DVec3> {
    if target.transform == Transform::default() {
        return points;
    }
    transformed(&TriMesh::new(points, Vec::new()), &target.transform).positions
}

fn shape_mesh(shape: &TargetShape) -> TriMesh {
    match shape {
        TargetShape::Icosphere(shape) => primitives::icosphere(shape.radius, shape.subdivisions),
        TargetShape::Box(shape) => {
            primitives::box_mesh(DVec3::from_array(shape.half_extents), shape.segments.map(|count| count as usize))
        }
        TargetShape::Sphere(shape) => {
            let [longitude, latitude] = shape.segments.map(|count| count as usize);
            primitives::latitude_longitude_sphere(shape.radius, longitude, latitude)
        }
    }
}
