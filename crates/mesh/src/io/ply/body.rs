//! The data of a PLY file.

use std::io::ErrorKind;

use ply_rs_bw::parser::{self, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess};

use crate::io::ParseError;

/// Elements that are read at a time. Many more, and they take memory beside the mesh; many fewer, and each call shows.
const CHUNK: usize = 1 << 10;

/// What is left of the data, read element by element in the order of the header.
pub(super) struct Body<'a> {
    header: &'a Header,
    reader: Reader<&'a [u8]>,
    /// Lines of the file before those that the reader counts.
    lines_before: usize,
}

impl<'a> Body<'a> {
    pub(super) fn new(header: &'a Header, bytes: &'a [u8], lines_before: usize) -> Self {
        Self { header, reader: Reader::new(bytes), lines_before }
    }

    /// The same data, to be read once more from here on.
    pub(super) fn copy(&self) -> Self {
        Self::new(self.header, self.rest(), self.lines_before + self.reader.line().max(1) - 1)
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        self.reader.get_ref()
    }

    /// Hands over all elements of a kind, with their numbers.
    ///
    /// # Errors
    /// [`ParseError::Malformed`], naming the element and, in text, its line; and what `take` returns.
    pub(super) fn read<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut take: impl FnMut(usize, E) -> Result<(), ParseError>,
    ) -> Result<(), ParseError> {
        let parser = Parser::<E>::new();
        let mut part = element.clone();
        let start = self.reader.line().max(1);
        for first in (0..element.count).step_by(CHUNK) {
            part.count = CHUNK.min(element.count - first);
            let read = parser.read_payload_for_element(&mut self.reader, &part, self.header);
            // Elements are counted as lines, of binary data too.
            let elements = read.map_err(|error| self.failed(&error, element, self.reader.line() - start))?;
            for (element, number) in elements.into_iter().zip(first..) {
                take(number, element)?;
            }
        }
        Ok(())
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

/// What the library complains of: the innermost of its errors, which stands last.
pub(super) fn problem(error: &parser::ParseError) -> String {
    let message = error.to_string();
    let last = message.lines().last().unwrap_or_default().trim();
    last.strip_prefix("Error: ").unwrap_or(last).to_owned()
}
