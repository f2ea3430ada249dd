//! The meshes that a recipe names.

use std::{collections::BTreeMap, sync::Arc};

use glam::DVec3;
use isochore_mesh::TriMesh;

use crate::recipe::{Transform, rotation::quaternion};

/// Loaded meshes by their names in the recipe. The caller and the scene share them.
pub type Meshes = BTreeMap<String, Arc<TriMesh>>;

/// `mesh` scaled, rotated and translated.
pub(super) fn transformed(mesh: &TriMesh, transform: &Transform) -> TriMesh {
    mesh.transformed(transform.scale, quaternion(transform.rotate), DVec3::from_array(transform.translate))
}
