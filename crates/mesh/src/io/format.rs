//! The file formats and the attributes that they can store.

use std::path::Path;

use crate::TriMesh;

/// A mesh file format.
///
/// ```
/// use isochore_mesh::io::Format;
///
/// assert_eq!(Format::of_path("bust.GLB".as_ref()), Some(Format::Glb));
/// assert_eq!(Format::of_extension("step"), None);
/// assert!(Format::Glb.is_single_precision() && !Format::Ply.is_single_precision());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Wavefront OBJ: decimal double precision; one UV set, normals, vertex colors, names of
    /// materials and of material libraries.
    Obj,
    /// glTF 2.0 as JSON with an embedded buffer: single precision; UV sets, normals, colors, skin,
    /// materials, textures.
    Gltf,
    /// glTF 2.0 as one binary file, with the same contents as [`Gltf`](Self::Gltf).
    Glb,
    /// Stanford PLY: positions in binary double precision, normals and texture coordinates in
    /// single precision; one UV set, normals, colors.
    Ply,
    /// Binary STL: single precision, positions only.
    Stl,
    /// OFF: decimal double precision, positions only.
    Off,
}

impl Format {
    /// The format of the extension of `path`, in upper or lower case. `None` if it is unknown.
    pub fn of_path(path: &Path) -> Option<Self> {
        Self::of_extension(path.extension()?.to_str()?)
    }

    /// The format of an extension without its dot, in upper or lower case. `None` if it is unknown.
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

    /// The usual name of the format. Both forms of glTF have the same.
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Gltf | Self::Glb => "glTF",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Off => "OFF",
        }
    }

    /// Whether writing rounds positions to single precision.
    pub fn is_single_precision(self) -> bool {
        matches!(self, Self::Gltf | Self::Glb | Self::Stl)
    }

    /// `mesh` with its positions rounded as in a file of this format, so that measures agree with
    /// the written file.
    pub fn stored(self, mesh: &TriMesh) -> TriMesh {
        let mut mesh = mesh.clone();
        if self.is_single_precision() {
            mesh.positions.iter_mut().for_each(|position| *position = position.as_vec3().as_dvec3());
        }
        mesh
    }
}
