//! Errors of writing mesh files.

use std::path::{Path, PathBuf};

use crate::MeshError;

/// Errors when writing a mesh.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The extension does not belong to a supported format.
    #[error("{}: unknown mesh format; supported are .obj .gltf .glb .ply .stl .off", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The system reports an error, such as a missing folder or a full disk.
    #[error("{}: cannot write: {source}", shown(path))]
    Io {
        /// The file; empty if the mesh goes to a writer.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The mesh is invalid and could not be read back.
    #[error("{}: not written: {source}", shown(path))]
    Invalid {
        /// The file; empty if the mesh goes to a writer.
        path: PathBuf,
        /// The defect of the mesh.
        source: MeshError,
    },
    /// A position exceeds the range of single precision, which is all that the format stores.
    #[error("{}: not written: the position of vertex {vertex} is too large for single precision", shown(path))]
    TooLarge {
        /// The file; empty if the mesh goes to a writer.
        path: PathBuf,
        /// The vertex, counted from zero.
        vertex: usize,
    },
}

/// The path to show, or the word `mesh` if the mesh goes to a writer.
fn shown(path: &Path) -> std::path::Display<'_> {
    if path.as_os_str().is_empty() { Path::new("mesh").display() } else { path.display() }
}
