use super::{EditMesh, next, previous};

/// Result of the split of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Split {
    /// The new vertex.
    pub vertex: u32,
    /// The triangle of the split half-edge, which keeps its start, and the new triangle at its end.
    pub near: [u32; 2],
    /// The corresponding triangles of the twin: the first one also keeps the start of the
    /// half-edge. `None` at the boundary.
    pub far: Option<[u32; 2]>,
}

impl EditMesh {
    /// Splits the edge of `half_edge` and the triangles on both sides.
    ///
    /// The corners of the new triangles are `[new, end, apex]` (near) and `[end, new, apex]` (far).
    ///
    /// # Panics
    /// If the half-edge does not exist.
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
        self.outgoing.set(vertex, 3 * added);
        if self.outgoing(end) == next(half_edge) {
            self.outgoing.set(end, 3 * added + 1);
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
            self.outgoing.set(end, 3 * far_added);
        }
        if self.outgoing(far_apex) == across {
            self.outgoing.set(far_apex, 3 * far_added + 2);
        }
        Split { vertex, near: [near, added], far: Some([far, far_added]) }
    }
}
