//! Object File Format.

use std::io::{self, Write};

use glam::DVec3;

use super::polygon::triangulate;
use super::text::{LineWriter, Words, at_line, numbered_lines, parse_integer, read_numbers, text};
use super::{LineProblem, ParseError};
use crate::TriMesh;

/// Reads the positions and faces of OFF and of its variants with normals, colors or texture
/// coordinates.
pub(super) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let truncated = || ParseError::Malformed("the file ends too early".into());
    let mut lines = numbered_lines(bytes);
    let (mut line, mut words) = lines.next().ok_or_else(truncated)?;
    let keyword = words.next().unwrap_or_default();
    let is_known = keyword.strip_suffix(b"OFF").is_some_and(|kind| kind.iter().all(|byte| b"STCN".contains(byte)));
    if !is_known {
        return Err(ParseError::Malformed(format!("'{}' is not a header of OFF", text(keyword))));
    }
    if words.rest.trim_ascii().is_empty() {
        (line, words) = lines.next().ok_or_else(truncated)?;
    }
    let [vertices, faces] = read_counts(words).map_err(at_line(line))?;

    let mut mesh = TriMesh::default();
    for _ in 0..vertices {
        let (line, words) = lines.next().ok_or_else(truncated)?;
        let (numbers, _) = read_numbers::<3>(words, 3).map_err(at_line(line))?;
        mesh.positions.push(DVec3::from_array(numbers));
    }
    let mut corners = Vec::new();
    let mut polygon = Vec::new();
    for _ in 0..faces {
        let (line, words) = lines.next().ok_or_else(truncated)?;
        read_face(words, vertices, &mut corners).map_err(at_line(line))?;
        polygon.clear();
        polygon.extend(corners.iter().map(|&vertex| mesh.positions[vertex as usize]));
        triangulate(&polygon, |triangle| mesh.triangles.push(triangle.map(|corner| corners[corner])));
    }
    Ok(mesh.welded_at_boundary())
}

fn read_counts(mut words: Words<'_>) -> Result<[usize; 2], LineProblem> {
    let mut counts = [0; 2];
    for (found, count) in counts.iter_mut().enumerate() {
        let word = words.next().ok_or(LineProblem::TooFewNumbers { expected: 2, found })?;
        let value = parse_integer(word).and_then(|value| usize::try_from(value).ok());
        *count = value.ok_or_else(|| LineProblem::NotANumber(text(word)))?;
    }
    Ok(counts)
}

fn read_face(mut words: Words<'_>, count: usize, corners: &mut Vec<u32>) -> Result<(), LineProblem> {
    let not_a_number = |word| LineProblem::NotANumber(text(word));
    let word = words.next().unwrap_or_default();
    let expected = parse_integer(word).and_then(|size| usize::try_from(size).ok()).ok_or_else(|| not_a_number(word))?;
    corners.clear();
    for word in words.take(expected) {
        let index = parse_integer(word).ok_or_else(|| not_a_number(word))?;
        let is_in_range = usize::try_from(index).is_ok_and(|index| index < count);
        match u32::try_from(index) {
            Ok(vertex) if is_in_range => corners.push(vertex),
            _ => return Err(LineProblem::IndexOutOfRange { kind: "vertex", index, count }),
        }
    }
    match corners.len() {
        found if found < expected => Err(LineProblem::TooFewNumbers { expected, found }),
        found @ 0..3 => Err(LineProblem::TooFewCorners(found)),
        _ => Ok(()),
    }
}

/// Writes positions and triangles.
pub(super) fn write(mesh: &TriMesh, writer: &mut dyn Write) -> io::Result<()> {
    let mut out = LineWriter::new(writer);
    out.push_text(&format!("OFF\n{} {} 0", mesh.positions.len(), mesh.triangles.len()));
    out.end_line()?;
    for position in &mesh.positions {
        out.push_number(position.x);
        out.push_numbers([position.y, position.z]);
        out.end_line()?;
    }
    for triangle in &mesh.triangles {
        out.push_text("3");
        for &vertex in triangle {
            out.push_text(" ");
            out.push_index(vertex);
        }
        out.end_line()?;
    }
    out.finish()
}
