//! What vertices and corners carry besides positions.

use glam::{DVec4, Vec2, Vec3};

/// Attributes by corner: one entry a triangle, three values in the order of its vertices.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CornerAttributes {
    /// Sets of texture coordinates, each as long as the triangles; in single precision, as renderers and glTF want them.
    pub uvs: Vec<Vec<[Vec2; 3]>>,
    /// Shading normals, unit length; in single precision too.
    pub normals: Vec<[Vec3; 3]>,
    /// Linear RGBA, 0 to 1.
    pub colors: Vec<[DVec4; 3]>,
}

impl CornerAttributes {
    /// True where no corner carries anything.
    pub fn is_empty(&self) -> bool {
        self.uvs.is_empty() && self.normals.is_empty() && self.colors.is_empty()
    }
}

/// Attributes by vertex.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VertexAttributes {
    /// Linear RGBA, 0 to 1.
    pub colors: Vec<DVec4>,
    /// Skin influences, joint index and weight; the weights of a vertex sum to one.
    pub skin: Vec<Vec<(u32, f64)>>,
}
