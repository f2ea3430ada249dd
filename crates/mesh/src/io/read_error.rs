//! Errors of reading mesh files.

use std::path::PathBuf;

use crate::MeshError;

/// Errors when reading a mesh file.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The extension does not belong to a supported format.
    #[error("{}: unknown mesh format; supported are .obj .gltf .glb .ply .stl .off", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file is missing or cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The contents of the file are invalid.
    #[error("{}: {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// The defect in it.
        source: Box<ParseError>,
    },
}

/// Defects in the contents of a mesh file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParseError {
    /// The file has no triangles.
    #[error("the file has no triangles")]
    Empty,
    /// A line of a text format is invalid.
    #[error("line {line}: {problem}")]
    Line {
        /// The line, counted from one.
        line: usize,
        /// The defect in it.
        problem: LineProblem,
    },
    /// The mesh that the file describes is invalid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A face of a format without lines names a vertex that does not exist.
    #[error("face {face} names vertex {index}, but the file has {vertices} vertices")]
    IndexOutOfRange {
        /// The face, counted from zero.
        face: usize,
        /// The vertex, counted from zero.
        index: i64,
        /// Number of vertices.
        vertices: usize,
    },
    /// A referenced file cannot be read.
    #[error("{uri}: {problem}")]
    Reference {
        /// The reference, truncated if it is long.
        uri: String,
        /// The reason.
        problem: String,
    },
    /// Any other violation of the format, or an unsupported feature.
    #[error("{0}")]
    Malformed(String),
}

/// Defects in a line of a text format.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LineProblem {
    /// A word is not a number.
    #[error("'{0}' is not a finite number")]
    NotANumber(String),
    /// The line has too few numbers.
    #[error("{expected} numbers expected, {found} found")]
    TooFewNumbers {
        /// The smallest valid number of numbers.
        expected: usize,
        /// Numbers found.
        found: usize,
    },
    /// A word is not the corner of a face.
    #[error("'{0}' is not a face corner (v, v/vt, v//vn or v/vt/vn)")]
    NotACorner(String),
    /// The loop of an STL facet does not have three vertices.
    #[error("a facet needs exactly three vertices")]
    NotATriangle,
    /// An index is out of range.
    #[error("{kind} {index} is out of range: there are {count}")]
    IndexOutOfRange {
        /// The kind of element that it refers to.
        kind: &'static str,
        /// The index as written in the file.
        index: i64,
        /// Number of such elements.
        count: usize,
    },
}
