//! Vertices that the stroke under way has inserted, and where all vertices lay when it began.

use glam::DVec3;

use super::surface::Surface;

/// A vertex that the stroke under way has inserted.
#[derive(Debug, Clone, Copy)]
struct Inserted {
    vertex: u32,
    /// Where it lies on the surface as it stood when the stroke began.
    base: DVec3,
    /// How many times what had moved was halved for it.
    halvings: u8,
}

/// The vertices that the stroke under way has inserted.
#[derive(Debug, Clone, Default)]
pub(super) struct InsertedVertices {
    /// Vertices before this one are those of the mesh as opened.
    first: u32,
    /// By vertex from the first on, where in `vertices` it may be; right only if these agree, so it is never cleared.
    slots: Vec<u32>,
    vertices: Vec<Inserted>,
}

impl InsertedVertices {
    /// None yet, on a mesh that was opened with `count` vertices.
    pub(super) fn new(count: usize) -> Self {
        Self { first: count as u32, ..Self::default() }
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
    }

    /// Takes a vertex in that lies at `base` on the surface as it stood when the stroke began, for which what had moved was halved
    /// `halvings` times.
    pub(super) fn push(&mut self, vertex: u32, base: DVec3, halvings: u8) {
        let index = (vertex - self.first) as usize;
        if index >= self.slots.len() {
            self.slots.resize(index + 1, 0);
        }
        self.slots[index] = self.vertices.len() as u32;
        self.vertices.push(Inserted { vertex, base, halvings });
    }

    /// Whether a vertex is one of these.
    pub(super) fn contains(&self, vertex: u32) -> bool {
        self.get(vertex).is_some()
    }

    fn get(&self, vertex: u32) -> Option<&Inserted> {
        let index = vertex.checked_sub(self.first)?;
        let slot = *self.slots.get(index as usize)?;
        self.vertices.get(slot as usize).filter(|inserted| inserted.vertex == vertex)
    }
}

impl Surface {
    /// Where a vertex lies on the surface as it stood when the stroke began.
    pub(super) fn base(&self, vertex: u32) -> DVec3 {
        match self.inserted.get(vertex) {
            Some(inserted) => inserted.base,
            None => self.positions.original(vertex).unwrap_or_else(|| self.position(vertex)),
        }
    }

    /// How many times the stroke has halved what it had moved to insert a vertex.
    pub(super) fn halvings(&self, vertex: u32) -> u8 {
        self.inserted.get(vertex).map_or(0, |inserted| inserted.halvings)
    }
}
