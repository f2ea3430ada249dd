//! The triangles of a frozen tessellation as pieces of the input triangles, to be merged and put back.

use glam::DVec3;
use isochore_mesh::Topology;

use super::{
    Part, Tessellation, WHOLE,
    edge_cycles::EdgeCycles,
    midpoints::{Midpoints, UNFOLLOWED},
};

/// A triangle, and the part of an input triangle that it covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    pub(crate) vertices: [u32; 3],
    /// The input triangle.
    pub(crate) parent: u32,
    /// Barycentric coordinates of the vertices in the input triangle.
    pub(crate) corners: [DVec3; 3],
}

impl Tessellation {
    /// All triangles, in their order.
    pub(crate) fn pieces(&self) -> Vec<Piece> {
        let piece = |index: usize| {
            let Part { parent, corners } = self.part(index);
            Piece { vertices: self.triangles[index], parent, corners }
        };
        (0..self.triangles.len()).map(piece).collect()
    }

    /// Replaces the triangles of a frozen tessellation. The pieces cover all input triangles, and the first
    /// piece of each input triangle has its index. Call [`settle`](Self::settle) before anything but the
    /// triangles and their parents is used.
    pub(crate) fn set_pieces(&mut self, pieces: &[Piece]) {
        self.triangles.clear();
        self.part_of.clear();
        self.parts.clear();
        for (index, piece) in (0..).zip(pieces) {
            self.triangles.push(piece.vertices);
            self.part_of.push(WHOLE);
            if piece.parent != index || piece.corners != DVec3::AXES {
                self.set_part(index as usize, Part { parent: piece.parent, corners: piece.corners });
            }
        }
    }

    /// Removes the vertices behind the first `kept` that no triangle uses, and finds the edges again.
    pub(crate) fn settle(&mut self, kept: usize) {
        let mut is_used = vec![false; self.rest.len()];
        is_used[..kept].fill(true);
        self.triangles.iter().flatten().for_each(|&vertex| is_used[vertex as usize] = true);
        let mut number = vec![0; self.rest.len()];
        let used = (0..self.rest.len()).filter(|&vertex| is_used[vertex]);
        (0..).zip(used).for_each(|(new, vertex)| number[vertex] = new);
        for positions in [&mut self.rest, &mut self.base, &mut self.image] {
            let mut flags = is_used.iter();
            positions.retain(|_| flags.next().copied().unwrap_or(true));
        }
        for triangle in &mut self.triangles {
            *triangle = triangle.map(|vertex| number[vertex as usize]);
        }
        let triangles = self.triangles.len();
        self.origins.clear();
        self.edges = EdgeCycles::new(&Topology::of_triangles(&self.triangles, self.rest.len()));
        self.midpoints = Midpoints::none(vec![UNFOLLOWED; 3 * triangles]);
        self.gains = vec![0.0; triangles];
        self.gain_sums.clear();
        self.shapes.clear();
        self.vertex_bounds.clear();
        self.changed.clear();
        self.unchecked.clear();
    }
}
