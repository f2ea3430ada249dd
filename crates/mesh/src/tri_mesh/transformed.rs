//! Similarity transforms.

use glam::{DQuat, DVec3};

use crate::TriMesh;

impl TriMesh {
    /// This mesh scaled about the origin, then rotated, then translated. Shading normals are rotated.
    ///
    /// `scale` is meant to be positive; a negative one turns the triangles over so that outside stays outside.
    pub fn transformed(&self, scale: f64, rotation: DQuat, translation: DVec3) -> TriMesh {
        let mut mesh = self.clone();
        for position in &mut mesh.positions {
            *position = rotation * (*position * scale) + translation;
        }
        for normal in mesh.corner.normals.iter_mut().flatten() {
            *normal = (rotation * normal.as_dvec3()).as_vec3();
        }
        // A point reflection negates normals as well as winding, which is what turning over does to both.
        if scale < 0.0 { mesh.flipped() } else { mesh }
    }
}
