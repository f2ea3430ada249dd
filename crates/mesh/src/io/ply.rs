//! Stanford PLY.
//!
//! The library `ply-rs-bw` parses the file in chunks of elements, so that little memory is needed
//! besides the mesh. Corner attributes that differ at a vertex are lists of the face, so that the
//! surface stays closed for every reader: `texcoord` and `color` as in MeshLab, and `normal` by
//! analogy.

mod body;
mod face;
mod face_list;
mod header;
mod lines;
mod plain_triangle;
mod reader;
mod vertex;
mod writer;

pub(super) use header::{coordinates, parse_header, record_size, scalar_size};
pub(super) use reader::parse;
pub(super) use vertex::read_points;
pub(super) use writer::write;
