//! Reading PLY.

use glam::{DVec2, DVec3, DVec4};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{PropertyAccess, PropertyAccessResult};

use crate::TriMesh;
use crate::io::ParseError;
use crate::io::polygon::triangulate;

/// Reads PLY of any encoding. Elements other than vertices and faces are passed over.
pub(in crate::io) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let mut reader = Reader::new(bytes);
    let vertex_parser = Parser::<Vertex>::new();
    let header = vertex_parser.read_header(&mut reader).map_err(one_line)?;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    let mut has_colors = false;
    for element in header.elements.values() {
        // Without properties there is nothing to read, however many are announced.
        if element.properties.is_empty() {
            continue;
        }
        match element.name.as_str() {
            "vertex" => {
                has_colors = ["red", "r", "diffuse_red"].iter().any(|&name| element.properties.contains_key(name));
                vertices = vertex_parser.read_payload_for_element(&mut reader, element, &header).map_err(one_line)?;
            }
            "face" => {
                faces =
                    Parser::<Face>::new().read_payload_for_element(&mut reader, element, &header).map_err(one_line)?;
            }
            _ => {
                Parser::<Ignored>::new().read_payload_for_element(&mut reader, element, &header).map_err(one_line)?;
            }
        }
    }
    Ok(assemble(&vertices, &faces, has_colors)?.welded_at_boundary())
}

/// The library's errors span several lines, of which the first names the line of the file and the second shows it; the
/// others speak of its grammar.
fn one_line(error: ply_rs_bw::parser::ParseError) -> ParseError {
    let message = error.to_string();
    let telling: Vec<_> = message.lines().take(2).flat_map(str::split_whitespace).collect();
    ParseError::Malformed(telling.join(" "))
}

fn assemble(vertices: &[Vertex], faces: &[Face], has_colors: bool) -> Result<TriMesh, ParseError> {
    let mut mesh = TriMesh { positions: vertices.iter().map(|v| v.position).collect(), ..TriMesh::default() };
    if has_colors {
        mesh.vertex.colors = vertices.iter().map(|v| v.color).collect();
    }
    let has_vertex_uvs = vertices.iter().any(|v| v.uv.is_some());
    let has_vertex_normals = vertices.iter().any(|v| v.normal != DVec3::ZERO);
    let has_uvs = has_vertex_uvs || faces.iter().any(|face| !face.uvs.is_empty());
    let has_normals = has_vertex_normals || faces.iter().any(|face| !face.normals.is_empty());
    let has_corner_colors = faces.iter().any(|face| !face.colors.is_empty());

    let mut uvs = Vec::new();
    let mut polygon = Vec::new();
    for (number, face) in faces.iter().enumerate() {
        polygon.clear();
        for &index in &face.vertices {
            let vertex = usize::try_from(index).ok().and_then(|index| vertices.get(index));
            let out_of_range = ParseError::IndexOutOfRange { face: number, index, vertices: vertices.len() };
            polygon.push(vertex.ok_or(out_of_range)?.position);
        }
        if polygon.len() < 3 {
            return Err(ParseError::Malformed(format!("face {number} has fewer than three corners")));
        }
        let size = polygon.len();
        triangulate(&polygon, |triangle| {
            let vertex = |corner: usize| &vertices[face.vertices[corner] as usize];
            mesh.triangles.push(triangle.map(|corner| face.vertices[corner] as u32));
            // A list of the face counts where it is complete, the vertex otherwise.
            if has_uvs {
                uvs.push(triangle.map(|corner| match face.uvs.len() == 2 * size {
                    true => DVec2::from_slice(&face.uvs[2 * corner..]),
                    false => vertex(corner).uv.unwrap_or_default(),
                }));
            }
            if has_normals {
                mesh.corner.normals.push(triangle.map(|corner| match face.normals.len() == 3 * size {
                    true => DVec3::from_slice(&face.normals[3 * corner..]),
                    false => vertex(corner).normal,
                }));
            }
            if has_corner_colors {
                mesh.corner.colors.push(triangle.map(|corner| {
                    let components = face.colors.len() / size;
                    match face.colors.get(components * corner..components * (corner + 1)) {
                        Some(&[r, g, b, a]) => DVec4::new(r, g, b, a),
                        Some(&[r, g, b]) => DVec4::new(r, g, b, 1.0),
                        _ => vertex(corner).color,
                    }
                }));
            }
        });
    }
    if has_uvs {
        mesh.corner.uvs.push(uvs);
    }
    Ok(mesh)
}

struct Vertex {
    position: DVec3,
    normal: DVec3,
    uv: Option<DVec2>,
    color: DVec4,
}

impl Vertex {
    /// Sets a property; `full` is what stands for full intensity in colors of its type.
    fn set(&mut self, name: &str, value: f64, full: f64) -> PropertyAccessResult {
        let target = match name {
            "x" => &mut self.position.x,
            "y" => &mut self.position.y,
            "z" => &mut self.position.z,
            "nx" => &mut self.normal.x,
            "ny" => &mut self.normal.y,
            "nz" => &mut self.normal.z,
            "s" | "u" | "texture_u" => &mut self.uv.get_or_insert_default().x,
            "t" | "v" | "texture_v" => &mut self.uv.get_or_insert_default().y,
            "red" | "r" | "diffuse_red" => return self.set_color(0, value / full),
            "green" | "g" | "diffuse_green" => return self.set_color(1, value / full),
            "blue" | "b" | "diffuse_blue" => return self.set_color(2, value / full),
            "alpha" | "a" | "diffuse_alpha" => return self.set_color(3, value / full),
            _ => return PropertyAccessResult::Ignored,
        };
        *target = value;
        PropertyAccessResult::Set
    }

    fn set_color(&mut self, component: usize, value: f64) -> PropertyAccessResult {
        self.color[component] = value;
        PropertyAccessResult::Set
    }
}

/// What stands for full intensity in colors of unsigned bytes.
const FULL_BYTE: f64 = 255.0;

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self { position: DVec3::NAN, normal: DVec3::ZERO, uv: None, color: DVec4::ONE }
    }

    fn set_char(&mut self, name: &str, value: i8) -> PropertyAccessResult {
        self.set(name, value.into(), 1.0)
    }

    fn set_uchar(&mut self, name: &str, value: u8) -> PropertyAccessResult {
        self.set(name, value.into(), FULL_BYTE)
    }

    fn set_short(&mut self, name: &str, value: i16) -> PropertyAccessResult {
        self.set(name, value.into(), 1.0)
    }

    fn set_ushort(&mut self, name: &str, value: u16) -> PropertyAccessResult {
        self.set(name, value.into(), f64::from(u16::MAX))
    }

    fn set_int(&mut self, name: &str, value: i32) -> PropertyAccessResult {
        self.set(name, value.into(), 1.0)
    }

    fn set_uint(&mut self, name: &str, value: u32) -> PropertyAccessResult {
        self.set(name, value.into(), 1.0)
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set(name, value.into(), 1.0)
    }

    fn set_double(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        self.set(name, value, 1.0)
    }
}

#[derive(Default)]
struct Face {
    vertices: Vec<i64>,
    uvs: Vec<f64>,
    normals: Vec<f64>,
    colors: Vec<f64>,
}

impl Face {
    fn set_indices<T: Into<i64>>(&mut self, name: &str, list: Vec<T>) -> PropertyAccessResult {
        match name {
            "vertex_indices" | "vertex_index" => {
                self.vertices = list.into_iter().map(Into::into).collect();
                PropertyAccessResult::Set
            }
            _ => PropertyAccessResult::Ignored,
        }
    }

    fn set_numbers<T: Into<f64>>(&mut self, name: &str, list: Vec<T>) -> PropertyAccessResult {
        let target = match name {
            "texcoord" => &mut self.uvs,
            "normal" => &mut self.normals,
            "color" => &mut self.colors,
            _ => return PropertyAccessResult::Ignored,
        };
        *target = list.into_iter().map(Into::into).collect();
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_list_char(&mut self, name: &str, list: Vec<i8>) -> PropertyAccessResult {
        self.set_indices(name, list)
    }

    fn set_list_uchar(&mut self, name: &str, list: Vec<u8>) -> PropertyAccessResult {
        match name {
            "color" => self.set_numbers(name, list.into_iter().map(|value| f64::from(value) / FULL_BYTE).collect()),
            _ => self.set_indices(name, list),
        }
    }

    fn set_list_short(&mut self, name: &str, list: Vec<i16>) -> PropertyAccessResult {
        self.set_indices(name, list)
    }

    fn set_list_ushort(&mut self, name: &str, list: Vec<u16>) -> PropertyAccessResult {
        self.set_indices(name, list)
    }

    fn set_list_int(&mut self, name: &str, list: Vec<i32>) -> PropertyAccessResult {
        self.set_indices(name, list)
    }

    fn set_list_uint(&mut self, name: &str, list: Vec<u32>) -> PropertyAccessResult {
        self.set_indices(name, list)
    }

    fn set_list_float(&mut self, name: &str, list: Vec<f32>) -> PropertyAccessResult {
        self.set_numbers(name, list)
    }

    fn set_list_double(&mut self, name: &str, list: Vec<f64>) -> PropertyAccessResult {
        self.set_numbers(name, list)
    }
}

/// An element that is read past.
struct Ignored;

impl PropertyAccess for Ignored {
    fn new() -> Self {
        Self
    }
}
