//! The data of a PLY file.

use std::io::ErrorKind;
use std::ops::Range;

use ply_rs_bw::parser::{self, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess};

use crate::io::ParseError;

/// Elements that are read at a time. Larger values take more memory besides the mesh; smaller ones
/// make the cost of each call noticeable.
const CHUNK: usize = 1 << 10;

/// The unread data, which is read element by element in the order of the header.
pub(super) struct Body<'a> {
    header: &'a Header,
    reader: Reader<&'a [u8]>,
    /// Lines of the file before the first one that the reader counts.
    lines_before: usize,
}

impl<'a> Body<'a> {
    pub(super) fn new(header: &'a Header, bytes: &'a [u8], lines_before: usize) -> Self {
        Self { header, reader: Reader::new(bytes), lines_before }
    }

    /// A second reader of the unread data.
    pub(super) fn copy(&self) -> Self {
        Self::new(self.header, self.rest(), self.lines_before + self.reader.line().max(1) - 1)
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        self.reader.get_ref()
    }

    /// Passes all elements of a kind to `take`, with their indices.
    ///
    /// # Errors
    /// [`ParseError::Malformed`], which names the element and, in text, its line; and errors of
    /// `take`.
    pub(super) fn read<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut take: impl FnMut(usize, E) -> Result<(), ParseError>,
    ) -> Result<(), ParseError> {
        for part in Self::parts(element) {
            for (number, element) in part.clone().zip(self.read_part(element, part)?) {
                take(number, element)?;
            }
        }
        Ok(())
    }

    /// The indices of all elements of a kind, in chunks to be read at once.
    pub(super) fn parts(element: &ElementDef) -> impl Iterator<Item = Range<usize>> + use<> {
        let count = element.count;
        (0..count).step_by(CHUNK).map(move |first| first..count.min(first + CHUNK))
    }

    /// Reads the elements with the indices `part`, which must be the next ones.
    ///
    /// # Errors
    /// [`ParseError::Malformed`], which names the element and, in text, its line.
    pub(super) fn read_part<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        part: Range<usize>,
    ) -> Result<Vec<E>, ParseError> {
        let element = ElementDef { count: part.len(), ..element.clone() };
        let start = self.reader.line().max(1);
        let read = Parser::new().read_payload_for_element(&mut self.reader, &element, self.header);
        // The library counts elements as lines, in binary data too.
        read.map_err(|error| self.failed(&error, &element, part.start + self.reader.line() - start))
    }

    fn failed(&self, error: &parser::ParseError, element: &ElementDef, number: usize) -> ParseError {
        let name = &element.name;
        ParseError::Malformed(match self.header.encoding {
            _ if error.kind() == ErrorKind::UnexpectedEof => {
                format!("the file is truncated: it ends in {name} {number}, counted from zero")
            }
            Encoding::Ascii => {
                let line = self.lines_before + self.reader.line();
                format!("line {line}: {name} {number}: {}", problem(error))
            }
            _ => format!("{name} {number}, counted from zero: {}", problem(error)),
        })
    }
}

/// The innermost error of the library, which is the last line of its message.
pub(super) fn problem(error: &parser::ParseError) -> String {
    let message = error.to_string();
    let last = message.lines().last().unwrap_or_default().trim();
    last.strip_prefix("Error: ").unwrap_or(last).to_owned()
}
