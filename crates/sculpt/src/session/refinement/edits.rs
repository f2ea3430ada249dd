//! Sum of what refinement passes did.

use std::ops::AddAssign;

/// Edits of the surface by one or more passes.
#[derive(Debug, Default)]
pub(in crate::session) struct Edits {
    /// Edited triangles in the order of the edits; a triangle may occur more than once.
    pub(in crate::session) triangles: Vec<u32>,
    /// Volume that each inserted vertex adds, in the order of the splits.
    pub(in crate::session) split_volumes: Vec<f64>,
    /// Volume that each collapse and flip adds, in their order.
    pub(in crate::session) remeshing_volumes: Vec<f64>,
    pub(in crate::session) removed_vertices: usize,
    pub(in crate::session) flipped_edges: usize,
    /// Whether the limit on triangles prevented splits.
    pub(in crate::session) is_limited: bool,
    /// Edges too long to keep, which a split would not help; the maximum over all passes.
    pub(in crate::session) refused_splits: usize,
    /// Evaluations of the field for inserted vertices.
    pub(in crate::session) evaluations: u64,
}

impl AddAssign for Edits {
    fn add_assign(&mut self, other: Self) {
        self.triangles.extend(other.triangles);
        self.split_volumes.extend(other.split_volumes);
        self.remeshing_volumes.extend(other.remeshing_volumes);
        self.removed_vertices += other.removed_vertices;
        self.flipped_edges += other.flipped_edges;
        self.is_limited |= other.is_limited;
        self.refused_splits = self.refused_splits.max(other.refused_splits);
        self.evaluations += other.evaluations;
    }
}
