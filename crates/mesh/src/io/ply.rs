//! Stanford PLY.
//!
//! Read by the library `ply-rs-bw`, some elements at a time, so that what they take beside the mesh stays small. Attributes of
//! corners that differ at a vertex are lists of the face, so that the surface stays closed for every reader: `texcoord` and
//! `color` as MeshLab has them, and `normal` after their model.

mod body;
mod face;
mod header;
mod plain_triangle;
mod reader;
mod vertex;
mod writer;

pub(super) use header::{coordinates, parse_header, record_size, scalar_size};
pub(super) use reader::parse;
pub(super) use vertex::read_points;
pub(super) use writer::write;
