//! Attributes of a remeshed surface, interpolated once from the original mesh, corner by corner.

use glam::{DVec3, DVec4, Vec2};

use super::subdivided::{interpolate, interpolate_influences, interpolate_normal, interpolate_uv};
use crate::{CornerAttributes, TriMesh, VertexAttributes};

/// The source of a vertex or corner: a point in a triangle of another mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    /// The triangle.
    pub triangle: u32,
    /// Barycentric coordinates in the triangle.
    pub weights: DVec3,
}

/// A surface whose vertices and corners are points of a mesh, but whose triangles may cross its
/// edges.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Resampling {
    /// Position of each vertex.
    pub positions: Vec<DVec3>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle, the triangle of the mesh whose material it gets.
    pub parents: Vec<u32>,
    /// For each triangle, the sources of its corner attributes.
    pub corners: Vec<[Origin; 3]>,
    /// For each vertex, the source of its attributes.
    pub vertices: Vec<VertexOrigin>,
}

/// The source of the attributes of a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VertexOrigin {
    /// A point of a triangle.
    Point(Origin),
    /// A vertex, with or without triangles.
    Vertex(u32),
}

impl TriMesh {
    /// The surface `resampling` with the attributes of this mesh.
    ///
    /// Values at corners of this mesh keep their bits. Interpolated shading normals and skin
    /// weights are normalized, and no vertex gets more influences than the maximum of this mesh.
    ///
    /// # Panics
    /// If the resampling refers to a triangle that this mesh does not have, or if its lists differ
    /// in length.
    pub fn resampled(&self, resampling: &Resampling) -> TriMesh {
        let corners = &resampling.corners;
        TriMesh {
            positions: resampling.positions.clone(),
            triangles: resampling.triangles.clone(),
            corner: CornerAttributes {
                uvs: self.corner.uvs.iter().map(|set| resample(set, corners, interpolate_uv)).collect(),
                normals: resample(&self.corner.normals, corners, interpolate_normal),
                colors: resample(&self.corner.colors, corners, interpolate),
            },
            vertex: self.resampled_vertices(resampling),
            triangle_materials: if self.triangle_materials.is_empty() {
                Vec::new()
            } else {
                resampling.parents.iter().map(|&parent| self.triangle_materials[parent as usize]).collect()
            },
            materials: self.materials.clone(),
            assets: self.assets.clone(),
        }
    }

    /// The point of this mesh at `origin`.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn point_at(&self, origin: &Origin) -> DVec3 {
        interpolate(&self.corners(origin.triangle as usize), origin.weights)
    }

    /// The texture coordinates of one set at `origin`.
    ///
    /// # Panics
    /// If the mesh has no such triangle or set.
    pub fn uv_at(&self, set: usize, origin: &Origin) -> Vec2 {
        interpolate_uv(&self.corner.uvs[set][origin.triangle as usize], origin.weights)
    }

    /// The color at `origin`, from the colors of the corners or else of the vertices. `None` if the
    /// mesh has neither.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn color_at(&self, origin: &Origin) -> Option<DVec4> {
        let triangle = origin.triangle as usize;
        if !self.corner.colors.is_empty() {
            return Some(interpolate(&self.corner.colors[triangle], origin.weights));
        }
        let colors = &self.vertex.colors;
        let at = || interpolate(&self.triangles[triangle].map(|vertex| colors[vertex as usize]), origin.weights);
        (!colors.is_empty()).then(at)
    }

    fn resampled_vertices(&self, resampling: &Resampling) -> VertexAttributes {
        let VertexAttributes { colors, skin } = &self.vertex;
        let most = skin.iter().map(Vec::len).max().unwrap_or(0);
        let corners = |origin: &Origin| self.triangles[origin.triangle as usize].map(|vertex| vertex as usize);
        let color = |origin: &VertexOrigin| match origin {
            VertexOrigin::Vertex(vertex) => colors[*vertex as usize],
            VertexOrigin::Point(origin) => interpolate(&corners(origin).map(|vertex| colors[vertex]), origin.weights),
        };
        let influences = |origin: &VertexOrigin| match origin {
            VertexOrigin::Vertex(vertex) => skin[*vertex as usize].clone(),
            VertexOrigin::Point(origin) => match origin.weights.to_array().iter().position(|&weight| weight == 1.0) {
                Some(kept) => skin[corners(origin)[kept]].clone(),
                None => interpolate_influences(corners(origin).map(|v| skin[v].as_slice()), origin.weights, most),
            },
        };
        let origins = &resampling.vertices;
        VertexAttributes {
            colors: if colors.is_empty() { Vec::new() } else { origins.iter().map(color).collect() },
            skin: if skin.is_empty() { Vec::new() } else { origins.iter().map(influences).collect() },
        }
    }
}

/// Values at `corners`, interpolated in the source triangles. Empty if `values` is empty.
fn resample<T>(values: &[[T; 3]], corners: &[[Origin; 3]], interpolate: impl Fn(&[T; 3], DVec3) -> T) -> Vec<[T; 3]> {
    if values.is_empty() {
        return Vec::new();
    }
    let at = |origin: Origin| interpolate(&values[origin.triangle as usize], origin.weights);
    corners.iter().map(|corners| corners.map(at)).collect()
}
