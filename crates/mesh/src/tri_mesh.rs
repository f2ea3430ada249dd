//! The triangle mesh: shared topology with attributes on corners and vertices.

mod attributes;
mod normals;
mod resampled;
mod skin_table;
mod split;
mod subdivided;
mod transformed;
mod triangle_split;
mod welded;

use glam::DVec3;

pub use attributes::{AttributeError, CornerAttributes, VertexAttributes};
pub use resampled::{Origin, Resampling, VertexOrigin};
pub use skin_table::{SkinError, SkinTable};
pub use split::SplitError;
pub use subdivided::{SubTriangle, Subdivision};
pub use triangle_split::{TriangleSide, TriangleSplit};

use crate::Assets;

/// A triangle mesh. An empty attribute list means that the mesh lacks the attribute.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::TriMesh;
///
/// let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let mesh = TriMesh::new(positions, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
/// assert!(mesh.check().is_closed());
/// assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-15);
/// assert_eq!(mesh.corners(1), [DVec3::ZERO, DVec3::X, DVec3::Z]);
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriMesh {
    /// Position of each vertex, in model units.
    pub positions: Vec<DVec3>,
    /// Vertex indices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Attributes of the corners, which may differ on the two sides of a seam.
    pub corner: CornerAttributes,
    /// Attributes of the vertices.
    pub vertex: VertexAttributes,
    /// Index into `materials` by triangle; empty if the mesh has no materials.
    pub triangle_materials: Vec<u32>,
    /// Names of the materials. Triangles without a material refer to an empty name.
    pub materials: Vec<String>,
    /// Other contents of the mesh file, carried from reading to writing.
    pub assets: Assets,
}

impl TriMesh {
    /// Creates a mesh without attributes.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, ..Self::default() }
    }

    /// Positions of the three corners of `triangle`.
    ///
    /// # Panics
    /// If the index of the triangle or of one of its vertices is out of range.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// The surface with the opposite orientation, attributes included. Shading normals are negated.
    ///
    /// ```
    /// let ball = isochore_mesh::primitives::icosphere(1.0, 1);
    /// assert_eq!(ball.clone().flipped().volume(), -ball.volume());
    /// ```
    pub fn flipped(mut self) -> Self {
        fn reverse<T>(corners: &mut [[T; 3]]) {
            corners.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        reverse(&mut self.triangles);
        self.corner.uvs.iter_mut().for_each(|set| reverse(set));
        reverse(&mut self.corner.normals);
        reverse(&mut self.corner.colors);
        self.corner.normals.iter_mut().flatten().for_each(|normal| *normal = -*normal);
        self
    }
}
