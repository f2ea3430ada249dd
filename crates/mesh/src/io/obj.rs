//! Wavefront OBJ.
//!
//! Read by the library `tobj`, which gets the statements that bear on the surface. What it does not keep is seen to here: the
//! order of the vertices and those that no face uses, colors of some vertices only, materials without a library, corners
//! without attributes, and the line of an error.

mod fault;
mod lines;
mod reader;
mod statement;
mod writer;

pub(super) use reader::parse;
pub(super) use writer::write;
