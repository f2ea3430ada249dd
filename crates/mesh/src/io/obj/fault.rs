//! Finding the faulty line of an OBJ file.

use super::statement::Statements;
use crate::io::text::{Words, at_line, parse_integer, read_numbers, read_values, text};
use crate::io::{LineProblem, ParseError};

/// The elements that the three indices of a corner refer to.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// Reports the first line that violates the format. Indices out of range are reported only if no
/// line is otherwise invalid, because the element of an index may come later in the file.
pub(super) fn check_lines(bytes: &[u8]) -> Result<(), ParseError> {
    let totals = check_statements(bytes, [usize::MAX; 3])?;
    check_statements(bytes, totals)?;
    Ok(())
}

/// Checks all statements against `totals`, the numbers of vertices, texture coordinates and
/// normals, and returns the numbers found.
fn check_statements(bytes: &[u8], totals: [usize; 3]) -> Result<[usize; 3], ParseError> {
    let mut counts = [0; 3];
    for statement in Statements::of(bytes) {
        check_statement(&statement.plain(), &mut counts, totals).map_err(at_line(statement.line))?;
    }
    Ok(counts)
}

/// Checks one statement. `counts` holds the elements of the preceding statements, from which
/// negative indices count back.
fn check_statement(statement: &[u8], counts: &mut [usize; 3], totals: [usize; 3]) -> Result<(), LineProblem> {
    let mut words = Words { rest: statement };
    let kind = match words.next().unwrap_or_default() {
        b"v" => {
            // Seven numbers are a position with color and alpha.
            read_numbers::<3>(words.clone(), 3)?;
            read_values::<7>(words, 3)?;
            0
        }
        b"vt" => {
            read_values::<2>(words, 1)?;
            1
        }
        b"vn" => {
            read_values::<3>(words, 3)?;
            2
        }
        b"f" => return check_face(words, *counts, totals),
        _ => return Ok(()),
    };
    counts[kind] += 1;
    Ok(())
}

/// Refuses a face with an invalid index.
pub(super) fn check_face(mut words: Words<'_>, counts: [usize; 3], totals: [usize; 3]) -> Result<(), LineProblem> {
    words.try_for_each(|word| check_corner(word, counts, totals))
}

fn check_corner(word: &[u8], counts: [usize; 3], totals: [usize; 3]) -> Result<(), LineProblem> {
    let not_a_corner = || LineProblem::NotACorner(text(word));
    for (field_index, field) in word.split(|&byte| byte == b'/').enumerate() {
        let kind = *KINDS.get(field_index).ok_or_else(not_a_corner)?;
        if field.is_empty() && field_index > 0 {
            continue;
        }
        let index = parse_integer(field).ok_or_else(not_a_corner)?;
        let count = if index <= 0 { counts[field_index] } else { totals[field_index] };
        if index == 0 || index.unsigned_abs() > count as u64 {
            return Err(LineProblem::IndexOutOfRange { kind, index, count });
        }
    }
    Ok(())
}
