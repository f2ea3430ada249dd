//! The data of a PLY file.

use super::header::{Element, Header, Property};
use super::number::{ByteOrder, Number};
use crate::io::text::{Words, at_line};
use crate::io::{LineProblem, ParseError};

/// What is left of the data, read number by number in the order of the header.
#[derive(Clone)]
pub(super) struct Body<'a> {
    pub(super) rest: &'a [u8],
    /// None for text, where an element is a line.
    pub(super) order: Option<ByteOrder>,
    line: usize,
    words: Words<'a>,
    /// The element at hand, for errors.
    at: (&'a str, usize),
}

impl<'a> Body<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        let rest = &bytes[header.length..];
        Self { rest, order: header.order, line: header.lines, words: Words { rest: &[] }, at: ("header", 0) }
    }

    /// Goes on to the element of this name and number.
    pub(super) fn begin(&mut self, element: &'a Element, number: usize) -> Result<(), ParseError> {
        self.at = (&element.name, number);
        while self.order.is_none() && self.words.is_at_end() {
            if self.rest.is_empty() {
                return Err(self.truncated());
            }
            let end = memchr::memchr(b'\n', self.rest);
            let (line, rest) = self.rest.split_at(end.map_or(self.rest.len(), |end| end + 1));
            (self.words, self.rest) = (Words { rest: line }, rest);
            self.line += 1;
        }
        Ok(())
    }

    /// Leaves the element at hand: of text, what is left of its line.
    pub(super) fn end(&mut self) {
        self.words.rest = &[];
    }

    #[inline]
    pub(super) fn number(&mut self, number: Number) -> Result<f64, ParseError> {
        match self.order {
            Some(order) => {
                let size = number.size();
                let bytes = self.rest.get(..size).ok_or_else(|| self.truncated())?;
                self.rest = &self.rest[size..];
                Ok(number.decode(bytes, order))
            }
            None => match self.words.next_number() {
                Ok(Some(number)) => Ok(number),
                Ok(None) => Err(at_line(self.line)(LineProblem::TooFewWords)),
                Err(problem) => Err(at_line(self.line)(problem)),
            },
        }
    }

    /// The length of a list, which is not longer than what is left of the file.
    pub(super) fn length(&mut self, number: Number) -> Result<usize, ParseError> {
        let length = self.number(number)?;
        let most = self.rest.len() + self.words.rest.len();
        if (0.0..=most as f64).contains(&length) { Ok(length as usize) } else { Err(self.truncated()) }
    }

    /// Reads past a property.
    pub(super) fn skip(&mut self, property: &Property) -> Result<(), ParseError> {
        let count = match property.length {
            Some(length) => self.length(length)?,
            None => 1,
        };
        match self.order {
            Some(_) => {
                let size = count * property.number.size();
                self.rest = self.rest.get(size..).ok_or_else(|| self.truncated())?;
            }
            None if self.words.by_ref().take(count).count() < count => {
                return Err(at_line(self.line)(LineProblem::TooFewWords));
            }
            None => {}
        }
        Ok(())
    }

    /// Reads past all elements of a kind.
    pub(super) fn skip_all(&mut self, element: &'a Element) -> Result<(), ParseError> {
        for number in 0..element.count {
            self.begin(element, number)?;
            element.properties.iter().try_for_each(|property| self.skip(property))?;
            self.end();
        }
        Ok(())
    }

    /// All elements of a kind without lists, in binary data: their bytes, one after the other, and their byte order.
    pub(super) fn take_records(&mut self, element: &'a Element) -> Result<Option<(&'a [u8], ByteOrder)>, ParseError> {
        let (Some(size), Some(order)) = (element.size(), self.order) else { return Ok(None) };
        match size.checked_mul(element.count).and_then(|length| self.rest.split_at_checked(length)) {
            Some((records, rest)) => {
                self.rest = rest;
                Ok(Some((records, order)))
            }
            None => {
                self.at = (&element.name, self.rest.len() / size.max(1));
                Err(self.truncated())
            }
        }
    }

    pub(super) fn truncated(&self) -> ParseError {
        let (element, number) = self.at;
        ParseError::Malformed(format!("the file is truncated: it ends in {element} {number}, counted from zero"))
    }
}
