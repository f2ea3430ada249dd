//! Proof that a mesh encloses a volume.

use std::ops::Deref;

use glam::DVec3;

use crate::check::start;
use crate::{Topology, TriMesh};

/// A mesh that was found closed: indices in range, positions finite, every edge between exactly two triangles that run
/// along it in opposite directions.
///
/// It may still touch or intersect itself, hold triangles of no area, or be turned inside out; the sign of its
/// [`volume`](TriMesh::volume) tells the last.
#[derive(Debug, Clone, Copy)]
pub struct ClosedMesh<'a> {
    mesh: &'a TriMesh,
}

impl<'a> ClosedMesh<'a> {
    /// Checks `mesh`.
    ///
    /// # Errors
    /// The first defect found, by element.
    pub fn new(mesh: &'a TriMesh) -> Result<Self, MeshError> {
        Self::check_elements(mesh)?;
        Self::check_edges(mesh, &Topology::of(mesh))
    }

    /// Checks `mesh`, whose edges are known already.
    ///
    /// # Errors
    /// The first defect found, by element.
    ///
    /// # Panics
    /// May panic if the topology is that of another mesh.
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

    /// The mesh itself, for as long as it was borrowed.
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
    /// Checks that indices are in range and positions finite.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] or [`MeshError::NonFinite`] for the first triangle or vertex where they are not.
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

/// Why a mesh does not enclose a volume. Elements are numbered from zero.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There is no triangle.
    #[error("the mesh has no triangles")]
    Empty,
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {index}, but the mesh has {vertices} vertices")]
    IndexOutOfRange {
        /// The triangle.
        triangle: u32,
        /// The index that is too large.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} is at {position}, which is not a finite position")]
    NonFinite {
        /// The vertex.
        vertex: u32,
        /// Where it is said to be.
        position: DVec3,
    },
    /// A triangle names a vertex twice.
    #[error("triangle {triangle} names vertex {vertex} twice")]
    RepeatedVertex {
        /// The triangle.
        triangle: u32,
        /// The vertex.
        vertex: u32,
    },
    /// The surface has a boundary.
    #[error("the mesh is open: the edge between vertices {} and {} belongs to triangle {triangle} alone", edge[0], edge[1])]
    Open {
        /// An edge of the boundary.
        edge: [u32; 2],
        /// Its only triangle.
        triangle: u32,
    },
    /// More than two triangles meet in an edge.
    #[error("the edge between vertices {} and {} belongs to {triangles} triangles, not two", edge[0], edge[1])]
    NonManifoldEdge {
        /// The edge.
        edge: [u32; 2],
        /// Number of its triangles.
        triangles: usize,
    },
    /// Neighbors disagree on which side is outside.
    #[error(
        "triangles {} and {} run along the edge between vertices {} and {} in the same direction: one of them is turned over",
        triangles[0], triangles[1], edge[0], edge[1]
    )]
    Misoriented {
        /// The edge.
        edge: [u32; 2],
        /// Its two triangles.
        triangles: [u32; 2],
    },
}
