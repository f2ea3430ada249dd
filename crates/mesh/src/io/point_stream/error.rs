//! What may go wrong while points are streamed.

use std::io;
use std::path::{Path, PathBuf};

use crate::io::ParseError;

/// Why points could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum PointStreamError {
    /// The extension is none of a format that is read chunk by chunk.
    #[error("{}: points are streamed from .ply and .npy alone", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file is missing or cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The header is broken, or announces what cannot be streamed.
    #[error("{}: {source}", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<ParseError>,
    },
    /// There are fewer points than announced.
    #[error("{}: the file is truncated: {announced} points announced, but it ends at {place}", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Number of points that the header announces.
        announced: u64,
        /// The byte or line, counted from zero, at which there should be more.
        place: String,
    },
    /// A point that is none.
    #[error("{}: point {point} {place}: {problem}", path.display())]
    Point {
        /// The file.
        path: PathBuf,
        /// The point, counted from zero.
        point: u64,
        /// The byte or line at which it begins.
        place: String,
        /// What is wrong with it.
        problem: String,
    },
    /// A point left the range of the type that the file has for it.
    #[error("{}: point {point} is moved beyond what the type of the file's numbers holds", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The point, counted from zero.
        point: u64,
    },
    /// The result cannot be written.
    #[error("cannot write: {0}")]
    Write(#[source] io::Error),
}

impl PointStreamError {
    /// The file that was read, where the error is about it.
    pub fn path(&self) -> Option<&PathBuf> {
        match self {
            Self::UnknownFormat { path }
            | Self::Read { path, .. }
            | Self::Header { path, .. }
            | Self::Truncated { path, .. }
            | Self::Point { path, .. }
            | Self::TooLarge { path, .. } => Some(path),
            Self::Write(_) => None,
        }
    }

    pub(super) fn read(path: &Path, source: io::Error) -> Self {
        Self::Read { path: path.to_owned(), source }
    }

    pub(super) fn header(path: &Path, problem: impl Into<String>) -> Self {
        Self::Header { path: path.to_owned(), source: Box::new(ParseError::Malformed(problem.into())) }
    }
}
