//! Attributes of vertices and corners.

use glam::{DVec3, DVec4, Vec2, Vec3};

use super::TriMesh;

/// Attributes by corner: one entry per triangle, with three values in the order of its vertices.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CornerAttributes {
    /// Sets of texture coordinates, each with one entry per triangle. They are in single precision,
    /// as in renderers and glTF.
    pub uvs: Vec<Vec<[Vec2; 3]>>,
    /// Shading normals of unit length, in single precision.
    pub normals: Vec<[Vec3; 3]>,
    /// Linear RGBA, 0 to 1.
    pub colors: Vec<[DVec4; 3]>,
}

impl CornerAttributes {
    /// Whether the corners have no attributes.
    pub fn is_empty(&self) -> bool {
        self.uvs.is_empty() && self.normals.is_empty() && self.colors.is_empty()
    }

    /// Sets the shading normals from vectors of any length, three for each triangle.
    ///
    /// # Errors
    /// [`AttributeError::NoDirection`] if a vector is zero or not finite. The normals are then
    /// unchanged.
    ///
    /// ```
    /// use glam::{DVec3, Vec3};
    /// use isochore_mesh::CornerAttributes;
    ///
    /// let mut corner = CornerAttributes::default();
    /// corner.set_normals(&[[DVec3::X, 2.0 * DVec3::Y, 0.1 * DVec3::Z]])?;
    /// assert_eq!(corner.normals, [[Vec3::X, Vec3::Y, Vec3::Z]]);
    /// assert!(corner.set_normals(&[[DVec3::ZERO; 3]]).is_err());
    /// # Ok::<(), isochore_mesh::AttributeError>(())
    /// ```
    pub fn set_normals(&mut self, vectors: &[[DVec3; 3]]) -> Result<(), AttributeError> {
        let unit = |(triangle, corners): (usize, &[DVec3; 3])| match corners.map(DVec3::try_normalize) {
            [Some(a), Some(b), Some(c)] => Ok([a, b, c].map(|normal| normal.as_vec3())),
            _ => Err(AttributeError::NoDirection { triangle }),
        };
        self.normals = vectors.iter().enumerate().map(unit).collect::<Result<_, _>>()?;
        Ok(())
    }
}

/// Errors when setting attributes of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum AttributeError {
    /// A normal is zero or not finite.
    #[error("normals: a normal of triangle {triangle} is zero or not finite")]
    NoDirection {
        /// Index of the triangle.
        triangle: usize,
    },
    /// The number of materials differs from the number of triangles.
    #[error("{found} triangle materials were given for {triangles} triangles")]
    MaterialCount {
        /// Materials given.
        found: usize,
        /// Triangles of the mesh.
        triangles: usize,
    },
    /// A triangle refers to a material that does not exist.
    #[error("material {material} of triangle {triangle} is out of range: there are {count} materials")]
    NoMaterial {
        /// Index of the triangle.
        triangle: usize,
        /// Its material.
        material: u32,
        /// Number of materials.
        count: usize,
    },
}

impl TriMesh {
    /// Sets the names of the materials and the index of the material of each triangle.
    ///
    /// # Errors
    /// [`AttributeError`] if the number of indices differs from the number of triangles, or if an
    /// index is out of range. The materials are then unchanged.
    pub fn set_materials(&mut self, names: Vec<String>, of_triangles: Vec<u32>) -> Result<(), AttributeError> {
        let (found, triangles, count) = (of_triangles.len(), self.triangles.len(), names.len());
        if found != triangles {
            return Err(AttributeError::MaterialCount { found, triangles });
        }
        if let Some(triangle) = of_triangles.iter().position(|&material| material as usize >= count) {
            return Err(AttributeError::NoMaterial { triangle, material: of_triangles[triangle], count });
        }
        (self.materials, self.triangle_materials) = (names, of_triangles);
        Ok(())
    }
}

/// Attributes by vertex.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VertexAttributes {
    /// Linear RGBA, 0 to 1.
    pub colors: Vec<DVec4>,
    /// Skin influences: joint index and weight. The weights of a vertex sum to one.
    pub skin: Vec<Vec<(u32, f64)>>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::icosphere;

    #[test]
    fn set_normals_normalizes_or_refuses() {
        let mut corner = CornerAttributes::default();
        corner.set_normals(&[[DVec3::new(0.0, 3.0, 4.0), DVec3::X, DVec3::NEG_Z * 1e-9]]).unwrap();
        let unit = vec![[Vec3::new(0.0, 0.6, 0.8), Vec3::X, Vec3::NEG_Z]];
        assert_eq!(corner.normals, unit);
        for bad in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
            let refused = corner.set_normals(&[[DVec3::X; 3], [DVec3::X, bad, DVec3::X]]);
            assert_eq!(refused, Err(AttributeError::NoDirection { triangle: 1 }));
        }
        assert_eq!(corner.normals, unit);
    }

    #[test]
    fn set_materials_refuses_missing_materials() {
        let mut mesh = icosphere(1.0, 0);
        let names = || vec!["clay".to_owned(), "glaze".to_owned()];
        let refused = mesh.set_materials(names(), vec![0; 19]);
        assert_eq!(refused, Err(AttributeError::MaterialCount { found: 19, triangles: 20 }));
        let mut of_triangles = vec![1; 20];
        of_triangles[7] = 2;
        let refused = mesh.set_materials(names(), of_triangles.clone());
        assert_eq!(refused, Err(AttributeError::NoMaterial { triangle: 7, material: 2, count: 2 }));
        assert_eq!(mesh, icosphere(1.0, 0));
        of_triangles[7] = 0;
        mesh.set_materials(names(), of_triangles.clone()).unwrap();
        assert_eq!((mesh.materials, mesh.triangle_materials), (names(), of_triangles));
    }
}
