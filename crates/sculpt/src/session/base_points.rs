//! Positions of vertices on the base: the surface from which the flow starts.

use glam::DVec3;

/// A vertex that the stroke has inserted, or that has moved before the base was made.
#[derive(Debug, Clone, Copy)]
struct BasePoint {
    vertex: u32,
    position: DVec3,
    /// Position on the surface at the beginning of the stroke, if the stroke has inserted the
    /// vertex.
    inserted_at: Option<DVec3>,
}

/// Positions on the base of those vertices that were elsewhere, or did not exist, at the beginning
/// of the stroke.
#[derive(Debug, Clone, Default)]
pub(super) struct BasePoints {
    /// Indices into `points` by vertex. An entry is valid only if `points` confirms it, so that
    /// this need not be cleared.
    slots: Vec<u32>,
    points: Vec<BasePoint>,
}

impl BasePoints {
    /// Removes all vertices.
    pub(super) fn clear(&mut self) {
        self.points.clear();
    }

    /// Adds a vertex that the stroke has inserted: its position on the base, and on the surface at
    /// the beginning of the stroke.
    pub(super) fn insert(&mut self, vertex: u32, position: DVec3, start: DVec3) {
        self.set(BasePoint { vertex, position, inserted_at: Some(start) });
    }

    /// Sets the position of a vertex on the base.
    pub(super) fn rebase(&mut self, vertex: u32, position: DVec3) {
        self.set(BasePoint { vertex, position, inserted_at: self.inserted_at(vertex) });
    }

    /// Position on the surface at the beginning of the stroke of a vertex that the stroke has
    /// inserted. `None` for other vertices.
    pub(super) fn inserted_at(&self, vertex: u32) -> Option<DVec3> {
        self.slot(vertex).and_then(|slot| self.points[slot].inserted_at)
    }

    /// Position of a vertex on the base. `None` if it is the position at the beginning of the
    /// stroke.
    pub(super) fn position(&self, vertex: u32) -> Option<DVec3> {
        self.slot(vertex).map(|slot| self.points[slot].position)
    }

    fn set(&mut self, point: BasePoint) {
        if let Some(slot) = self.slot(point.vertex) {
            self.points[slot] = point;
            return;
        }
        let index = point.vertex as usize;
        if index >= self.slots.len() {
            self.slots.resize(index + 1, 0);
        }
        self.slots[index] = self.points.len() as u32;
        self.points.push(point);
    }

    fn slot(&self, vertex: u32) -> Option<usize> {
        let slot = *self.slots.get(vertex as usize)? as usize;
        self.points.get(slot).is_some_and(|point| point.vertex == vertex).then_some(slot)
    }
}
