//! The crossings of the input mesh.

use std::sync::OnceLock;

use isochore_mesh::{Cancelled, Monitor, SelfIntersectionError, SelfIntersections, TriMesh};
use rustc_hash::FxHashSet;

/// The input mesh, and the pairs of its triangles that cross. The pairs are found when they are
/// first needed: for most meshes never.
#[derive(Debug)]
pub(in crate::deform) struct Input<'a> {
    mesh: &'a TriMesh,
    pairs: OnceLock<FxHashSet<[u32; 2]>>,
}

impl<'a> Input<'a> {
    pub(in crate::deform) fn new(mesh: &'a TriMesh) -> Self {
        Self { mesh, pairs: OnceLock::new() }
    }

    /// Number of vertices.
    pub(in crate::deform) fn vertices(&self) -> usize {
        self.mesh.positions.len()
    }

    /// The pairs of input triangles that cross, the smaller index first.
    pub(super) fn pairs(&self, monitor: &dyn Monitor) -> Result<&FxHashSet<[u32; 2]>, Cancelled> {
        if let Some(pairs) = self.pairs.get() {
            return Ok(pairs);
        }
        let found = match SelfIntersections::of(self.mesh, monitor) {
            Ok(found) => found,
            Err(SelfIntersectionError::Cancelled(cancelled)) => return Err(cancelled),
            // A mesh that cannot be searched has no triangles.
            Err(_) => SelfIntersections::default(),
        };
        Ok(self.pairs.get_or_init(|| found.pairs().iter().copied().collect()))
    }
}
