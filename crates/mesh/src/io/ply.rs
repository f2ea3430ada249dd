//! Stanford PLY.
//!
//! Attributes of corners that differ at a vertex are lists of the face, so that the surface stays closed for every
//! reader: `texcoord` and `color` as MeshLab has them, and `normal` after their model.

mod parser;
mod writer;

pub(super) use parser::parse;
pub(super) use writer::write;
