//! Vertices that the stroke under way has inserted.

use glam::DVec3;

/// A vertex that the stroke under way has inserted.
#[derive(Debug, Clone, Copy)]
struct Inserted {
    vertex: u32,
    /// Position on the surface at the beginning of the stroke.
    base: DVec3,
    /// How often an edge that had moved was halved to insert it.
    halvings: u8,
}

/// The vertices that the stroke under way has inserted.
#[derive(Debug, Clone, Default)]
pub(super) struct InsertedVertices {
    /// Number of vertices of the mesh as opened.
    first: u32,
    /// Indices into `vertices` by vertex − `first`. An entry is valid only if `vertices` confirms
    /// it, so that this need not be cleared.
    slots: Vec<u32>,
    vertices: Vec<Inserted>,
}

impl InsertedVertices {
    /// The empty set for a mesh that was opened with `count` vertices.
    pub(super) fn new(count: usize) -> Self {
        Self { first: count as u32, ..Self::default() }
    }

    /// Removes all vertices from the set.
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
    }

    /// Adds a vertex. `base` is its position on the surface at the beginning of the stroke, and
    /// `halvings` the number of times that an edge that had moved was halved to insert it.
    pub(super) fn push(&mut self, vertex: u32, base: DVec3, halvings: u8) {
        let index = (vertex - self.first) as usize;
        if index >= self.slots.len() {
            self.slots.resize(index + 1, 0);
        }
        self.slots[index] = self.vertices.len() as u32;
        self.vertices.push(Inserted { vertex, base, halvings });
    }

    /// Whether the stroke has inserted the vertex.
    pub(super) fn contains(&self, vertex: u32) -> bool {
        self.get(vertex).is_some()
    }

    /// Position of an inserted vertex on the surface at the beginning of the stroke.
    pub(super) fn base(&self, vertex: u32) -> Option<DVec3> {
        self.get(vertex).map(|inserted| inserted.base)
    }

    /// How often the stroke has halved an edge that had moved to insert the vertex; zero for other
    /// vertices.
    pub(super) fn halvings(&self, vertex: u32) -> u8 {
        self.get(vertex).map_or(0, |inserted| inserted.halvings)
    }

    fn get(&self, vertex: u32) -> Option<&Inserted> {
        let index = vertex.checked_sub(self.first)?;
        let slot = *self.slots.get(index as usize)?;
        self.vertices.get(slot as usize).filter(|inserted| inserted.vertex == vertex)
    }
}
