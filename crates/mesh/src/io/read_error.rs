//! What may be wrong with a mesh file.

use std::path::PathBuf;

use crate::MeshError;

/// Why a mesh file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The extension is none of a known format.
    #[error("{}: unknown mesh format; known are .obj .gltf .glb .ply .stl .off", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file is missing or cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file does not hold what its format demands.
    #[error("{}: {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// What is wrong in it.
        source: Box<ParseError>,
    },
}

/// What is wrong with the contents of a mesh file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParseError {
    /// There is nothing to deform.
    #[error("the file has no triangles")]
    Empty,
    /// A line of a text format.
    #[error("line {line}: {problem}")]
    Line {
        /// The line, counted from one.
        line: usize,
        /// What is wrong with it.
        problem: LineProblem,
    },
    /// The mesh that the file describes.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// An attribute that is infinite or not a number.
    #[error("a {attribute} of {element} {number} is not finite")]
    NonFinite {
        /// The attribute.
        attribute: &'static str,
        /// What it belongs to: a triangle or a vertex.
        element: &'static str,
        /// Its number, counted from zero.
        number: usize,
    },
    /// A face of a format without lines.
    #[error("face {face} names vertex {index}, but the file has {vertices} vertices")]
    IndexOutOfRange {
        /// The face, counted from zero.
        face: usize,
        /// The vertex, counted from zero.
        index: i64,
        /// Number of vertices.
        vertices: usize,
    },
    /// A file that this one refers to.
    #[error("{uri}: {problem}")]
    Reference {
        /// The reference, shortened where it is long.
        uri: String,
        /// What went wrong with it.
        problem: String,
    },
    /// Anything else that the format forbids or that is not supported.
    #[error("{0}")]
    Malformed(String),
}

/// What is wrong with a line of a text format.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LineProblem {
    /// A word that should be a number.
    #[error("'{0}' is not a finite number")]
    NotANumber(String),
    /// Too few numbers.
    #[error("{expected} numbers expected, {found} found")]
    TooFewNumbers {
        /// How many there should be at least.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A word that should be the corner of a face.
    #[error("'{0}' is not a face corner (v, v/vt, v//vn or v/vt/vn)")]
    NotACorner(String),
    /// A face that is no polygon.
    #[error("a face needs at least three corners, {0} found")]
    TooFewCorners(usize),
    /// A loop of an STL facet that has not three vertices.
    #[error("a facet needs exactly three vertices")]
    NotATriangle,
    /// An index that points nowhere.
    #[error("{kind} {index} is out of range: there are {count}")]
    IndexOutOfRange {
        /// What the index stands for.
        kind: &'static str,
        /// The index as the file gives it.
        index: i64,
        /// How many there are.
        count: usize,
    },
}
