//! Wavefront OBJ.
//!
//! Read and written here rather than by a library: those at hand number vertices anew in the order of their use, drop
//! the unused and name no line in their errors, while vertex order is what masks and blend shapes go by.

mod parser;
mod writer;

pub(super) use parser::parse;
pub(super) use writer::write;
