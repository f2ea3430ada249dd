//! Where the points are in a file.

use std::io::BufRead;
use std::path::Path;

use super::{PointStreamError, read_header};
use crate::io::ply::{ByteOrder, Element, Header, Number, position_scalars};

/// Most bytes of a header. Larger, and a file that is something else altogether takes memory before it is refused; smaller, and
/// long comments are.
const MAX_HEADER: usize = 1 << 20;

/// Where the points are, by what the header says.
#[derive(Debug)]
pub(super) struct Layout {
    /// The header as it stands in the file.
    pub(super) header: Vec<u8>,
    pub(super) count: u64,
    pub(super) kind: Kind,
}

/// How the points are written.
#[derive(Debug)]
pub(super) enum Kind {
    /// In records of `size` bytes, after as many others.
    Binary { bytes_before: u64, size: usize, offsets: [usize; 3], number: Number, order: ByteOrder },
    /// In lines, as the words of these numbers, after as many others.
    Text { lines: u64, lines_before: u64, columns: [usize; 3], number: Number },
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
        let header = Header::parse(&bytes).map_err(broken)?;
        let vertex = header.elements.iter().position(|element| element.name == "vertex");
        let vertex = vertex.ok_or_else(|| unfit("it has no vertices"))?;
        let (before, vertices) = (&header.elements[..vertex], &header.elements[vertex]);
        let scalars = position_scalars(vertices).map_err(broken)?;
        let number = scalars[0].number;
        if scalars.iter().any(|scalar| scalar.number != number) || !matches!(number, Number::F32 | Number::F64) {
            return Err(unfit("x, y and z must be of one type, float or double, to be written over"));
        }
        let lists = "the file has lists before or among its vertices, which cannot be passed over in bounded memory";
        let kind = match header.order {
            Some(order) => {
                let bytes = |element: &Element| (element.size()? as u64).checked_mul(element.count as u64);
                let bytes_before: Option<u64> = before.iter().map(bytes).sum();
                let (Some(bytes_before), Some(size)) = (bytes_before, vertices.size()) else {
                    return Err(unfit(lists));
                };
                Kind::Binary { bytes_before, size, offsets: scalars.map(|scalar| scalar.offset), number, order }
            }
            None => {
                let first_list = vertices.properties.iter().position(|property| property.length.is_some());
                let columns = scalars.map(|scalar| scalar.index);
                if first_list.is_some_and(|list| columns.iter().any(|&column| column > list)) {
                    return Err(unfit(lists));
                }
                let lines_before = before.iter().map(|element| element.count as u64).sum();
                Kind::Text { lines: header.lines as u64, lines_before, columns, number }
            }
        };
        Ok(Self { header: bytes, count: vertices.count as u64, kind })
    }

    fn of_npy(path: &Path, input: &mut impl BufRead) -> Result<Self, PointStreamError> {
        let unfit = |problem: String| PointStreamError::header(path, problem);
        let failed = |source| PointStreamError::read(path, source);
        // Six letters, two numbers of the version, and the length of the rest in two bytes or, from version 2 on, in four.
        let mut header = vec![0; 8];
        let truncated = |_| unfit("the file is truncated in its header".into());
        input.read_exact(&mut header).map_err(truncated)?;
        if !header.starts_with(b"\x93NUMPY") {
            return Err(unfit("this is no NumPy array".into()));
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
        let (number, order) = match parsed.dtype().descr().trim_matches('\'') {
            "<f4" => (Number::F32, ByteOrder::Little),
            ">f4" => (Number::F32, ByteOrder::Big),
            "<f8" => (Number::F64, ByteOrder::Little),
            ">f8" => (Number::F64, ByteOrder::Big),
            other => return Err(unfit(format!("numbers of type {other} are no points; give f4 or f8"))),
        };
        let &[count, 3] = parsed.shape() else {
            return Err(unfit(format!("the array has the shape {:?}; points need (N, 3)", parsed.shape())));
        };
        if parsed.order() == npyz::Order::Fortran && count > 1 {
            return Err(unfit("the array is in Fortran order; save it in C order".into()));
        }
        let size = number.size();
        let kind = Kind::Binary { bytes_before: 0, size: 3 * size, offsets: [0, size, 2 * size], number, order };
        Ok(Self { header, count, kind })
    }

    pub(super) fn is_single_precision(&self) -> bool {
        matches!(self.kind, Kind::Binary { number: Number::F32, .. } | Kind::Text { number: Number::F32, .. })
    }

    /// Bytes, of text lines, of the header.
    pub(super) fn start(&self) -> u64 {
        match self.kind {
            Kind::Binary { .. } => self.header.len() as u64,
            Kind::Text { lines, .. } => lines,
        }
    }

    /// The byte at which the first point of a binary file begins.
    pub(super) fn first_point(&self) -> u64 {
        match self.kind {
            Kind::Binary { bytes_before, .. } => self.start() + bytes_before,
            Kind::Text { lines, lines_before, .. } => lines + lines_before,
        }
    }
}
