//! The faces of a PLY file.

use glam::{DVec2, DVec3, DVec4};

use super::body::Body;
use super::header::{Element, Property};
use super::number::{ByteOrder, Number};
use super::vertices::Vertices;
use crate::io::ParseError;
use crate::io::by_corner::by_corner;
use crate::io::polygon::triangulate;

/// Lists of a face that bear on the mesh, by the names of their properties.
const LISTS: [&[&str]; 4] = [&["vertex_indices", "vertex_index"], &["texcoord"], &["normal"], &["color"]];

/// Triangles in the making.
pub(super) struct Faces<'v> {
    vertices: &'v Vertices,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) uvs: Vec<[DVec2; 3]>,
    pub(super) normals: Vec<[DVec3; 3]>,
    pub(super) colors: Vec<[DVec4; 3]>,
    polygon: Vec<DVec3>,
}

impl<'v> Faces<'v> {
    pub(super) fn read<'a>(
        body: &mut Body<'a>,
        element: &'a Element,
        vertices: &'v Vertices,
    ) -> Result<Self, ParseError> {
        let mut faces = Self {
            vertices,
            triangles: Vec::new(),
            uvs: Vec::new(),
            normals: Vec::new(),
            colors: Vec::new(),
            polygon: Vec::new(),
        };
        let list_of = |property: &Property| {
            LISTS.iter().position(|names| property.length.is_some() && names.contains(&property.name.as_str()))
        };
        let lists: Vec<_> = element.properties.iter().map(list_of).collect();
        let mut values: [Vec<f64>; 4] = Default::default();
        for face in faces.read_plain_triangles(body, element)..element.count {
            body.begin(element, face)?;
            values.iter_mut().for_each(Vec::clear);
            for (property, list) in element.properties.iter().zip(&lists) {
                match (list, property.length) {
                    (&Some(list), Some(length)) => {
                        for _ in 0..body.length(length)? {
                            values[list].push(body.number(property.number)?);
                        }
                        let is_color = list == 3;
                        let full = if is_color { property.number.full_intensity() } else { 1.0 };
                        values[list].iter_mut().for_each(|value| *value /= full);
                    }
                    _ => body.skip(property)?,
                }
            }
            body.end();
            faces.push(face, &values)?;
        }
        Ok(faces)
    }

    /// Reads triangles for as long as they are as nearly all files have them, and returns how many there were: binary, little
    /// endian, nothing but a list of three 32-bit indices in range.
    fn read_plain_triangles(&mut self, body: &mut Body<'_>, element: &Element) -> usize {
        let [Property { name, length: Some(Number::U8), number: Number::I32 | Number::U32 }] = &element.properties[..]
        else {
            return 0;
        };
        if body.order != Some(ByteOrder::Little) || !LISTS[0].contains(&name.as_str()) {
            return 0;
        }
        let count = self.vertices.positions.len();
        let (records, _) = body.rest.as_chunks::<13>();
        self.triangles.reserve_exact(records.len().min(element.count));
        for record in records.iter().take(element.count) {
            let triangle = [1, 5, 9].map(|at| u32::from_le_bytes(ByteOrder::Little.little(&record[at..])));
            if record[0] != 3 || triangle.iter().any(|&vertex| vertex as usize >= count) {
                break;
            }
            self.triangles.push(triangle);
        }
        body.rest = &body.rest[13 * self.triangles.len()..];
        self.uvs = by_corner(&self.triangles, &self.vertices.uvs);
        self.normals = by_corner(&self.triangles, &self.vertices.normals);
        self.triangles.len()
    }

    /// Adds a polygon. A list of its own counts where it is complete, the attribute of its vertices otherwise.
    fn push(&mut self, face: usize, [corners, uvs, normals, colors]: &[Vec<f64>; 4]) -> Result<(), ParseError> {
        let vertices = self.vertices;
        let size = corners.len();
        self.polygon.clear();
        for &corner in corners {
            let index = corner as i64;
            let position = usize::try_from(index).ok().and_then(|index| vertices.positions.get(index));
            let out_of_range = ParseError::IndexOutOfRange { face, index, vertices: vertices.positions.len() };
            self.polygon.push(*position.ok_or(out_of_range)?);
        }
        if size < 3 {
            return Err(ParseError::Malformed(format!("face {face} has fewer than three corners")));
        }
        let missing = self.triangles.len();
        let polygon = std::mem::take(&mut self.polygon);
        triangulate(&polygon, |triangle| {
            let vertex = |corner: usize| corners[corner] as usize;
            self.triangles.push(triangle.map(|corner| corners[corner] as u32));
            if !uvs.is_empty() || !vertices.uvs.is_empty() || !self.uvs.is_empty() {
                self.uvs.resize(self.uvs.len().max(missing), Default::default());
                self.uvs.push(triangle.map(|corner| match uvs.len() == 2 * size {
                    true => DVec2::from_slice(&uvs[2 * corner..]),
                    false => vertices.uvs.get(vertex(corner)).copied().unwrap_or_default(),
                }));
            }
            if !normals.is_empty() || !vertices.normals.is_empty() || !self.normals.is_empty() {
                self.normals.resize(self.normals.len().max(missing), Default::default());
                self.normals.push(triangle.map(|corner| match normals.len() == 3 * size {
                    true => DVec3::from_slice(&normals[3 * corner..]),
                    false => vertices.normals.get(vertex(corner)).copied().unwrap_or_default(),
                }));
            }
            if !colors.is_empty() || !self.colors.is_empty() {
                let of_vertex = |vertex: usize| vertices.colors.get(vertex).copied().unwrap_or(DVec4::ONE);
                while self.colors.len() < missing {
                    let earlier = self.triangles[self.colors.len()];
                    self.colors.push(earlier.map(|vertex| of_vertex(vertex as usize)));
                }
                let components = colors.len() / size;
                self.colors.push(triangle.map(
                    |corner| match colors.get(components * corner..components * (corner + 1)) {
                        Some(&[r, g, b, a]) => DVec4::new(r, g, b, a),
                        Some(&[r, g, b]) => DVec4::new(r, g, b, 1.0),
                        _ => of_vertex(vertex(corner)),
                    },
                ));
            }
        });
        self.polygon = polygon;
        Ok(())
    }
}
