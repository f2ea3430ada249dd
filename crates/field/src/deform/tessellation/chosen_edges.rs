//! Edges that are to be split.

use rustc_hash::FxHashMap;

use super::Tessellation;

/// Edges that are to be split, each once.
#[derive(Debug, Default)]
pub(crate) struct ChosenEdges {
    /// One half-edge along each, in the order in which they were chosen.
    half_edges: Vec<u32>,
    /// By midpoint, the place of its edge in that order.
    places: FxHashMap<u32, u32>,
    /// Triangles that splitting them adds.
    added: usize,
}

impl ChosenEdges {
    /// Chooses the edge of a half-edge, whose midpoint is followed from now on.
    pub(crate) fn choose(&mut self, mesh: &mut Tessellation, half_edge: u32) {
        let (midpoint, place) = (mesh.follow(half_edge), self.half_edges.len() as u32);
        if *self.places.entry(midpoint).or_insert(place) == place {
            self.half_edges.push(half_edge);
            self.added += mesh.edges.around(half_edge).count();
        }
    }

    /// One half-edge along each, in the order in which they were chosen.
    pub(crate) fn half_edges(&self) -> &[u32] {
        &self.half_edges
    }

    /// Triangles that splitting them adds.
    pub(crate) fn added(&self) -> usize {
        self.added
    }

    /// The place in the order of the edge with this midpoint.
    pub(super) fn place(&self, midpoint: u32) -> Option<u32> {
        self.places.get(&midpoint).copied()
    }
}
