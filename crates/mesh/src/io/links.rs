//! Symbolic links at the place of an output.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Largest number of links in a chain, as on Linux.
const MOST_LINKS: usize = 40;

/// The path that writing to `path` must replace: the end of a chain of symbolic links, whether a
/// file exists there or not; `path` itself if it is not a link.
///
/// # Errors
/// The links form a circle, or one cannot be read.
pub fn follow_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..=MOST_LINKS {
        match std::fs::symlink_metadata(&path) {
            Ok(metadata) if metadata.is_symlink() => {
                let next = std::fs::read_link(&path)?;
                // A relative link counts from its own folder.
                path = path.parent().unwrap_or(Path::new("")).join(next);
            }
            _ => return Ok(path),
        }
    }
    Err(io::Error::new(ErrorKind::InvalidInput, "the symbolic links form a circle"))
}
