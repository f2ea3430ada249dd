use super::{EditMesh, EditTriangle, NONE, next, previous};

/// Result of the collapse of an edge.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Collapsed {
    /// The removed vertex.
    pub removed: u32,
    /// The vertex that replaces it in its triangles.
    pub kept: u32,
    /// The two removed triangles. The second one is [`NONE`] for an edge of the boundary.
    pub triangles: [u32; 2],
}

impl EditMesh {
    /// Whether merging the start of `half_edge` into its end leaves a manifold surface: the start
    /// is not on the boundary, unless the edge is; the link condition holds (H. Edelsbrunner,
    /// *Geometry and Topology for Mesh Generation*, 2001, section 4.2); the apexes keep at least
    /// three triangles, or one at the boundary; and a triangle with two edges on the boundary has a
    /// neighbor.
    ///
    /// # Panics
    /// If the half-edge does not exist.
    pub fn can_collapse(&self, half_edge: u32) -> bool {
        let twin = self.twin(half_edge);
        let (removed, kept) = (self.start(half_edge), self.end(half_edge));
        if self.is_boundary(removed) != (twin == NONE) {
            return false;
        }
        let is_island = twin == NONE && [next(half_edge), previous(half_edge)].map(|side| self.twin(side)) == [NONE; 2];
        if is_island {
            return false;
        }
        let apexes = [half_edge, if twin == NONE { half_edge } else { twin }].map(|side| self.start(previous(side)));
        let keeps_enough = |vertex: u32| {
            let least = if self.is_boundary(vertex) { 1 } else { 3 };
            self.fan(vertex).take(least + 1).count() > least
        };
        let mut common = self.neighbors(removed).filter(|&vertex| self.neighbors(kept).any(|other| other == vertex));
        let link_condition = common.all(|vertex| apexes.contains(&vertex));
        link_condition && (twin == NONE || apexes[0] != apexes[1]) && apexes.into_iter().all(keeps_enough)
    }

    /// Merges the start of `half_edge` into its end.
    ///
    /// Call [`can_collapse`](Self::can_collapse) first.
    ///
    /// # Panics
    /// If the half-edge does not exist.
    pub fn collapse(&mut self, half_edge: u32) -> Collapsed {
        let twin = self.twin(half_edge);
        let (removed, kept) = (self.start(half_edge), self.end(half_edge));
        let removed_triangles = [half_edge / 3, if twin == NONE { NONE } else { twin / 3 }];
        let is_removed = |half_edge: u32| half_edge != NONE && removed_triangles.contains(&(half_edge / 3));
        let fan: Vec<u32> = self.fan(removed).collect();
        for outgoing in fan {
            self.edit(outgoing / 3, |record| record.vertices[outgoing as usize % 3] = kept);
        }
        for side in [half_edge, twin].into_iter().filter(|&side| side != NONE) {
            // The outer half-edges of the removed triangle become twins of each other.
            let apex = self.start(previous(side));
            let (apex_to_kept, kept_to_apex) = (self.twin(next(side)), self.twin(previous(side)));
            self.join(apex_to_kept, kept_to_apex);
            if is_removed(self.outgoing(kept)) && !is_removed(kept_to_apex) {
                self.outgoing.set(kept, kept_to_apex);
            }
            if is_removed(self.outgoing(apex)) {
                self.outgoing.set(apex, apex_to_kept);
            }
        }
        self.outgoing.set(removed, NONE);
        for triangle in removed_triangles.into_iter().filter(|&triangle| triangle != NONE) {
            self.triangles.set(triangle, EditTriangle::REMOVED);
            self.alive -= 1;
        }
        Collapsed { removed, kept, triangles: removed_triangles }
    }
}
