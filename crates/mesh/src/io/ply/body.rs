//! The data of a PLY file.

use std::io::ErrorKind;
use std::ops::Range;

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
        for part in Self::parts(element) {
            for (number, element) in part.clone().zip(self.read_part(element, part)?) {
                take(number, element)?;
            }
        }
        Ok(())
    }

    /// The numbers of all elements of a kind, as many at a time as are to be read.
    pub(super) fn parts(element: &ElementDef) -> impl Iterator<Item = Range<usize>> + use<> {
        let count = element.count;
        (0..count).step_by(CHUNK).map(move |first| first..count.min(first + CHUNK))
    }

    /// The elements with these numbers, which are the next ones.
    ///
    /// # Errors
    /// [`ParseError::Malformed`], naming the element and, in text, its line.
    pub(super) fn read_part<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        part: Range<usize>,
    ) -> Result<Vec<E>, ParseError> {
        let element = ElementDef { count: part.len(), ..element.clone() };
        let start = self.reader.line().max(1);
        let read = Parser::new().read_payload_for_element(&mut self.reader, &element, self.header);
        // Elements are counted as lines, of binary data too.
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

/// What the library complains of: the innermost of its errors, which stands last.
pub(super) fn problem(error: &parser::ParseError) -> String {
    let message = error.to_string();
    let last = message.lines().last().unwrap_or_default().trim();
    last.strip_prefix("Error: ").unwrap_or(last).to_owned()
}
