//! The set of edges to split.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::Tessellation;

/// A point on an edge: `fraction` of the way from the first to the second of `ends`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cut {
    pub(crate) ends: [u32; 2],
    pub(crate) fraction: f64,
}

impl Cut {
    /// The position of the point. At the middle, both orders of the ends give the same bits.
    pub(super) fn position(&self, positions: &[DVec3]) -> DVec3 {
        let [a, b] = self.ends.map(|end| positions[end as usize]);
        if self.fraction == 0.5 { 0.5 * (a + b) } else { a + self.fraction * (b - a) }
    }

    /// The fraction of the way from `first`, one of the ends.
    pub(super) fn fraction_from(&self, first: u32) -> f64 {
        if first == self.ends[0] { self.fraction } else { 1.0 - self.fraction }
    }
}

/// A set of edges to split, in the order of insertion.
#[derive(Debug, Default)]
pub(crate) struct ChosenEdges {
    /// One half-edge along each edge.
    half_edges: Vec<u32>,
    /// Where each edge is split.
    cuts: Vec<Cut>,
    /// Index into `half_edges` for each midpoint.
    indices: FxHashMap<u32, u32>,
    /// Number of triangles that the split adds.
    added: usize,
}

impl ChosenEdges {
    /// Adds the edge of a half-edge, and starts to follow its midpoint.
    pub(crate) fn choose(&mut self, mesh: &mut Tessellation, half_edge: u32) {
        let cut = Cut { ends: mesh.ends(half_edge), fraction: 0.5 };
        self.add(mesh, half_edge, cut);
    }

    /// Adds the edge of a half-edge of a frozen mesh, to be split at `cut`.
    pub(crate) fn choose_at(&mut self, mesh: &mut Tessellation, half_edge: u32, cut: Cut) {
        let midpoint = self.add(mesh, half_edge, cut);
        let position = self.cuts[self.indices[&midpoint] as usize].position(&mesh.base);
        mesh.midpoints.base[midpoint as usize] = position;
    }

    /// Adds an edge, and returns its midpoint.
    fn add(&mut self, mesh: &mut Tessellation, half_edge: u32, cut: Cut) -> u32 {
        let (midpoint, index) = (mesh.follow(half_edge), self.half_edges.len() as u32);
        if *self.indices.entry(midpoint).or_insert(index) == index {
            self.half_edges.push(half_edge);
            self.cuts.push(cut);
            self.added += mesh.edges.around(half_edge).count();
        }
        midpoint
    }

    /// One half-edge along each edge, in the order of insertion.
    pub(crate) fn half_edges(&self) -> &[u32] {
        &self.half_edges
    }

    /// Where each edge is split, in the order of insertion.
    pub(crate) fn cuts(&self) -> &[Cut] {
        &self.cuts
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
