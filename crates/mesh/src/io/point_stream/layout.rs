//! The layout of the points in a file.

use std::io::BufRead;
use std::path::Path;

use ply_rs_bw::ply::{Addable, ElementDef, Encoding, Header, PropertyDef, PropertyType, ScalarType};

use super::{PointStreamError, read_header};
use crate::io::ply::{coordinates, parse_header, record_size, scalar_size};

/// Largest number of bytes in a header. A larger value wastes memory on files that are not of the
/// format; a smaller one refuses files with long comments.
const MAX_HEADER: usize = 1 << 20;

/// The layout of the points as announced by the header.
#[derive(Debug)]
pub(super) struct Layout {
    /// The bytes of the header.
    pub(super) header: Vec<u8>,
    pub(super) count: u64,
    pub(super) kind: Kind,
    /// The header of a PLY file and its vertices. A NumPy array is read as the data of such a file.
    pub(super) ply: Header,
    pub(super) vertices: ElementDef,
    pub(super) number: ScalarType,
}

/// The encoding of the points.
#[derive(Debug)]
pub(super) enum Kind {
    /// Records of `size` bytes with coordinates at `offsets`, after `bytes_before` other bytes.
    Binary { bytes_before: u64, size: usize, offsets: [usize; 3] },
    /// Lines with coordinates in the words `columns`, after `lines_before` other lines of data.
    Text { lines: u64, lines_before: u64, columns: [usize; 3] },
}

impl Layout {
    pub(super) fn read(path: &Path, input: &mut impl BufRead) -> Result<Self, PointStreamError> {
        let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
        match extension.as_deref().and_then(|extension| extension.to_str()) {
            Some("ply") => Self::of_ply(path, input),
            Some("npy") => Self::of_npy(path, input),
            _ => Err(PointStreamError::UnknownFormat { path: path.to_owned() }),
        }
    }

    fn of_ply(path: &Path, input: &mut impl BufRead) -> Result<Self, PointStreamError> {
        let bytes = read_header(input, b"end_header", MAX_HEADER);
        let bytes = bytes.map_err(|source| PointStreamError::read(path, source))?;
        let broken = |source| PointStreamError::Header { path: path.to_owned(), source: Box::new(source) };
        let unfit = |problem: &str| PointStreamError::header(path, problem);
        let (ply, _, lines) = parse_header(&bytes).map_err(broken)?;
        let vertex = ply.elements.get_index_of("vertex").ok_or_else(|| unfit("it has no vertices"))?;
        let before = || ply.elements.values().take(vertex);
        let vertices = ply.elements[vertex].clone();
        let coordinates = coordinates(&vertices).map_err(broken)?;
        let columns = coordinates.map(|(column, _)| column);
        let number = coordinates[0].1.clone();
        if coordinates.iter().any(|&(_, other)| *other != number)
            || !matches!(number, ScalarType::Float | ScalarType::Double)
        {
            return Err(unfit("x, y and z must have the same type, float or double, to be overwritten"));
        }
        let lists =
            || unfit("the file has lists before or among its vertices, which cannot be skipped in bounded memory");
        let kind = if ply.encoding == Encoding::Ascii {
            let offsets = columns.map(|column| record_size(&vertices, column));
            if offsets.contains(&None) {
                return Err(lists());
            }
            let lines_before = before().map(|element| element.count as u64).sum();
            Kind::Text { lines: lines as u64, lines_before, columns }
        } else {
            let bytes =
                |element: &ElementDef| (record_size(element, usize::MAX)? as u64).checked_mul(element.count as u64);
            let bytes_before = before().map(bytes).sum::<Option<u64>>().ok_or_else(lists)?;
            let size = record_size(&vertices, usize::MAX).ok_or_else(lists)?;
            let offsets = columns.map(|column| record_size(&vertices, column).unwrap_or_default());
            Kind::Binary { bytes_before, size, offsets }
        };
        Ok(Self { header: bytes, count: vertices.count as u64, kind, ply, vertices, number })
    }

    fn of_npy(path: &Path, input: &mut impl BufRead) -> Result<Self, PointStreamError> {
        let unfit = |problem: String| PointStreamError::header(path, problem);
        let failed = |source| PointStreamError::read(path, source);
        // Six letters, two version numbers, and the length of the rest: two bytes, or four from
        // version 2 on.
        let mut header = vec![0; 8];
        let truncated = |_| unfit("the file is truncated in its header".into());
        input.read_exact(&mut header).map_err(truncated)?;
        if !header.starts_with(b"\x93NUMPY") {
            return Err(unfit("this is not a NumPy array".into()));
        }
        let length_size = if header[6] == 1 { 2 } else { 4 };
        header.resize(8 + length_size, 0);
        input.read_exact(&mut header[8..]).map_err(truncated)?;
        let length = header[8..].iter().rev().fold(0, |length, &byte| (length << 8) | usize::from(byte));
        if length > MAX_HEADER {
            return Err(unfit(format!("a header of {length} bytes is too long")));
        }
        header.resize(8 + length_size + length, 0);
        input.read_exact(&mut header[8 + length_size..]).map_err(truncated)?;
        let parsed = npyz::NpyHeader::from_reader(&header[..]).map_err(failed)?;
        let (number, encoding) = match parsed.dtype().descr().trim_matches('\'') {
            "<f4" => (ScalarType::Float, Encoding::BinaryLittleEndian),
            ">f4" => (ScalarType::Float, Encoding::BinaryBigEndian),
            "<f8" => (ScalarType::Double, Encoding::BinaryLittleEndian),
            ">f8" => (ScalarType::Double, Encoding::BinaryBigEndian),
            other => return Err(unfit(format!("the number type {other} is not supported; use f4 or f8"))),
        };
        let &[count, 3] = parsed.shape() else {
            return Err(unfit(format!("the array has the shape {:?}; points need (N, 3)", parsed.shape())));
        };
        if parsed.order() == npyz::Order::Fortran && count > 1 {
            return Err(unfit("the array is in Fortran order; save it in C order".into()));
        }
        let mut vertices = ElementDef::new("vertex".into());
        for name in ["x", "y", "z"] {
            vertices.properties.add(PropertyDef::new(name.into(), PropertyType::Scalar(number.clone())));
        }
        let size = scalar_size(&number);
        let kind = Kind::Binary { bytes_before: 0, size: 3 * size, offsets: [0, size, 2 * size] };
        Ok(Self { header, count, kind, ply: Header { encoding, ..Header::new() }, vertices, number })
    }

    pub(super) fn is_single_precision(&self) -> bool {
        self.number == ScalarType::Float
    }

    /// Length of the header in bytes, or in lines of a text file.
    pub(super) fn start(&self) -> u64 {
        match self.kind {
            Kind::Binary { .. } => self.header.len() as u64,
            Kind::Text { lines, .. } => lines,
        }
    }

    /// Byte at which the first point begins, or its line in a text file.
    pub(super) fn first_point(&self) -> u64 {
        match self.kind {
            Kind::Binary { bytes_before, .. } => self.start() + bytes_before,
            Kind::Text { lines, lines_before, .. } => lines + lines_before,
        }
    }
}
