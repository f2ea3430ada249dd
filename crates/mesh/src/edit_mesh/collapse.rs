use super::{EditMesh, EditTriangle, NONE, next, previous};

/// Result of the collapse of an edge.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Collapsed {
    /// The removed vertex.
    pub removed: u32,
    /// The vertex that replaces it in its triangles.
    pub kept: u32,
    /// The two removed triangles.
    pub triangles: [u32; 2],
}

impl EditMesh {
    /// Whether merging the start of `half_edge` into its end leaves a manifold surface: the start
    /// is not on the boundary, the link condition holds (H. Edelsbrunner, *Geometry and Topology
    /// for Mesh Generation*, 2001, section 4.2), and the apexes keep at least three triangles, or
    /// one at the boundary.
    ///
    /// # Panics
    /// If the half-edge does not exist.
    pub fn can_collapse(&self, half_edge: u32) -> bool {
        let twin = self.twin(half_edge);
        let (removed, kept) = (self.start(half_edge), self.end(half_edge));
        if twin == NONE || self.is_boundary(removed) {
            return false;
        }
        let apexes = [half_edge, twin].map(|side| self.start(previous(side)));
        let keeps_enough = |vertex: u32| {
            let least = if self.is_boundary(vertex) { 1 } else { 3 };
            self.fan(vertex).take(least + 1).count() > least
        };
        let mut common = self.neighbors(removed).filter(|&vertex| self.neighbors(kept).any(|other| other == vertex));
        let link_condition = common.all(|vertex| apexes.contains(&vertex));
        link_condition && apexes[0] != apexes[1] && apexes.into_iter().all(keeps_enough)
    }

    /// Merges the start of `half_edge` into its end.
    ///
    /// Call [`can_collapse`](Self::can_collapse) first.
    ///
    /// # Panics
    /// If the half-edge does not exist or has no twin.
    pub fn collapse(&mut self, half_edge: u32) -> Collapsed {
        let twin = self.twin(half_edge);
        let (removed, kept) = (self.start(half_edge), self.end(half_edge));
        let [apex, far_apex] = [half_edge, twin].map(|side| self.start(previous(side)));
        let fan: Vec<u32> = self.fan(removed).collect();
        for outgoing in fan {
            self.edit(outgoing / 3, |record| record.vertices[outgoing as usize % 3] = kept);
        }
        // The outer half-edges of the two removed triangles become twins of each other, on each
        // side.
        let (apex_to_kept, kept_to_apex) = (self.twin(next(half_edge)), self.twin(previous(half_edge)));
        let (far_apex_to_kept, kept_to_far_apex) = (self.twin(next(twin)), self.twin(previous(twin)));
        self.join(apex_to_kept, kept_to_apex);
        self.join(far_apex_to_kept, kept_to_far_apex);
        let removed_triangles = [half_edge / 3, twin / 3];
        let is_removed = |half_edge: u32| half_edge != NONE && removed_triangles.contains(&(half_edge / 3));
        if is_removed(self.outgoing(kept)) {
            self.outgoing.set(kept, kept_to_apex);
        }
        if is_removed(self.outgoing(apex)) {
            self.outgoing.set(apex, apex_to_kept);
        }
        if is_removed(self.outgoing(far_apex)) {
            self.outgoing.set(far_apex, far_apex_to_kept);
        }
        self.outgoing.set(removed, NONE);
        for triangle in removed_triangles {
            self.triangles.set(triangle, EditTriangle::REMOVED);
        }
        self.alive -= 2;
        Collapsed { removed, kept, triangles: removed_triangles }
    }
}
