//! Binary and text STL.
//!
//! The library `stl_io` reads binary files. This module reads text files itself, because `stl_io`
//! rounds them to single precision, stops after the first solid, refuses solids without a name and
//! facets whose normal is not a number, and its errors do not name a line.

use std::borrow::Cow;
use std::io::{self, Cursor, Write};

use glam::{DVec3, Vec3};

use super::text::{FLUSH_AT, at_line, flush, numbered_lines, read_numbers};
use super::{LineProblem, ParseError};
use crate::TriMesh;
use crate::huge_pages::in_huge_pages;
use crate::measure::triangle_normal;
use crate::position_table::PositionTable;

/// Bytes before the triangles of a binary file: 80 bytes of free text and the number of triangles.
const HEADER: usize = 84;
/// Bytes of a triangle in a binary file: normal, corners and two bytes of attributes.
const RECORD: usize = 50;

/// Reads STL. Equal positions become one vertex. Coordinates of text files are read in double
/// precision.
pub(super) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let count =
        bytes.get(80..HEADER).map(|count| u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize);
    let expected = count.map(|count| HEADER + RECORD * count);
    // The size decides first, because the free text of a binary file may begin with `solid` too.
    match expected {
        Some(expected) if expected == bytes.len() => parse_binary(bytes),
        _ if bytes.trim_ascii_start().starts_with(b"solid") => parse_text(bytes),
        Some(expected) if expected < bytes.len() => parse_binary(bytes),
        Some(expected) => Err(ParseError::Malformed(format!(
            "the file is truncated: {expected} bytes announced, {} found",
            bytes.len()
        ))),
        None => Err(ParseError::Malformed("the file is truncated in its header".into())),
    }
}

fn parse_binary(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let mut bytes = Cow::Borrowed(bytes);
    // The library takes every file that begins with `solid` for text.
    if bytes.starts_with(b"solid") {
        bytes.to_mut()[0] = 0;
    }
    let corners = |triangle: stl_io::Triangle| triangle.vertices.map(|corner| Vec3::from_array(corner.0).as_dvec3());
    let mut source = Cursor::new(bytes.as_ref());
    let triangles = stl_io::create_stl_reader(&mut source);
    let mesh = triangles.and_then(|triangles| {
        let count = triangles.size_hint().0;
        welded(triangles.map(|triangle| triangle.map(corners)), count)
    });
    mesh.map_err(|error| ParseError::Malformed(error.to_string()))
}

/// Reads the facets of all solids. All keywords except `vertex` and `endloop` are ignored.
fn parse_text(bytes: &[u8]) -> Result<TriMesh, ParseError> {
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
    match positions.as_chunks() {
        (triangles, []) => welded(triangles.iter().copied().map(Ok), triangles.len()),
        _ => Err(at_line(last_line)(LineProblem::NotATriangle)),
    }
}

/// Merges equal positions into one vertex and drops triangles that thereby collapse.
fn welded<E>(triangles: impl Iterator<Item = Result<[DVec3; 3], E>>, count: usize) -> Result<TriMesh, E> {
    // A closed surface has about half as many vertices as triangles.
    let mut table = PositionTable::with_capacity(count / 2);
    let mut mesh = TriMesh::new(in_huge_pages(Vec::with_capacity(count / 2)), in_huge_pages(Vec::with_capacity(count)));
    for corners in triangles {
        let [a, b, c] = corners?.map(|position| {
            let new = mesh.positions.len() as u32;
            let vertex = table.find_or_insert(position, new, |known| mesh.positions[known as usize]);
            if vertex == new {
                mesh.positions.push(position);
            }
            vertex
        });
        if a != b && b != c && c != a {
            mesh.triangles.push([a, b, c]);
        }
    }
    Ok(mesh)
}

/// Writes binary STL. Facet normals are computed from the rounded positions.
pub(super) fn write(mesh: &TriMesh, writer: &mut dyn Write) -> io::Result<()> {
    let mut header = [0; 80];
    header[..8].copy_from_slice(b"isochore");
    writer.write_all(&header)?;
    writer.write_all(&(mesh.triangles.len() as u32).to_le_bytes())?;
    let mut records = Vec::with_capacity(FLUSH_AT + RECORD);
    for triangle in &mesh.triangles {
        let corners = triangle.map(|vertex| mesh.positions[vertex as usize].as_vec3());
        let normal = triangle_normal(corners.map(|corner| corner.as_dvec3())).as_vec3();
        let mut record = [0; RECORD];
        for (bytes, vector) in record.chunks_exact_mut(12).zip([normal, corners[0], corners[1], corners[2]]) {
            for (bytes, coordinate) in bytes.chunks_exact_mut(4).zip(vector.to_array()) {
                bytes.copy_from_slice(&coordinate.to_le_bytes());
            }
        }
        records.extend_from_slice(&record);
        flush(&mut records, writer, FLUSH_AT)?;
    }
    flush(&mut records, writer, 0)
}
