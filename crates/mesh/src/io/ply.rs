//! Stanford PLY.
//!
//! Read and written straight from and to the bytes: a library that hands over element after element takes ten times as
//! long, and many times the memory.

mod body;
mod faces;
mod header;
mod number;
mod reader;
mod vertices;
mod writer;

pub(super) use header::{Element, Header};
pub(super) use number::{ByteOrder, Number};
pub(super) use reader::parse;
pub(super) use vertices::position_scalars;
pub(super) use writer::write;
