//! Reading PLY.

use ply_rs_bw::ply::PropertyAccess;

use super::body::Body;
use super::face::Triangles;
use super::header::parse_header;
use super::vertex::Vertices;
use crate::io::ParseError;
use crate::{CornerAttributes, TriMesh, VertexAttributes};

/// Reads PLY of any encoding. Elements other than vertices and faces are skipped.
pub(in crate::io) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let (header, length, lines) = parse_header(bytes)?;
    let mut body = Body::new(&header, &bytes[length..], lines);
    let (mut vertices, mut faces) = (None, None);
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
            _ => body.read(element, |_, Ignored| Ok(()))?,
        }
    }
    let vertices = vertices.unwrap_or_default();
    let triangles = match faces {
        Some((mut body, element)) => Triangles::read(&mut body, element, &vertices)?,
        None => Triangles::default(),
    };
    let uvs = if triangles.uvs.is_empty() { Vec::new() } else { vec![triangles.uvs] };
    let mesh = TriMesh {
        positions: vertices.positions,
        triangles: triangles.vertices,
        corner: CornerAttributes { uvs, normals: triangles.normals, colors: triangles.colors },
        vertex: VertexAttributes { colors: vertices.colors, skin: Vec::new() },
        ..TriMesh::default()
    };
    Ok(mesh.welded_at_boundary())
}

/// An element that is skipped.
struct Ignored;

impl PropertyAccess for Ignored {
    fn new() -> Self {
        Self
    }
}
