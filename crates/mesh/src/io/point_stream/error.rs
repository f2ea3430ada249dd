//! Errors of streaming points.

use std::io;
use std::path::{Path, PathBuf};

use crate::io::ParseError;

/// Errors when reading or writing points.
#[derive(Debug, thiserror::Error)]
pub enum PointStreamError {
    /// The extension does not belong to a format that can be streamed.
    #[error("{}: points can be streamed only from .ply and .npy files", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file is missing or cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The header is invalid, or announces data that cannot be streamed.
    #[error("{}: {source}", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// The defect of the header.
        source: Box<ParseError>,
    },
    /// The file has fewer points than its header announces.
    #[error("{}: the file is truncated: {announced} points announced, but it ends at {end}", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Number of points that the header announces.
        announced: u64,
        /// The byte or line, counted from zero, at which the file ends.
        end: String,
    },
    /// A point is invalid.
    #[error("{}: point {point} {location}: {problem}", path.display())]
    Point {
        /// The file.
        path: PathBuf,
        /// The point, counted from zero.
        point: u64,
        /// The byte or line at which it begins.
        location: String,
        /// The defect of the point.
        problem: String,
    },
    /// A point exceeds the range of the number type of the file.
    #[error("{}: point {point} moved beyond the range of the number type of the file", path.display())]
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
    /// The input file, or `None` for an error of the output.
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
