use super::{EditMesh, NONE, next, previous};

impl EditMesh {
    /// Whether the edge along `half_edge` can be turned to join the two apexes: it has two sides, its ends keep three triangles
    /// or more, and the apexes are not joined yet.
    ///
    /// # Panics
    /// If the half-edge is not there.
    pub fn can_flip(&self, half_edge: u32) -> bool {
        let twin = self.twin(half_edge);
        if twin == NONE {
            return false;
        }
        let [a, b] = [half_edge, twin].map(|side| self.start(side));
        let [c, d] = [half_edge, twin].map(|side| self.start(previous(side)));
        // At the boundary an end that keeps one triangle is sound.
        let keeps_enough = |vertex: u32| {
            let least = if self.is_boundary(vertex) { 1 } else { 3 };
            self.fan(vertex).take(least + 1).count() > least
        };
        c != d && keeps_enough(a) && keeps_enough(b) && !self.neighbors(c).any(|neighbor| neighbor == d)
    }

    /// Turns the edge from a to b, with the apexes c and d, into the edge between c and d: the near triangle abc becomes adc, the
    /// far one bad becomes bcd, so that only one corner of each changes.
    ///
    /// Call [`can_flip`](Self::can_flip) first.
    ///
    /// # Panics
    /// If the half-edge is not there, or has no twin.
    pub fn flip(&mut self, half_edge: u32) {
        let twin = self.twin(half_edge);
        let [a, b] = [half_edge, twin].map(|side| self.start(side));
        let [c, d] = [half_edge, twin].map(|side| self.start(previous(side)));
        let (to_c, to_d) = (next(half_edge), next(twin));
        let (beyond_bc, beyond_ad) = (self.twin(to_c), self.twin(to_d));
        // Near reads a→d, d→c, c→a in the places of a→b, b→c, c→a, and far b→c, c→d, d→b in those of b→a, a→d, d→b.
        let (side, far_side) = (half_edge as usize % 3, twin as usize % 3);
        self.edit(half_edge / 3, |record| record.vertices[(side + 1) % 3] = d);
        self.edit(twin / 3, |record| record.vertices[(far_side + 1) % 3] = c);
        self.join(half_edge, beyond_ad);
        self.join(twin, beyond_bc);
        self.join(to_c, to_d);
        if self.outgoing(a) == to_d {
            self.leaving.set(a, half_edge);
        }
        if self.outgoing(b) == to_c {
            self.leaving.set(b, twin);
        }
        // Half-edges that leave c and d are where they were: c→a and d→b.
    }
}
