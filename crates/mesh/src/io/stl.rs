//! STL, both kinds.

use std::io::{self, Write};

use glam::{DVec3, Vec3};

use super::text::{FLUSH_AT, at_line, flush, numbered_lines, read_numbers};
use super::{LineProblem, ParseError};
use crate::TriMesh;
use crate::measure::triangle_normal;
use crate::position_table::PositionTable;

/// Bytes before the triangles of a binary file: a free text and their number.
const HEADER: usize = 84;
/// Bytes of a triangle of a binary file: normal, corners and two bytes of attributes.
const RECORD: usize = 50;

/// Reads STL. Equal positions become one vertex; coordinates of text files keep their double precision.
pub(super) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let count =
        bytes.get(80..HEADER).map(|count| u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize);
    let expected = count.map(|count| HEADER + RECORD * count);
    // The size decides, because the header of a binary file may say anything; that of a text file is its first word.
    match expected {
        Some(expected) if expected == bytes.len() => Ok(parse_binary(&bytes[HEADER..])),
        _ if bytes.trim_ascii_start().starts_with(b"solid") => parse_text(bytes),
        Some(expected) if expected < bytes.len() => Ok(parse_binary(&bytes[HEADER..expected])),
        Some(expected) => Err(ParseError::Malformed(format!(
            "the file is truncated: {expected} bytes announced, {} found",
            bytes.len()
        ))),
        None => Err(ParseError::Malformed("the file is truncated in its header".into())),
    }
}

fn parse_binary(bytes: &[u8]) -> TriMesh {
    let records = bytes.as_chunks::<RECORD>().0;
    let coordinate = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let corner = |bytes: &[u8]| Vec3::from_array([0, 4, 8].map(|at| coordinate(&bytes[at..]))).as_dvec3();
    welded(records.iter().map(|record| [12, 24, 36].map(|at| corner(&record[at..]))), records.len())
}

/// Corners of all facets of all solids. Only `vertex` and the ends of loops matter.
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
        (triangles, []) => Ok(welded(triangles.iter().copied(), triangles.len())),
        _ => Err(at_line(last_line)(LineProblem::NotATriangle)),
    }
}

/// Equal positions become one vertex; triangles that lose a side by it are left out.
fn welded(triangles: impl Iterator<Item = [DVec3; 3]>, count: usize) -> TriMesh {
    // A closed surface has half as many vertices as triangles, or little less.
    let mut table = PositionTable::with_capacity(count / 2);
    let mut mesh = TriMesh::new(Vec::with_capacity(count / 2), Vec::with_capacity(count));
    for corners in triangles {
        let [a, b, c] = corners.map(|position| {
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
    mesh
}

/// Writes binary STL. The facet normals are those of the triangles as rounded.
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
