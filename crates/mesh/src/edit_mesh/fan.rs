use super::{EditMesh, NONE, previous};

/// The half-edges that leave a vertex, counter-clockwise seen from outside, one for each triangle at it.
#[derive(Debug, Clone)]
pub struct Fan<'a> {
    mesh: &'a EditMesh,
    first: u32,
    next: u32,
}

impl EditMesh {
    /// The half-edges that leave `vertex`, beginning with [`leaving`](Self::leaving).
    #[inline]
    pub fn fan(&self, vertex: u32) -> Fan<'_> {
        let first = self.outgoing(vertex);
        Fan { mesh: self, first, next: first }
    }

    /// The vertices that `vertex` shares an edge with, in order around it.
    pub fn neighbors(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let fan = self.fan(vertex);
        let last = self.fan(vertex).last().filter(|_| self.is_boundary(vertex));
        // At the boundary the last edge has no half-edge that leaves the vertex.
        fan.map(|half_edge| self.end(half_edge)).chain(last.map(|half_edge| self.start(previous(half_edge))))
    }
}

impl Iterator for Fan<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        if self.next == NONE {
            return None;
        }
        let now = self.next;
        let turned = self.mesh.twin(previous(now));
        self.next = if turned == self.first { NONE } else { turned };
        Some(now)
    }
}
