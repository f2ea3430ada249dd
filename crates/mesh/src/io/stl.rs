//! Binary and text STL.
//!
//! The library `stl_io` reads binary files. This module reads text files itself, because `stl_io`
//! rounds them to single precision, stops after the first solid, refuses solids without a name and
//! facets whose normal is not a number, and its errors do not name a line.

use std::borrow::Cow;
use std::io::{self, Cursor, Write};

use glam::{DVec3, Vec3};

use super::text::{FLUSH_AT, Tokens, at_line, decode, flush, without_mark};
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
    // The size decides first, because the free text of a binary file may begin with `solid` too.
    if has_exact_size(bytes) {
        return parse_binary(bytes);
    }
    match announced_size(bytes) {
        Some(expected) if !is_text(bytes) && expected < bytes.len() => parse_binary(bytes),
        _ if begins_with_solid(bytes) => parse_text(&decode(bytes)?),
        Some(expected) => {
            without_mark(bytes)?;
            let found = bytes.len();
            Err(ParseError::Malformed(format!("the file is truncated: {expected} bytes announced, {found} found")))
        }
        None => {
            without_mark(bytes)?;
            Err(ParseError::Malformed("the file is truncated in its header".into()))
        }
    }
}

/// Size that the header of a binary file announces.
fn announced_size(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEADER)?;
    Some(HEADER + RECORD * u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize)
}

/// Whether the file has exactly the size that its header announces as a binary file.
pub(super) fn has_exact_size(bytes: &[u8]) -> bool {
    bytes.len() > HEADER && announced_size(bytes) == Some(bytes.len())
}

fn begins_with_solid(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// Whether the file begins with a solid and shows a word that only text files have.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 12)];
    let has = |word: &[u8]| start.windows(word.len()).any(|bytes| bytes.eq_ignore_ascii_case(word));
    begins_with_solid(bytes) && (has(b"facet") || has(b"endsolid"))
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
    let mut mesh = mesh.map_err(|error| ParseError::Malformed(error.to_string()))?;
    let announced = announced_size(&bytes).unwrap_or(HEADER).min(bytes.len());
    let records = bytes[HEADER.min(announced)..announced].chunks_exact(RECORD);
    let colored = records.filter(|record| record[RECORD - 2..] != [0, 0]).count();
    if colored > 0 {
        mesh.assets.notes.push(format!("the attribute bytes of triangles are not kept (nonzero in {colored})"));
    }
    Ok(mesh)
}

/// Reads the facets of all solids, whatever their case and line ends.
fn parse_text(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let mut positions = Vec::new();
    let mut tokens = Tokens::of(bytes);
    let mut place = Place::Outside;
    while let Some(word) = tokens.next() {
        let is = |keyword: &[u8]| word.eq_ignore_ascii_case(keyword);
        match place {
            // The name of a solid may contain any word, even `vertex`.
            Place::Outside if is(b"solid") => place = Place::Name,
            Place::Outside => {}
            Place::Name if is(b"facet") => place = Place::Facet,
            Place::Name | Place::Solid if is(b"endsolid") => place = Place::Outside,
            Place::Solid if is(b"facet") => place = Place::Facet,
            Place::Name | Place::Solid => {}
            Place::Facet if is(b"vertex") => {
                let numbers = tokens.numbers::<3>().map_err(|problem| at_line(tokens.line())(problem))?;
                positions.push(DVec3::from_array(numbers));
            }
            Place::Facet if is(b"endloop") || is(b"endfacet") || is(b"endsolid") => {
                if !positions.len().is_multiple_of(3) {
                    return Err(at_line(tokens.line())(LineProblem::NotATriangle));
                }
                match () {
                    () if is(b"endfacet") => place = Place::Solid,
                    () if is(b"endsolid") => place = Place::Outside,
                    () => {}
                }
            }
            Place::Facet => {}
        }
    }
    let end = match place {
        Place::Outside => "",
        Place::Facet => "it ends inside a facet",
        Place::Name | Place::Solid => "it has no 'endsolid'",
    };
    if !end.is_empty() {
        return Err(ParseError::Malformed(format!("the file is truncated: {end}")));
    }
    let triangles = positions.as_chunks().0;
    welded(triangles.iter().copied().map(Ok), triangles.len())
}

/// Where a word of a text file is.
#[derive(Clone, Copy)]
enum Place {
    Outside,
    /// After the keyword `solid`, before its first facet.
    Name,
    Solid,
    Facet,
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
