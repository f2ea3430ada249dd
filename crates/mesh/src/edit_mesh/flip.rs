use super::{EditMesh, NONE, next, previous};

impl EditMesh {
    /// Whether the edge of `half_edge` can be flipped to connect the two apexes: it is not on the
    /// boundary, its ends keep at least three triangles, or one at the boundary, and no edge
    /// connects the apexes yet.
    ///
    /// # Panics
    /// If the half-edge does not exist.
    pub fn can_flip(&self, half_edge: u32) -> bool {
        let twin = self.twin(half_edge);
        if twin == NONE {
            return false;
        }
        let [a, b] = [half_edge, twin].map(|side| self.start(side));
        let [c, d] = [half_edge, twin].map(|side| self.start(previous(side)));
        // At the boundary an end needs only one triangle.
        let keeps_enough = |vertex: u32| {
            let least = if self.is_boundary(vertex) { 1 } else { 3 };
            self.fan(vertex).take(least + 1).count() > least
        };
        c != d && keeps_enough(a) && keeps_enough(b) && !self.neighbors(c).any(|neighbor| neighbor == d)
    }

    /// Replaces the edge ab, with apexes c and d, by the edge cd. The near triangle abc becomes
    /// adc, and the far one bad becomes bcd, so only one corner of each changes.
    ///
    /// Call [`can_flip`](Self::can_flip) first.
    ///
    /// # Panics
    /// If the half-edge does not exist or has no twin.
    pub fn flip(&mut self, half_edge: u32) {
        let twin = self.twin(half_edge);
        let [a, b] = [half_edge, twin].map(|side| self.start(side));
        let [c, d] = [half_edge, twin].map(|side| self.start(previous(side)));
        let (to_c, to_d) = (next(half_edge), next(twin));
        let (beyond_bc, beyond_ad) = (self.twin(to_c), self.twin(to_d));
        // Half-edges of the near triangle: a→b, b→c, c→a become a→d, d→c, c→a.
        // Half-edges of the far triangle: b→a, a→d, d→b become b→c, c→d, d→b.
        let (side, far_side) = (half_edge as usize % 3, twin as usize % 3);
        self.edit(half_edge / 3, |record| record.vertices[(side + 1) % 3] = d);
        self.edit(twin / 3, |record| record.vertices[(far_side + 1) % 3] = c);
        self.join(half_edge, beyond_ad);
        self.join(twin, beyond_bc);
        self.join(to_c, to_d);
        if self.outgoing(a) == to_d {
            self.outgoing.set(a, half_edge);
        }
        if self.outgoing(b) == to_c {
            self.outgoing.set(b, twin);
        }
        // The outgoing half-edges c→a and d→b keep their indices.
    }
}
