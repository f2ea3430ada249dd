//! A mesh that is checked to be closed.

use std::ops::Deref;

use glam::DVec3;

use crate::check::start;
use crate::{Topology, TriMesh};

/// A mesh that is proven to be closed: all indices are in range, all positions are finite, and
/// every edge belongs to exactly two triangles that traverse it in opposite directions.
///
/// It may still touch or intersect itself, contain triangles of zero area, or be inside out, in
/// which case its [`volume`](TriMesh::volume) is negative.
///
/// ```
/// use isochore_mesh::{ClosedMesh, MeshError, primitives};
///
/// let mut mesh = primitives::icosphere(1.0, 0);
/// assert!(ClosedMesh::new(&mesh)?.volume() > 0.0);
/// mesh.triangles.pop();
/// assert!(matches!(ClosedMesh::new(&mesh), Err(MeshError::Open { .. })));
/// # Ok::<(), MeshError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct ClosedMesh<'a> {
    mesh: &'a TriMesh,
}

impl<'a> ClosedMesh<'a> {
    /// Checks that `mesh` is closed.
    ///
    /// # Errors
    /// [`MeshError`] for the first defect found, which names the element.
    pub fn new(mesh: &'a TriMesh) -> Result<Self, MeshError> {
        Self::check_elements(mesh)?;
        Self::check_edges(mesh, &Topology::of(mesh))
    }

    /// Checks that `mesh` is closed, given its topology.
    ///
    /// # Errors
    /// [`MeshError`] for the first defect found, which names the element.
    ///
    /// # Panics
    /// Possibly, if the topology belongs to another mesh.
    pub fn with_topology(mesh: &'a TriMesh, topology: &Topology) -> Result<Self, MeshError> {
        Self::check_elements(mesh)?;
        Self::check_edges(mesh, topology)
    }

    fn check_elements(mesh: &TriMesh) -> Result<(), MeshError> {
        if mesh.triangles.is_empty() { Err(MeshError::Empty) } else { mesh.check_valid() }
    }

    fn check_edges(mesh: &'a TriMesh, topology: &Topology) -> Result<Self, MeshError> {
        for (edge, &ends) in topology.edges.iter().enumerate() {
            match *topology.half_edges(edge) {
                _ if ends[0] == ends[1] => {
                    let triangle = topology.half_edges(edge)[0] / 3;
                    return Err(MeshError::RepeatedVertex { triangle, vertex: ends[0] });
                }
                [half_edge] => return Err(MeshError::Open { edge: ends, triangle: half_edge / 3 }),
                [a, b] if start(&mesh.triangles, a) == start(&mesh.triangles, b) => {
                    return Err(MeshError::Misoriented { edge: ends, triangles: [a / 3, b / 3] });
                }
                [_, _] => {}
                ref around => {
                    return Err(MeshError::NonManifoldEdge { edge: ends, triangles: around.len() });
                }
            }
        }
        Ok(Self { mesh })
    }

    /// The mesh, for the whole lifetime of the borrow.
    pub fn mesh(self) -> &'a TriMesh {
        self.mesh
    }
}

impl Deref for ClosedMesh<'_> {
    type Target = TriMesh;

    fn deref(&self) -> &TriMesh {
        self.mesh
    }
}

impl TriMesh {
    /// Checks that all indices are in range and all positions finite.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] for the first such triangle, else [`MeshError::NonFinite`]
    /// for the first such vertex.
    pub fn check_valid(&self) -> Result<(), MeshError> {
        let vertices = self.positions.len();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&index| index as usize >= vertices) {
                return Err(MeshError::IndexOutOfRange { triangle: triangle as u32, index, vertices });
            }
        }
        match self.positions.iter().position(|position| !position.is_finite()) {
            Some(vertex) => Err(MeshError::NonFinite { vertex: vertex as u32, position: self.positions[vertex] }),
            None => Ok(()),
        }
    }
}

/// Defects because of which a mesh does not enclose a volume. Elements are numbered from zero.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// The mesh has no triangles.
    #[error("the mesh has no triangles")]
    Empty,
    /// A vertex index of a triangle is out of range.
    #[error("triangle {triangle} names vertex {index}, but the mesh has {vertices} vertices")]
    IndexOutOfRange {
        /// The triangle.
        triangle: u32,
        /// The index.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate is infinite or NaN.
    #[error("vertex {vertex} is at {position}, which is not a finite position")]
    NonFinite {
        /// The vertex.
        vertex: u32,
        /// Its position.
        position: DVec3,
    },
    /// A triangle uses a vertex twice.
    #[error("triangle {triangle} names vertex {vertex} twice")]
    RepeatedVertex {
        /// The triangle.
        triangle: u32,
        /// The vertex.
        vertex: u32,
    },
    /// The surface has a boundary.
    #[error("the mesh is open: the edge between vertices {} and {} belongs only to triangle {triangle}", edge[0], edge[1])]
    Open {
        /// An edge of the boundary.
        edge: [u32; 2],
        /// Its only triangle.
        triangle: u32,
    },
    /// An edge has more than two triangles.
    #[error("the edge between vertices {} and {} belongs to {triangles} triangles, not two", edge[0], edge[1])]
    NonManifoldEdge {
        /// The edge.
        edge: [u32; 2],
        /// Number of its triangles.
        triangles: usize,
    },
    /// Two neighboring triangles have opposite orientations.
    #[error(
        "triangles {} and {} traverse the edge between vertices {} and {} in the same direction: one of them is reversed",
        triangles[0], triangles[1], edge[0], edge[1]
    )]
    Misoriented {
        /// The edge.
        edge: [u32; 2],
        /// Its two triangles.
        triangles: [u32; 2],
    },
}
