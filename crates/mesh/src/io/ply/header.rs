//! The header of a PLY file.

use std::io::ErrorKind;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, ElementDef, Header, PropertyType, ScalarType};

use crate::io::ParseError;
use crate::io::text::{decode, text};

/// Largest number of characters of a line that an error shows.
const SHOWN: usize = 80;

/// Parses the header and returns it with its length in bytes and in lines.
///
/// # Errors
/// [`ParseError::Malformed`], which names the line.
pub(in crate::io) fn parse_header(bytes: &[u8]) -> Result<(Header, usize, usize), ParseError> {
    let (mut length, mut lines) = (0, 0);
    while length < bytes.len() {
        let line = &bytes[length..length + line_length(&bytes[length..])];
        length += line.len();
        lines += 1;
        if line.trim_ascii() == b"end_header" {
            break;
        }
        if lines == 1 && line.trim_ascii() != b"ply" {
            return Err(malformed(bytes, 1));
        }
    }
    // Comments may have any encoding, but the library requires UTF-8.
    let head = decode(&bytes[..length])?;
    let shown = String::from_utf8_lossy(&head);
    let header = Parser::<DefaultElement>::new().read_header(&mut Reader::new(shown.as_bytes()));
    match header {
        Ok(header) => Ok((header, length, lines)),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
            Err(ParseError::Malformed("the header has no 'end_header'".into()))
        }
        Err(error) => Err(match error.line() {
            Some(line) => malformed(bytes, line),
            None => ParseError::Malformed(error.to_string().lines().collect::<Vec<_>>().join(" ")),
        }),
    }
}

/// Length of the first line with its end: LF, CR LF or CR.
fn line_length(bytes: &[u8]) -> usize {
    match memchr::memchr2(b'\n', b'\r', bytes) {
        Some(end) if bytes[end..].starts_with(b"\r\n") => end + 2,
        Some(end) => end + 1,
        None => bytes.len(),
    }
}

fn malformed(bytes: &[u8], line: usize) -> ParseError {
    let shown = bytes.split(|&byte| byte == b'\n').nth(line - 1).unwrap_or_default();
    let shown: String = text(shown).chars().take(SHOWN).flat_map(char::escape_default).collect();
    ParseError::Malformed(format!("line {line}: '{shown}' does not belong in the header of a PLY file"))
}

/// Whether the element has a scalar property for each meaning, under any of its names.
pub(super) fn has_numbers(element: &ElementDef, meanings: &[&[&str]]) -> bool {
    let is_number = |name: &&str| {
        let property = element.properties.get(*name);
        property.is_some_and(|property| matches!(property.data_type, PropertyType::Scalar(_)))
    };
    meanings.iter().all(|names| names.iter().any(is_number))
}

/// Indices and types of the properties x, y and z of the vertices.
///
/// # Errors
/// [`ParseError::Malformed`] if one is missing or is a list.
pub(in crate::io) fn coordinates(vertices: &ElementDef) -> Result<[(usize, &ScalarType); 3], ParseError> {
    let find = |name: &str| match vertices.properties.get_full(name).map(|(index, _, found)| (index, &found.data_type))
    {
        Some((index, PropertyType::Scalar(scalar))) => Ok((index, scalar)),
        _ => Err(ParseError::Malformed("the vertices need the properties x, y and z, each a number".into())),
    };
    Ok([find("x")?, find("y")?, find("z")?])
}

/// Size in bytes of the first `properties` of an element in binary data. `None` if one of them is a
/// list.
pub(in crate::io) fn record_size(element: &ElementDef, properties: usize) -> Option<usize> {
    let size = |kind: &PropertyType| match kind {
        PropertyType::Scalar(scalar) => Some(scalar_size(scalar)),
        PropertyType::List(..) => None,
    };
    element.properties.values().take(properties).map(|property| size(&property.data_type)).sum()
}

/// Size of a number in bytes.
pub(in crate::io) fn scalar_size(scalar: &ScalarType) -> usize {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}
