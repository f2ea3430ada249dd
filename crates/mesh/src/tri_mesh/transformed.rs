//! Similarity transforms.

use glam::{DQuat, DVec3};

use crate::TriMesh;

impl TriMesh {
    /// The mesh scaled about the origin, then rotated, then translated. Shading normals are
    /// rotated.
    ///
    /// A negative `scale` reverses the triangles, so that the outside stays outside.
    ///
    /// ```
    /// use glam::{DQuat, DVec3};
    ///
    /// let ball = isochore_mesh::primitives::icosphere(1.0, 1);
    /// let moved = ball.transformed(2.0, DQuat::IDENTITY, DVec3::X);
    /// assert!((moved.volume() - 8.0 * ball.volume()).abs() < 1e-13);
    /// ```
    pub fn transformed(&self, scale: f64, rotation: DQuat, translation: DVec3) -> TriMesh {
        let mut mesh = self.clone();
        for position in &mut mesh.positions {
            *position = rotation * (*position * scale) + translation;
        }
        for normal in mesh.corner.normals.iter_mut().flatten() {
            *normal = (rotation * normal.as_dvec3()).as_vec3();
        }
        // A point reflection reverses both winding and normals, as `flipped` does.
        if scale < 0.0 { mesh.flipped() } else { mesh }
    }
}
