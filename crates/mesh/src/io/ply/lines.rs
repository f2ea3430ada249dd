//! The words of a text body, arranged as the library expects them.

use ply_rs_bw::ply::{Header, PropertyType, ScalarType};

use crate::io::text::{Words, is_non_finite};

/// The body with one element per line, however its lines are wrapped. Numbers that are not finite, for
/// which the library knows no words, become numbers beyond double precision. `None` if the words do not
/// fit the header.
pub(super) fn one_element_per_line(header: &Header, body: &[u8]) -> Option<Vec<u8>> {
    let mut words = Words { rest: body };
    let mut lines = Vec::with_capacity(body.len());
    for element in header.elements.values().filter(|element| !element.properties.is_empty()) {
        for _ in 0..element.count {
            for property in element.properties.values() {
                match &property.data_type {
                    PropertyType::Scalar(kind) => push_word(words.next()?, kind, &mut lines),
                    PropertyType::List(length, kind) => {
                        let word = words.next()?;
                        push_word(word, length, &mut lines);
                        let count: usize = str::from_utf8(word).ok()?.parse().ok()?;
                        for _ in 0..count {
                            push_word(words.next()?, kind, &mut lines);
                        }
                    }
                }
            }
            lines.push(b'\n');
        }
    }
    words.next().is_none().then_some(lines)
}

fn push_word(word: &[u8], kind: &ScalarType, lines: &mut Vec<u8>) {
    let is_float = matches!(kind, ScalarType::Float | ScalarType::Double);
    lines.extend_from_slice(if is_float && is_non_finite(word) { b"9e999" } else { word });
    lines.push(b' ');
}
