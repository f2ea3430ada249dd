//! The header of a PLY file.

use super::number::{ByteOrder, Number};
use crate::io::ParseError;
use crate::io::text::{Words, text};

/// What the header announces.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Header {
    /// None for text.
    pub(in crate::io) order: Option<ByteOrder>,
    /// In the order of their data.
    pub(in crate::io) elements: Vec<Element>,
    /// Bytes of the header, the end of its last line included.
    pub(in crate::io) length: usize,
    /// Lines of the header.
    pub(in crate::io) lines: usize,
}

/// An element and how many there are.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Element {
    pub(in crate::io) name: String,
    pub(in crate::io) count: usize,
    pub(in crate::io) properties: Vec<Property>,
}

/// A property of an element.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Property {
    pub(in crate::io) name: String,
    pub(in crate::io) number: Number,
    /// The type of the length of a list; none for a single number.
    pub(in crate::io) length: Option<Number>,
}

impl Header {
    /// # Errors
    /// [`ParseError::Malformed`], naming the line.
    pub(in crate::io) fn parse(bytes: &[u8]) -> Result<Self, ParseError> {
        let (mut order, mut elements) = (None, Vec::<Element>::new());
        let (mut length, mut lines) = (0, 0);
        loop {
            let rest = &bytes[length..];
            let end = memchr::memchr(b'\n', rest);
            let line = &rest[..end.unwrap_or(rest.len())];
            length += end.map_or(rest.len(), |end| end + 1);
            lines += 1;
            let malformed = |problem: &str| Err(ParseError::Malformed(format!("line {lines}: {problem}")));
            let words: Vec<&[u8]> = Words { rest: line }.take(5).collect();
            match *words {
                [b"ply"] if lines == 1 => {}
                _ if lines == 1 => return malformed("'ply' expected: this is no PLY file"),
                _ if end.is_none() => return malformed("the header has no 'end_header'"),
                [b"format", format, _] => {
                    order = Some(match format {
                        b"ascii" => None,
                        b"binary_little_endian" => Some(ByteOrder::Little),
                        b"binary_big_endian" => Some(ByteOrder::Big),
                        _ => return malformed(&format!("unknown format '{}'", text(format))),
                    });
                }
                [b"element", name, count] => {
                    let Ok(count) = text(count).parse() else {
                        return malformed(&format!("'{}' is not a number of elements", text(count)));
                    };
                    elements.push(Element { name: text(name), count, properties: Vec::new() });
                }
                [b"property", ref kind @ .., name] => {
                    let Some((number, length)) = types(kind) else { return malformed("unknown type of property") };
                    let Some(element) = elements.last_mut() else {
                        return malformed("a property comes before all elements");
                    };
                    element.properties.push(Property { name: text(name), number, length });
                }
                [b"end_header"] => break,
                [] | [b"comment" | b"obj_info", ..] => {}
                _ => return malformed(&format!("'{}' does not belong in the header", text(line))),
            }
        }
        match order {
            Some(order) => Ok(Self { order, elements, length, lines }),
            None => Err(ParseError::Malformed("the header names no format".into())),
        }
    }
}

/// The type of a property's numbers and, for a list, of its length.
fn types(words: &[&[u8]]) -> Option<(Number, Option<Number>)> {
    match words {
        [number] => Some((Number::of_name(number)?, None)),
        [b"list", length, number] => {
            let length = Number::of_name(length).filter(|length| length.is_whole())?;
            Some((Number::of_name(number)?, Some(length)))
        }
        _ => None,
    }
}

impl Element {
    /// The property of one of these names that is a single number.
    pub(in crate::io) fn scalar(&self, names: &[&str]) -> Option<Scalar> {
        let is_it = |property: &Property| property.length.is_none() && names.contains(&property.name.as_str());
        let index = self.properties.iter().position(is_it)?;
        let offset = self.properties[..index].iter().map(|property| property.number.size()).sum();
        Some(Scalar { index, offset, number: self.properties[index].number })
    }

    /// Several such properties, where all are there.
    pub(in crate::io) fn scalars<const N: usize>(&self, names: [&[&str]; N]) -> Option<[Scalar; N]> {
        let found: Vec<Scalar> = names.into_iter().map_while(|names| self.scalar(names)).collect();
        found.try_into().ok()
    }

    /// Bytes of the element in binary data; none where there is a list in it.
    pub(in crate::io) fn size(&self) -> Option<usize> {
        self.properties.iter().map(|property| property.length.is_none().then(|| property.number.size())).sum()
    }
}

/// A property that is a single number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::io) struct Scalar {
    /// Which of the properties it is.
    pub(in crate::io) index: usize,
    /// Bytes before it in binary data, where there is no list among the properties.
    pub(in crate::io) offset: usize,
    pub(in crate::io) number: Number,
}
