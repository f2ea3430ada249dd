//! The formats and what they hold.

use std::path::Path;

use crate::TriMesh;

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Wavefront OBJ: doubles in decimal, one UV set, normals, vertex colors, names of materials and their libraries.
    Obj,
    /// glTF 2.0 in JSON with its buffer inside: single precision; UV sets, normals, colors, skin, materials, textures.
    Gltf,
    /// glTF 2.0 in one binary file; holds the same as [`Gltf`](Self::Gltf).
    Glb,
    /// Stanford PLY, written as binary doubles, normals and texture coordinates as floats: one UV set, normals, colors.
    Ply,
    /// STL, written in binary: single precision, positions alone.
    Stl,
    /// OFF: doubles in decimal, positions alone.
    Off,
}

impl Format {
    /// The format that the extension of `path` stands for, in any case.
    pub fn of_path(path: &Path) -> Option<Self> {
        Self::of_extension(path.extension()?.to_str()?)
    }

    /// The format that an extension without its dot stands for, in any case.
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "gltf" => Some(Self::Gltf),
            "glb" => Some(Self::Glb),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "off" => Some(Self::Off),
            _ => None,
        }
    }

    /// True where positions are rounded to single precision on writing.
    pub fn is_single_precision(self) -> bool {
        matches!(self, Self::Gltf | Self::Glb | Self::Stl)
    }

    /// `mesh` with its positions as a file of this format holds them, to measure what is really written.
    pub fn stored(self, mesh: &TriMesh) -> TriMesh {
        let mut mesh = mesh.clone();
        if self.is_single_precision() {
            mesh.positions.iter_mut().for_each(|position| *position = position.as_vec3().as_dvec3());
        }
        mesh
    }
}
