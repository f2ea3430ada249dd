//! The topology of a surface that is edited in place by splits, collapses and flips of edges, each
//! in local time.
//!
//! The data structure is a corner table (J. Rossignac, *Edgebreaker*, 1999). Half-edge `3 t + k`
//! runs from vertex `k` of triangle `t` to vertex `k + 1` (modulo three) and stores its twin on the
//! other side. A vertex stores one outgoing half-edge. Removed elements leave free slots. New
//! elements are appended, or reuse slots that were freed before recording began. The slots of the
//! original vertices are never reused.

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

/// An oriented manifold surface, closed or with boundaries, whose edits can be recorded and undone.
///
/// ```
/// use isochore_mesh::{EditMesh, primitives};
///
/// let ball = primitives::icosphere(1.0, 1);
/// let mut mesh = EditMesh::new(&ball.triangles, ball.positions.len())?;
/// let alive = mesh.begin();
/// let split = mesh.split(mesh.outgoing(0));
/// assert_eq!(mesh.neighbors(split.vertex).count(), 4);
/// let mut delta = mesh.finish(alive);
/// assert_eq!(mesh.alive(), 82);
/// mesh.swap(&mut delta);
/// assert_eq!(mesh.alive(), 80);
/// # Ok::<(), isochore_mesh::EditMeshError>(())
/// ```
#[derive(Debug, Clone)]
pub struct EditMesh {
    triangles: Journaled<EditTriangle>,
    /// For each vertex an outgoing half-edge, at the boundary the one without a twin. [`NONE`] for
    /// a vertex without triangles.
    outgoing: Journaled<u32>,
    alive: usize,
    free_triangles: FreeSlots,
    free_vertices: FreeSlots,
}

/// A triangle and the twins of its half-edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EditTriangle {
    /// Counter-clockwise seen from outside. All are [`NONE`] if the triangle is removed.
    pub vertices: [u32; 3],
    /// The half-edges on the other side of edges 01, 12 and 20. [`NONE`] at the boundary.
    pub twins: [u32; 3],
}

impl EditTriangle {
    const REMOVED: Self = Self { vertices: [NONE; 3], twins: [NONE; 3] };

    /// Whether the triangle exists, that is, has not been removed.
    pub fn is_alive(&self) -> bool {
        self.vertices[0] != NONE
    }
}

/// The difference between the states of an [`EditMesh`] before and after recorded edits, for undo
/// and redo.
#[derive(Debug, Clone, PartialEq)]
pub struct EditDelta {
    /// The triangles.
    pub triangles: Delta<EditTriangle>,
    outgoing: Delta<u32>,
    alive: usize,
}

/// Errors when constructing an [`EditMesh`]. Elements are numbered from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EditMeshError {
    /// A triangle uses a vertex twice.
    #[error("triangle {triangle} names vertex {vertex} twice")]
    RepeatedVertex {
        /// The triangle.
        triangle: u32,
        /// The vertex.
        vertex: u32,
    },
    /// An edge has more than two triangles.
    #[error("the edge between vertices {} and {} belongs to {triangles} triangles", edge[0], edge[1])]
    NonManifoldEdge {
        /// The edge.
        edge: [u32; 2],
        /// Number of its triangles.
        triangles: usize,
    },
    /// Two neighboring triangles have opposite orientations.
    #[error("triangles {} and {} traverse the edge between vertices {} and {} in the same direction", triangles[0], triangles[1], edge[0], edge[1])]
    Misoriented {
        /// The edge.
        edge: [u32; 2],
        /// Its triangles.
        triangles: [u32; 2],
    },
    /// Two sheets touch at a vertex.
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

/// The previous half-edge around the triangle.
#[inline]
pub fn previous(half_edge: u32) -> u32 {
    if half_edge.is_multiple_of(3) { half_edge + 2 } else { half_edge - 1 }
}

impl EditMesh {
    /// The surface of `triangles` over `vertices` vertices.
    ///
    /// # Errors
    /// [`EditMeshError`] if it is not an oriented manifold surface. The error names the first
    /// faulty triangle, edge or vertex.
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
        let mut outgoing = vec![NONE; vertices];
        let mut corners = vec![0_u32; vertices];
        for (index, record) in records.iter().enumerate() {
            for side in 0..3 {
                let vertex = record.vertices[side] as usize;
                corners[vertex] += 1;
                if outgoing[vertex] == NONE || record.twins[side] == NONE {
                    outgoing[vertex] = (3 * index + side) as u32;
                }
            }
        }
        let alive = records.len();
        let mesh = Self {
            triangles: Journaled::new(records),
            outgoing: Journaled::new(outgoing),
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

    /// All triangles by index, including removed ones.
    pub fn triangles(&self) -> &[EditTriangle] {
        self.triangles.items()
    }

    /// The array of triangles with its journal.
    pub fn journal(&self) -> &Journaled<EditTriangle> {
        &self.triangles
    }

    /// Number of triangles without removed ones.
    pub fn alive(&self) -> usize {
        self.alive
    }

    /// Number of vertices, including removed ones.
    pub fn vertex_count(&self) -> usize {
        self.outgoing.items().len()
    }

    /// The start vertex of a half-edge.
    #[inline]
    pub fn start(&self, half_edge: u32) -> u32 {
        self.triangles()[half_edge as usize / 3].vertices[half_edge as usize % 3]
    }

    /// The end vertex of a half-edge.
    #[inline]
    pub fn end(&self, half_edge: u32) -> u32 {
        self.start(next(half_edge))
    }

    /// The half-edge on the other side of the edge, or [`NONE`] at the boundary.
    #[inline]
    pub fn twin(&self, half_edge: u32) -> u32 {
        self.triangles()[half_edge as usize / 3].twins[half_edge as usize % 3]
    }

    /// An outgoing half-edge of `vertex`, at the boundary the one without a twin. [`NONE`] for a
    /// vertex without triangles.
    #[inline]
    pub fn outgoing(&self, vertex: u32) -> u32 {
        self.outgoing.items()[vertex as usize]
    }

    /// Whether `vertex` is on the boundary.
    pub fn is_boundary(&self, vertex: u32) -> bool {
        let outgoing = self.outgoing(vertex);
        outgoing != NONE && self.twin(outgoing) == NONE
    }

    /// The half-edge between two vertices, if it exists.
    pub fn half_edge(&self, from: u32, to: u32) -> Option<u32> {
        self.fan(from).find(|&half_edge| self.end(half_edge) == to)
    }

    /// Reserves capacity for additional vertices and triangles.
    pub fn reserve(&mut self, vertices: usize, triangles: usize) {
        self.outgoing.reserve(vertices);
        self.triangles.reserve(triangles);
    }

    /// Begins to record edits, and returns the number of triangles for [`finish`](Self::finish).
    pub fn begin(&mut self) -> usize {
        self.triangles.begin();
        self.outgoing.begin();
        self.alive
    }

    /// Ends recording. `alive` is the result of [`begin`](Self::begin).
    pub fn finish(&mut self, alive: usize) -> EditDelta {
        let delta = EditDelta { triangles: self.triangles.finish(), outgoing: self.outgoing.finish(), alive };
        self.follow(&delta);
        delta
    }

    /// Undoes the edits of `delta`, or redoes them if they are undone; see [`Journaled::swap`].
    ///
    /// # Panics
    /// Possibly, if the delta does not belong to the last edits.
    pub fn swap(&mut self, delta: &mut EditDelta) {
        self.triangles.swap(&mut delta.triangles);
        self.outgoing.swap(&mut delta.outgoing);
        std::mem::swap(&mut self.alive, &mut delta.alive);
        self.follow(delta);
    }

    fn follow(&mut self, delta: &EditDelta) {
        self.free_triangles.follow(&self.triangles, &delta.triangles, |triangle| !triangle.is_alive());
        self.free_vertices.follow(&self.outgoing, &delta.outgoing, |&outgoing| outgoing == NONE);
    }

    fn add_triangle(&mut self, vertices: [u32; 3]) -> u32 {
        let triangle = self.free_triangles.take(self.triangles.items().len());
        self.triangles.put(triangle, EditTriangle { vertices, twins: [NONE; 3] });
        self.alive += 1;
        triangle
    }

    /// Adds a vertex without triangles.
    fn add_vertex(&mut self) -> u32 {
        let vertex = self.free_vertices.take(self.outgoing.items().len());
        self.outgoing.put(vertex, NONE);
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

    /// Makes two half-edges twins. Either may be [`NONE`].
    fn join(&mut self, one: u32, other: u32) {
        self.set_twin(one, other);
        self.set_twin(other, one);
    }
}

impl EditDelta {
    /// Memory use in bytes.
    pub fn bytes(&self) -> usize {
        self.triangles.bytes() + self.outgoing.bytes()
    }

    /// Releases unused memory.
    pub fn shrink(&mut self) {
        self.triangles.shrink();
        self.outgoing.shrink();
    }
}
