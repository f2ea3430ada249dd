//! The set of edges to split.

use rustc_hash::FxHashMap;

use super::Tessellation;

/// A set of edges to split, in the order of insertion.
#[derive(Debug, Default)]
pub(crate) struct ChosenEdges {
    /// One half-edge along each edge.
    half_edges: Vec<u32>,
    /// Index into `half_edges` for each midpoint.
    indices: FxHashMap<u32, u32>,
    /// Number of triangles that the split adds.
    added: usize,
}

impl ChosenEdges {
    /// Adds the edge of a half-edge, and starts to follow its midpoint.
    pub(crate) fn choose(&mut self, mesh: &mut Tessellation, half_edge: u32) {
        let (midpoint, index) = (mesh.follow(half_edge), self.half_edges.len() as u32);
        if *self.indices.entry(midpoint).or_insert(index) == index {
            self.half_edges.push(half_edge);
            self.added += mesh.edges.around(half_edge).count();
        }
    }

    /// One half-edge along each edge, in the order of insertion.
    pub(crate) fn half_edges(&self) -> &[u32] {
        &self.half_edges
    }

    /// Number of triangles that the split adds.
    pub(crate) fn added(&self) -> usize {
        self.added
    }

    /// Index in the order of insertion of the edge with this midpoint, or `None` if it is not in the set.
    pub(super) fn index_of(&self, midpoint: u32) -> Option<u32> {
        self.indices.get(&midpoint).copied()
    }
}
