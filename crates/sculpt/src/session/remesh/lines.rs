//! Edges that remeshing keeps where they are: seams, hard edges, borders of materials, boundaries,
//! and sharp edges.

use isochore_mesh::{Split, next_half_edge, previous_half_edge};

/// The kept edges of a surface that is edited: for each triangle, a bit for each side.
#[derive(Debug, Clone)]
pub(super) struct Lines(pub(super) Vec<u8>);

impl Lines {
    /// Whether the edge of a half-edge is kept.
    #[inline]
    pub(super) fn is_line(&self, half_edge: u32) -> bool {
        self.0[half_edge as usize / 3] >> (half_edge % 3) & 1 == 1
    }

    pub(super) fn set(&mut self, half_edge: u32, is_line: bool) {
        let bits = &mut self.0[half_edge as usize / 3];
        *bits = *bits & !(1 << (half_edge % 3)) | u8::from(is_line) << (half_edge % 3);
    }

    /// Follows the split of a half-edge with this twin.
    pub(super) fn follow_split(&mut self, split: &Split, half_edge: u32, twin: u32) {
        let added = split.near[1].max(split.far.map_or(0, |far| far[1]));
        if added as usize >= self.0.len() {
            self.0.resize(added as usize + 1, 0);
        }
        let is_line = self.is_line(half_edge);
        let beyond = self.is_line(next_half_edge(half_edge));
        self.0[split.near[1] as usize] = u8::from(is_line) | u8::from(beyond) << 1;
        self.set(next_half_edge(half_edge), false);
        if let Some([_, added]) = split.far {
            let beyond = self.is_line(previous_half_edge(twin));
            self.0[added as usize] = u8::from(is_line) | u8::from(beyond) << 2;
            self.set(previous_half_edge(twin), false);
        }
    }

    /// Follows the flip of a half-edge, which is not a line, with this twin.
    pub(super) fn follow_flip(&mut self, half_edge: u32, twin: u32) {
        let [near, far] = [half_edge, twin].map(|edge| self.is_line(next_half_edge(edge)));
        self.set(half_edge, far);
        self.set(twin, near);
        self.set(next_half_edge(half_edge), false);
        self.set(next_half_edge(twin), false);
    }

    /// Follows the collapse of a half-edge. `outer` are the pairs of half-edges that have become
    /// one edge.
    pub(super) fn follow_collapse(&mut self, outer: &[[(u32, bool); 2]]) {
        for &[(one, is_one), (other, is_other)] in outer {
            for half_edge in [one, other].into_iter().filter(|&half_edge| half_edge != isochore_mesh::NONE) {
                self.set(half_edge, is_one || is_other);
            }
        }
    }
}

/// Freedom of a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Freedom {
    /// It may move along the surface and be removed.
    Free,
    /// It stays, because it is on a line. Its edges are edited.
    OnLine,
    /// It stays, because a mask holds it. Edges between two such vertices are not edited.
    Held,
    /// It stays, and its edges are not edited.
    Frozen,
}
