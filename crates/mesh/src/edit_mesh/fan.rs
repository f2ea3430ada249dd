use super::{EditMesh, NONE, previous};

/// The outgoing half-edges of a vertex, one per triangle, counter-clockwise seen from outside.
#[derive(Debug, Clone)]
pub struct Fan<'a> {
    mesh: &'a EditMesh,
    first: u32,
    next: u32,
}

impl EditMesh {
    /// The outgoing half-edges of `vertex`, starting with [`outgoing`](Self::outgoing).
    #[inline]
    pub fn fan(&self, vertex: u32) -> Fan<'_> {
        let first = self.outgoing(vertex);
        Fan { mesh: self, first, next: first }
    }

    /// The vertices that an edge connects to `vertex`, in order around it.
    pub fn neighbors(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let fan = self.fan(vertex);
        let last = self.fan(vertex).last().filter(|_| self.is_boundary(vertex));
        // At the boundary the last edge has only an incoming half-edge.
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
        let current = self.next;
        let following = self.mesh.twin(previous(current));
        self.next = if following == self.first { NONE } else { following };
        Some(current)
    }
}
