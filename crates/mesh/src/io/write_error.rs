//! Why a mesh file may fail to be written.

use std::path::{Path, PathBuf};

use crate::MeshError;

/// Why a mesh was not written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The extension is none of a known format.
    #[error("{}: unknown mesh format; known are .obj .gltf .glb .ply .stl .off", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The folder is missing, the disk full, or the like.
    #[error("{}: cannot write: {source}", shown(path))]
    Io {
        /// The file; empty where there is none.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The mesh is not one that could be read back.
    #[error("{}: not written: {source}", shown(path))]
    Invalid {
        /// The file; empty where there is none.
        path: PathBuf,
        /// What is wrong with the mesh.
        source: MeshError,
    },
    /// A position is beyond single precision, in a format that has no other.
    #[error("{}: not written: the position of vertex {vertex} is too large for single precision", shown(path))]
    TooLarge {
        /// The file; empty where there is none.
        path: PathBuf,
        /// The vertex, counted from zero.
        vertex: usize,
    },
}

/// The path, or what stands for it where the mesh goes to a writer.
fn shown(path: &Path) -> std::path::Display<'_> {
    if path.as_os_str().is_empty() { Path::new("mesh").display() } else { path.display() }
}
