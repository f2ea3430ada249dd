//! Wavefront OBJ.
//!
//! Read in one pass, each byte about once: a statement ends at its line, a number where its last digit does. Corners keep
//! the file's numbers until all vertices are known, because faces may come before them.

mod contents;
mod corner;
mod reader;
mod statement;
mod writer;

pub(super) use reader::parse;
pub(super) use writer::write;
