//! The vertices of a PLY file.

use glam::{DVec2, DVec3, DVec4, Vec2, Vec3};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Header, PropertyAccess, PropertyAccessResult};

use super::body::{Body, problem};
use super::header::{coordinates, has_numbers};
use crate::huge_pages::in_huge_pages;
use crate::io::ParseError;

/// Vertices by attribute. An attribute that the file lacks is empty.
#[derive(Default)]
pub(super) struct Vertices {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) colors: Vec<DVec4>,
}

impl Vertices {
    pub(super) fn read(body: &mut Body<'_>, element: &ElementDef) -> Result<Self, ParseError> {
        coordinates(element)?;
        let has_normals = has_numbers(element, &[&["nx"], &["ny"], &["nz"]]);
        let has_uvs = has_numbers(element, &[&["s", "u", "texture_u"], &["t", "v", "texture_v"]]);
        let reds = ["red", "r", "diffuse_red"];
        let has_colors =
            has_numbers(element, &[&reds, &["green", "g", "diffuse_green"], &["blue", "b", "diffuse_blue"]]);
        // A coordinate takes at least one byte.
        let most = element.count.min(body.rest().len() / 3);
        let mut vertices = Self { positions: in_huge_pages(Vec::with_capacity(most)), ..Self::default() };
        body.read(element, |_, vertex: Vertex| {
            vertices.positions.push(vertex.position);
            if has_normals {
                vertices.normals.push(vertex.normal.as_vec3());
            }
            if has_uvs {
                vertices.uvs.push(vertex.uv.as_vec2());
            }
            if has_colors {
                vertices.colors.push(vertex.color);
            }
            Ok(())
        })?;
        if vertices.normals.iter().all(|&normal| normal == Vec3::ZERO) {
            vertices.normals.clear();
        }
        Ok(vertices)
    }
}

/// Appends the positions of all vertices in `bytes`, which must contain nothing else.
///
/// # Errors
/// The index of the invalid vertex, counted from zero, and its defect.
pub(in crate::io) fn read_points(
    header: &Header,
    element: &ElementDef,
    bytes: &[u8],
    points: &mut Vec<DVec3>,
) -> Result<(), (usize, String)> {
    let mut reader = Reader::new(bytes);
    for part in Body::parts(element) {
        let element = ElementDef { count: part.len(), ..element.clone() };
        let read = Parser::<Vertex>::new().read_payload_for_element(&mut reader, &element, header);
        let vertices = read.map_err(|error| (reader.line() - 1, problem(&error)))?;
        points.extend(vertices.iter().map(|vertex| vertex.position));
    }
    match points.iter().position(|point| !point.is_finite()) {
        Some(bad) => Err((bad, "has a coordinate that is not a finite number".into())),
        None => Ok(()),
    }
}

/// A vertex that the library fills property by property.
struct Vertex {
    position: DVec3,
    normal: DVec3,
    uv: DVec2,
    color: DVec4,
}

impl Vertex {
    /// Sets a property; `full` is the full intensity of colors of its type.
    fn set(&mut self, name: &str, value: f64, full: f64) -> PropertyAccessResult {
        let (target, value) = match name {
            "x" => (&mut self.position.x, value),
            "y" => (&mut self.position.y, value),
            "z" => (&mut self.position.z, value),
            "nx" => (&mut self.normal.x, value),
            "ny" => (&mut self.normal.y, value),
            "nz" => (&mut self.normal.z, value),
            "s" | "u" | "texture_u" => (&mut self.uv.x, value),
            "t" | "v" | "texture_v" => (&mut self.uv.y, value),
            "red" | "r" | "diffuse_red" => (&mut self.color.x, value / full),
            "green" | "g" | "diffuse_green" => (&mut self.color.y, value / full),
            "blue" | "b" | "diffuse_blue" => (&mut self.color.z, value / full),
            "alpha" | "a" | "diffuse_alpha" => (&mut self.color.w, value / full),
            _ => return PropertyAccessResult::Ignored,
        };
        *target = value;
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self { position: DVec3::NAN, normal: DVec3::ZERO, uv: DVec2::ZERO, color: DVec4::ONE }
    }

    fn set_char(&mut self, name: &str, value: i8) -> PropertyAccessResult {
        self.set(name, value.into(), 1.0)
    }

    fn set_uchar(&mut self, name: &str, value: u8) -> PropertyAccessResult {
        self.set(name, value.into(), u8::MAX.into())
    }

    fn set_short(&mut self, name: &str, value: i16) -> PropertyAccessResult {
        self.set(name, value.into(), 1.0)
    }

    fn set_ushort(&mut self, name: &str, value: u16) -> PropertyAccessResult {
        self.set(name, value.into(), u16::MAX.into())
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
