//! The topology of a surface that is edited in place: splits, collapses and flips of edges, each in local time.
//!
//! A corner table (J. Rossignac, *Edgebreaker*, 1999, calls it so): half-edge `3 t + k` runs from vertex `k` of triangle `t` to
//! vertex `k + 1` (modulo three) and knows its twin on the other side. A vertex knows one half-edge that leaves it. What is removed
//! leaves a hole, and what is new is appended, or takes the place of what was removed before edits began to be recorded. Vertices that
//! there were at first keep their places for good.

mod collapse;
mod fan;
mod flip;
mod split;
#[cfg(test)]
mod tests;

use crate::{Delta, FreeSlots, Journaled, Topology};

pub use collapse::Collapsed;
pub use fan::Fan;
pub use split::Split;

/// No half-edge, or no vertex.
pub const NONE: u32 = u32::MAX;

/// An oriented surface without branches, closed or with boundaries, whose edits can be recorded and undone.
#[derive(Debug, Clone)]
pub struct EditMesh {
    triangles: Journaled<EditTriangle>,
    /// By vertex a half-edge that leaves it: at the boundary the one without a twin. [`NONE`] for a vertex without triangles.
    leaving: Journaled<u32>,
    alive: usize,
    free_triangles: FreeSlots,
    free_vertices: FreeSlots,
}

/// A triangle and what lies beyond its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EditTriangle {
    /// Counter-clockwise seen from outside; all [`NONE`] where the triangle was removed.
    pub vertices: [u32; 3],
    /// The half-edges on the other sides of edges 01, 12 and 20; [`NONE`] at the boundary.
    pub twins: [u32; 3],
}

impl EditTriangle {
    const REMOVED: Self = Self { vertices: [NONE; 3], twins: [NONE; 3] };

    /// Whether the triangle is there.
    pub fn is_alive(&self) -> bool {
        self.vertices[0] != NONE
    }
}

/// The way to the other end of recorded edits of an [`EditMesh`].
#[derive(Debug, Clone, PartialEq)]
pub struct EditDelta {
    /// The triangles.
    pub triangles: Delta<EditTriangle>,
    leaving: Delta<u32>,
    alive: usize,
}

/// Why triangles are no surface that could be edited. Elements are numbered from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EditMeshError {
    /// A triangle names a vertex twice.
    #[error("triangle {triangle} names vertex {vertex} twice")]
    RepeatedVertex {
        /// The triangle.
        triangle: u32,
        /// The vertex.
        vertex: u32,
    },
    /// More than two triangles meet in an edge.
    #[error("the edge between vertices {} and {} belongs to {triangles} triangles", edge[0], edge[1])]
    NonManifoldEdge {
        /// The edge.
        edge: [u32; 2],
        /// Number of its triangles.
        triangles: usize,
    },
    /// Neighbors disagree on which side is outside.
    #[error("triangles {} and {} run along the edge between vertices {} and {} in the same direction", triangles[0], triangles[1], edge[0], edge[1])]
    Misoriented {
        /// The edge.
        edge: [u32; 2],
        /// Its triangles.
        triangles: [u32; 2],
    },
    /// Two sheets touch in a vertex.
    #[error("the triangles at vertex {vertex} form more than one fan")]
    NonManifoldVertex {
        /// The vertex.
        vertex: u32,
    },
}

/// The next half-edge around the triangle.
#[inline]
pub fn next(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 { half_edge - 2 } else { half_edge + 1 }
}

/// The half-edge before, around the triangle.
#[inline]
pub fn previous(half_edge: u32) -> u32 {
    if half_edge.is_multiple_of(3) { half_edge + 2 } else { half_edge - 1 }
}

impl EditMesh {
    /// The surface of `triangles` over `vertices` vertices.
    ///
    /// # Errors
    /// [`EditMeshError`], naming the first edge or vertex where it is no oriented surface.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn new(triangles: &[[u32; 3]], vertices: usize) -> Result<Self, EditMeshError> {
        for (index, triangle) in (0_u32..).zip(triangles) {
            let [a, b, c] = *triangle;
            if a == b || b == c || c == a {
                return Err(EditMeshError::RepeatedVertex { triangle: index, vertex: if a == b { a } else { c } });
            }
        }
        let topology = Topology::of_triangles(triangles, vertices);
        let mut records: Vec<_> =
            triangles.iter().map(|&vertices| EditTriangle { vertices, twins: [NONE; 3] }).collect();
        for (edge, &ends) in topology.edges.iter().enumerate() {
            match *topology.half_edges(edge) {
                [_] => {}
                [a, b] => {
                    let start = |half_edge: u32| triangles[half_edge as usize / 3][half_edge as usize % 3];
                    if start(a) == start(b) {
                        return Err(EditMeshError::Misoriented { edge: ends, triangles: [a / 3, b / 3] });
                    }
                    records[a as usize / 3].twins[a as usize % 3] = b;
                    records[b as usize / 3].twins[b as usize % 3] = a;
                }
                ref around => return Err(EditMeshError::NonManifoldEdge { edge: ends, triangles: around.len() }),
            }
        }
        let mut leaving = vec![NONE; vertices];
        let mut corners = vec![0_u32; vertices];
        for (index, record) in records.iter().enumerate() {
            for side in 0..3 {
                let vertex = record.vertices[side] as usize;
                corners[vertex] += 1;
                if leaving[vertex] == NONE || record.twins[side] == NONE {
                    leaving[vertex] = (3 * index + side) as u32;
                }
            }
        }
        let alive = records.len();
        let mesh = Self {
            triangles: Journaled::new(records),
            leaving: Journaled::new(leaving),
            alive,
            free_triangles: FreeSlots::default(),
            free_vertices: FreeSlots::new(vertices as u32),
        };
        for (vertex, corners) in (0_u32..).zip(corners) {
            if mesh.fan(vertex).count() != corners as usize {
                return Err(EditMeshError::NonManifoldVertex { vertex });
            }
        }
        Ok(mesh)
    }

    /// All triangles by index, removed ones included.
    pub fn triangles(&self) -> &[EditTriangle] {
        self.triangles.items()
    }

    /// The recorded array of triangles.
    pub fn journal(&self) -> &Journaled<EditTriangle> {
        &self.triangles
    }

    /// Number of triangles that are there.
    pub fn alive(&self) -> usize {
        self.alive
    }

    /// Number of vertices, removed ones included.
    pub fn vertex_count(&self) -> usize {
        self.leaving.items().len()
    }

    /// The vertex that a half-edge starts from.
    #[inline]
    pub fn start(&self, half_edge: u32) -> u32 {
        self.triangles()[half_edge as usize / 3].vertices[half_edge as usize % 3]
    }

    /// The vertex that a half-edge runs to.
    #[inline]
    pub fn end(&self, half_edge: u32) -> u32 {
        self.start(next(half_edge))
    }

    /// The half-edge on the other side, or [`NONE`].
    #[inline]
    pub fn twin(&self, half_edge: u32) -> u32 {
        self.triangles()[half_edge as usize / 3].twins[half_edge as usize % 3]
    }

    /// A half-edge that leaves `vertex`, at the boundary the one without a twin; [`NONE`] for a vertex without triangles.
    #[inline]
    pub fn outgoing(&self, vertex: u32) -> u32 {
        self.leaving.items()[vertex as usize]
    }

    /// Whether the surface ends at `vertex`.
    pub fn is_boundary(&self, vertex: u32) -> bool {
        let leaving = self.outgoing(vertex);
        leaving != NONE && self.twin(leaving) == NONE
    }

    /// The half-edge from one vertex to another, if there is one.
    pub fn half_edge(&self, from: u32, to: u32) -> Option<u32> {
        self.fan(from).find(|&half_edge| self.end(half_edge) == to)
    }

    /// Makes room for more vertices and triangles.
    pub fn reserve(&mut self, vertices: usize, triangles: usize) {
        self.leaving.reserve(vertices);
        self.triangles.reserve(triangles);
    }

    /// Begins to record edits.
    pub fn begin(&mut self) -> usize {
        self.triangles.begin();
        self.leaving.begin();
        self.alive
    }

    /// Ends recording; `alive` is what [`begin`](Self::begin) returned.
    pub fn finish(&mut self, alive: usize) -> EditDelta {
        let delta = EditDelta { triangles: self.triangles.finish(), leaving: self.leaving.finish(), alive };
        self.follow(&delta);
        delta
    }

    /// Takes the surface to the other end of `delta`; see [`Journaled::swap`].
    ///
    /// # Panics
    /// If the delta is not that of the last edits.
    pub fn swap(&mut self, delta: &mut EditDelta) {
        self.triangles.swap(&mut delta.triangles);
        self.leaving.swap(&mut delta.leaving);
        std::mem::swap(&mut self.alive, &mut delta.alive);
        self.follow(delta);
    }

    fn follow(&mut self, delta: &EditDelta) {
        self.free_triangles.follow(&self.triangles, &delta.triangles, |triangle| !triangle.is_alive());
        self.free_vertices.follow(&self.leaving, &delta.leaving, |&leaving| leaving == NONE);
    }

    fn add_triangle(&mut self, vertices: [u32; 3]) -> u32 {
        let triangle = self.free_triangles.take(self.triangles.items().len());
        self.triangles.put(triangle, EditTriangle { vertices, twins: [NONE; 3] });
        self.alive += 1;
        triangle
    }

    /// Adds a vertex without triangles.
    fn add_vertex(&mut self) -> u32 {
        let vertex = self.free_vertices.take(self.leaving.items().len());
        self.leaving.put(vertex, NONE);
        vertex
    }

    fn edit(&mut self, triangle: u32, change: impl FnOnce(&mut EditTriangle)) {
        let mut record = self.triangles.get(triangle);
        change(&mut record);
        self.triangles.set(triangle, record);
    }

    fn set_twin(&mut self, half_edge: u32, twin: u32) {
        if half_edge != NONE {
            self.edit(half_edge / 3, |record| record.twins[half_edge as usize % 3] = twin);
        }
    }

    /// Makes two half-edges, either of which may be [`NONE`], the two sides of one edge.
    fn join(&mut self, one: u32, other: u32) {
        self.set_twin(one, other);
        self.set_twin(other, one);
    }
}

impl EditDelta {
    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        self.triangles.bytes() + self.leaving.bytes()
    }

    /// Gives back memory that is not in use.
    pub fn shrink(&mut self) {
        self.triangles.shrink();
        self.leaving.shrink();
    }
}
