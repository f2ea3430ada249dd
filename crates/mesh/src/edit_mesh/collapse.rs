use super::{EditMesh, EditTriangle, NONE, next, previous};

/// What a collapse did.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Collapsed {
    /// The vertex that is gone.
    pub removed: u32,
    /// The vertex that took its place in its triangles.
    pub kept: u32,
    /// The two triangles that are gone.
    pub triangles: [u32; 2],
}

impl EditMesh {
    /// Whether the start of `half_edge` can be merged into its end and leave a sound surface: the start is inside the surface,
    /// the link condition holds (H. Edelsbrunner, *Geometry and Topology for Mesh Generation*, 2001, section 4.2), and the apexes
    /// keep three triangles.
    ///
    /// # Panics
    /// If the half-edge is not there.
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
        let mut shared = self.neighbors(removed).filter(|&vertex| self.neighbors(kept).any(|other| other == vertex));
        let is_link_sound = shared.all(|vertex| apexes.contains(&vertex));
        is_link_sound && apexes[0] != apexes[1] && apexes.into_iter().all(keeps_enough)
    }

    /// Merges the start of `half_edge` into its end.
    ///
    /// Call [`can_collapse`](Self::can_collapse) first.
    ///
    /// # Panics
    /// If the half-edge is not there, or has no twin.
    pub fn collapse(&mut self, half_edge: u32) -> Collapsed {
        let twin = self.twin(half_edge);
        let (removed, kept) = (self.start(half_edge), self.end(half_edge));
        let [apex, far_apex] = [half_edge, twin].map(|side| self.start(previous(side)));
        let fan: Vec<u32> = self.fan(removed).collect();
        for leaving in fan {
            self.edit(leaving / 3, |record| record.vertices[leaving as usize % 3] = kept);
        }
        // Outside the two triangles: at the near one from kept to apex and back, at the far one likewise.
        let (apex_to_kept, kept_to_apex) = (self.twin(next(half_edge)), self.twin(previous(half_edge)));
        let (far_apex_to_kept, kept_to_far_apex) = (self.twin(next(twin)), self.twin(previous(twin)));
        self.join(apex_to_kept, kept_to_apex);
        self.join(far_apex_to_kept, kept_to_far_apex);
        let gone = [half_edge / 3, twin / 3];
        let is_gone = |half_edge: u32| half_edge != NONE && gone.contains(&(half_edge / 3));
        if is_gone(self.outgoing(kept)) {
            self.leaving.set(kept, kept_to_apex);
        }
        if is_gone(self.outgoing(apex)) {
            self.leaving.set(apex, apex_to_kept);
        }
        if is_gone(self.outgoing(far_apex)) {
            self.leaving.set(far_apex, far_apex_to_kept);
        }
        self.leaving.set(removed, NONE);
        for triangle in gone {
            self.triangles.set(triangle, EditTriangle::REMOVED);
        }
        self.alive -= 2;
        Collapsed { removed, kept, triangles: gone }
    }
}
