use super::{EditMesh, next, previous};

/// What the split of an edge made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Split {
    /// The new vertex.
    pub vertex: u32,
    /// Triangle of the half-edge that was split, which keeps its start, and the new triangle with its end.
    pub near: [u32; 2],
    /// The same on the other side: the triangle there keeps the start of the half-edge as well. None at the boundary.
    pub far: Option<[u32; 2]>,
}

impl EditMesh {
    /// Splits the edge along `half_edge`, and with it the triangles on both sides.
    ///
    /// In the new triangles the corner numbers are: near `[new, end, apex]`, far `[end, new, apex]`.
    ///
    /// # Panics
    /// If the half-edge is not there.
    pub fn split(&mut self, half_edge: u32) -> Split {
        let twin = self.twin(half_edge);
        let (near, side) = (half_edge / 3, half_edge as usize % 3);
        let (end, apex) = (self.end(half_edge), self.start(previous(half_edge)));
        let vertex = self.add_vertex();
        let beyond = self.twin(next(half_edge));
        let added = self.add_triangle([vertex, end, apex]);
        self.edit(near, |record| record.vertices[(side + 1) % 3] = vertex);
        self.join(3 * added + 1, beyond);
        self.join(next(half_edge), 3 * added + 2);
        self.leaving.set(vertex, 3 * added);
        if self.outgoing(end) == next(half_edge) {
            self.leaving.set(end, 3 * added + 1);
        }
        if twin == super::NONE {
            return Split { vertex, near: [near, added], far: None };
        }
        let (far, far_side) = (twin / 3, twin as usize % 3);
        let across = previous(twin);
        let (far_apex, beyond) = (self.start(across), self.twin(across));
        let far_added = self.add_triangle([end, vertex, far_apex]);
        self.edit(far, |record| record.vertices[far_side] = vertex);
        self.join(3 * far_added, 3 * added);
        self.join(3 * far_added + 2, beyond);
        self.join(across, 3 * far_added + 1);
        if self.outgoing(end) == twin {
            self.leaving.set(end, 3 * far_added);
        }
        if self.outgoing(far_apex) == across {
            self.leaving.set(far_apex, 3 * far_added + 2);
        }
        Split { vertex, near: [near, added], far: Some([far, far_added]) }
    }
}
