//! Reading PLY.

use super::body::Body;
use super::faces::Faces;
use super::header::Header;
use super::vertices::Vertices;
use crate::io::ParseError;
use crate::{CornerAttributes, TriMesh, VertexAttributes};

/// Reads PLY of any encoding. Elements other than vertices and faces are passed over.
pub(in crate::io) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let header = Header::parse(bytes)?;
    let mut body = Body::new(bytes, &header);
    let (mut vertices, mut faces) = (None, None);
    for element in &header.elements {
        // Without properties there is nothing to read, however many are announced.
        if element.properties.is_empty() {
            continue;
        }
        match element.name.as_str() {
            "vertex" => vertices = Some(Vertices::read(&mut body, element)?),
            "face" => {
                faces = Some((body.clone(), element));
                // Read at the end, because they may come before the vertices that they need.
                if vertices.is_none() || header.elements.last() != Some(element) {
                    body.skip_all(element)?;
                }
            }
            _ => body.skip_all(element)?,
        }
    }
    let vertices = vertices.unwrap_or_default();
    let mut corner = CornerAttributes::default();
    let mut triangles = Vec::new();
    if let Some((mut body, element)) = faces {
        let faces = Faces::read(&mut body, element, &vertices)?;
        triangles = faces.triangles;
        corner = CornerAttributes {
            uvs: if faces.uvs.is_empty() { Vec::new() } else { vec![faces.uvs] },
            normals: faces.normals,
            colors: faces.colors,
        };
    }
    let vertex = VertexAttributes { colors: vertices.colors, skin: Vec::new() };
    let mesh = TriMesh { positions: vertices.positions, triangles, corner, vertex, ..TriMesh::default() };
    Ok(mesh.welded_at_boundary())
}
