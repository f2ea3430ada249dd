//! STL, both kinds.
//!
//! The library `stl_io` reads binary files. Text files are read here, because it rounds them to single precision, stops
//! after the first solid, refuses solids without a name and facets whose normal is not a number, and its errors name
//! no line.

use std::io::{self, Cursor, Write};

use glam::{DVec3, Vec3};

use super::text::{at_line, numbered_lines, read_numbers};
use super::{LineProblem, ParseError};
use crate::TriMesh;
use crate::measure::triangle_normal;

/// Bytes before the triangles of a binary file: a free text and their number.
const HEADER: usize = 84;
/// Bytes of a triangle of a binary file: normal, corners and two bytes of attributes.
const RECORD: usize = 50;

/// Reads STL. Equal positions become one vertex; coordinates of text files keep their double precision.
pub(super) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let count =
        bytes.get(80..HEADER).map(|count| u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize);
    let expected = count.map(|count| HEADER + RECORD * count);
    // The size decides, because the header of a binary file may say anything.
    let positions = if expected == Some(bytes.len()) {
        parse_binary(bytes)?
    } else if bytes.trim_ascii_start().starts_with(b"solid") {
        parse_text(bytes)?
    } else {
        return match expected {
            Some(expected) if expected < bytes.len() => Ok(soup(parse_binary(bytes)?)),
            Some(expected) => Err(ParseError::Malformed(format!(
                "the file is truncated: {expected} bytes announced, {} found",
                bytes.len()
            ))),
            None => Err(ParseError::Malformed("the file is truncated in its header".into())),
        };
    };
    Ok(soup(positions))
}

fn parse_binary(bytes: &[u8]) -> Result<Vec<DVec3>, ParseError> {
    let mut bytes = bytes.to_vec();
    // The library takes every file that begins with `solid` for text.
    bytes[0] = 0;
    let read = |error: io::Error| ParseError::Malformed(error.to_string());
    let corners = |triangle: stl_io::Triangle| triangle.vertices.map(|corner| Vec3::from_array(corner.0).as_dvec3());
    let triangles: Result<Vec<_>, _> = stl_io::create_stl_reader(&mut Cursor::new(bytes))
        .map_err(read)?
        .map(|triangle| triangle.map(corners))
        .collect();
    Ok(triangles.map_err(read)?.concat())
}

/// Corners of all facets of all solids. Only `vertex` and the ends of loops matter.
fn parse_text(bytes: &[u8]) -> Result<Vec<DVec3>, ParseError> {
    let mut positions = Vec::new();
    let mut last_line = 0;
    for (line, mut words) in numbered_lines(bytes) {
        last_line = line;
        match words.next().unwrap_or_default() {
            b"vertex" => {
                let (numbers, _) = read_numbers::<3>(words, 3).map_err(at_line(line))?;
                positions.push(DVec3::from_array(numbers));
            }
            b"endloop" if !positions.len().is_multiple_of(3) => {
                return Err(at_line(line)(LineProblem::NotATriangle));
            }
            _ => {}
        }
    }
    match positions.len().is_multiple_of(3) {
        true => Ok(positions),
        false => Err(at_line(last_line)(LineProblem::NotATriangle)),
    }
}

fn soup(positions: Vec<DVec3>) -> TriMesh {
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriMesh::new(positions, triangles).welded()
}

/// Writes binary STL. The facet normals are those of the triangles as rounded.
pub(super) fn write(mesh: &TriMesh, writer: &mut dyn Write) -> io::Result<()> {
    let mut header = [0; 80];
    header[..8].copy_from_slice(b"isochore");
    writer.write_all(&header)?;
    writer.write_all(&(mesh.triangles.len() as u32).to_le_bytes())?;
    for triangle in &mesh.triangles {
        let corners = triangle.map(|vertex| mesh.positions[vertex as usize].as_vec3());
        let normal = triangle_normal(corners.map(|corner| corner.as_dvec3())).as_vec3();
        let mut record = [0; RECORD];
        for (bytes, vector) in record.chunks_exact_mut(12).zip([normal, corners[0], corners[1], corners[2]]) {
            for (bytes, coordinate) in bytes.chunks_exact_mut(4).zip(vector.to_array()) {
                bytes.copy_from_slice(&coordinate.to_le_bytes());
            }
        }
        writer.write_all(&record)?;
    }
    Ok(())
}
