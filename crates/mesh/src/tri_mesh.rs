//! The triangle mesh: shared topology, attributes on corners.

use glam::{DVec2, DVec3, DVec4};

/// A triangle mesh. Empty attribute lists mean that the mesh has no such attribute.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriMesh {
    /// One position a vertex, model units.
    pub positions: Vec<DVec3>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Attributes of the triangles' corners, which may differ on the two sides of a seam.
    pub corner: CornerAttributes,
    /// Attributes of the vertices.
    pub vertex: VertexAttributes,
}

/// Attributes by corner: one entry a triangle, three values in the order of its vertices.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CornerAttributes {
    /// Sets of texture coordinates, each as long as the triangles.
    pub uvs: Vec<Vec<[DVec2; 3]>>,
    /// Shading normals, unit length.
    pub normals: Vec<[DVec3; 3]>,
    /// Linear RGBA, 0 to 1.
    pub colors: Vec<[DVec4; 3]>,
}

/// Attributes by vertex.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VertexAttributes {
    /// Linear RGBA, 0 to 1.
    pub colors: Vec<DVec4>,
    /// Skin influences, joint index and weight; the weights of a vertex sum to one.
    pub skin: Vec<Vec<(u32, f64)>>,
}

/// A finer tessellation of a mesh: its triangles, each inside one triangle of the original.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Subdivision {
    /// Positions of all vertices; those of the original come first, unchanged.
    pub positions: Vec<DVec3>,
    /// The triangles.
    pub triangles: Vec<SubTriangle>,
}

/// One triangle of a [`Subdivision`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubTriangle {
    /// Indices into the positions of the subdivision.
    pub vertices: [u32; 3],
    /// The original triangle that holds this one.
    pub parent: u32,
    /// Barycentric coordinates of the three corners in the parent.
    pub corners: [DVec3; 3],
}
