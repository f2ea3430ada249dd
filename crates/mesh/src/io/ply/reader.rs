//! Reading PLY.

use ply_rs_bw::ply::{Encoding, Header, PropertyAccess};

use super::body::Body;
use super::face::Triangles;
use super::header::parse_header;
use super::lines::one_element_per_line;
use super::vertex::Vertices;
use crate::io::ParseError;
use crate::io::text::{decode, without_mark};
use crate::{CornerAttributes, TriMesh, VertexAttributes};

/// Reads PLY of any encoding. Elements other than vertices, faces and strips are skipped.
pub(in crate::io) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let bytes = without_mark(bytes)?;
    let (header, length, lines) = parse_header(bytes)?;
    if header.encoding != Encoding::Ascii {
        return parse_body(&header, Body::new(&header, &bytes[length..], lines));
    }
    let text = decode(&bytes[length..])?;
    parse_body(&header, Body::new(&header, &text, lines)).or_else(|error| {
        // Only then are the words counted, which takes longer.
        let lines = one_element_per_line(&header, &text).ok_or_else(|| error.clone())?;
        match parse_body(&header, Body::new(&header, &lines, 0)) {
            Ok(mesh) if mesh.positions.iter().all(|position| position.is_finite()) => Ok(mesh),
            // The first error names the line.
            _ => Err(error),
        }
    })
}

fn parse_body(header: &Header, mut body: Body<'_>) -> Result<TriMesh, ParseError> {
    let (mut vertices, mut faces, mut strips) = (None, None, None);
    for (index, element) in header.elements.values().enumerate() {
        // An element without properties has no data, however many are announced.
        if element.properties.is_empty() {
            continue;
        }
        match element.name.as_str() {
            "vertex" => vertices = Some(Vertices::read(&mut body, element)?),
            "face" => {
                faces = Some((body.copy(), element));
                // Faces may come before the vertices that they need, so they are skipped here and
                // read last.
                if vertices.is_none() || index + 1 < header.elements.len() {
                    body.read(element, |_, Ignored| Ok(()))?;
                }
            }
            "tristrips" => {
                strips = Some((body.copy(), element));
                body.read(element, |_, Ignored| Ok(()))?;
            }
            _ => body.read(element, |_, Ignored| Ok(()))?,
        }
    }
    let vertices = vertices.unwrap_or_default();
    let mut triangles = match faces {
        Some((mut body, element)) => Triangles::read(&mut body, element, &vertices)?,
        None => Triangles::default(),
    };
    if let Some((mut body, element)) = strips {
        triangles.read_strips(&mut body, element, &vertices)?;
    }
    let dropped = triangles.dropped;
    let uvs = if triangles.uvs.is_empty() { Vec::new() } else { vec![triangles.uvs] };
    let mesh = TriMesh {
        positions: vertices.positions,
        triangles: triangles.vertices,
        corner: CornerAttributes { uvs, normals: triangles.normals, colors: triangles.colors },
        vertex: VertexAttributes { colors: vertices.colors, skin: Vec::new() },
        ..TriMesh::default()
    };
    let mut mesh = mesh.welded_at_boundary();
    dropped.note(&mut mesh);
    Ok(mesh)
}

/// An element that is skipped.
struct Ignored;

impl PropertyAccess for Ignored {
    fn new() -> Self {
        Self
    }
}
