//! The triangle mesh: shared topology, attributes on corners.

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
    /// Index into `materials` by triangle; empty where the mesh has no materials.
    pub triangle_materials: Vec<u32>,
    /// Names of the materials. An empty name stands for triangles that have none beside others that do.
    pub materials: Vec<String>,
    /// What the file said beyond geometry, carried from reading to writing.
    pub assets: Assets,
}

impl TriMesh {
    /// A mesh without attributes.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, ..Self::default() }
    }

    /// Positions of the three corners of `triangle`.
    ///
    /// # Panics
    /// If the triangle or one of its vertices does not exist.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// The same surface with every triangle turned over, attributes included; shading normals are negated.
    pub fn flipped(mut self) -> Self {
        fn turn<T>(corners: &mut [[T; 3]]) {
            corners.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        turn(&mut self.triangles);
        self.corner.uvs.iter_mut().for_each(|set| turn(set));
        turn(&mut self.corner.normals);
        turn(&mut self.corner.colors);
        self.corner.normals.iter_mut().flatten().for_each(|normal| *normal = -*normal);
        self
    }
}
