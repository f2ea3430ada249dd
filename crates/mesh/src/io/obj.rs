//! Wavefront OBJ.
//!
//! The library `tobj` parses the statements that describe the surface. This module keeps what
//! `tobj` drops: the order of the vertices, vertices that no face uses, colors on some vertices
//! only, materials without a library, corners without attributes, and the line number of an error.

mod fault;
mod lines;
mod reader;
mod statement;
mod writer;

pub(super) use reader::parse;
pub(super) use writer::write;
