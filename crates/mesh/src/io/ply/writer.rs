//! Writing PLY.

use std::io::{self, Write};

use glam::{DVec4, Vec2, Vec3};

use crate::TriMesh;
use crate::io::text::{FLUSH_AT, flush};

/// Writes binary little-endian PLY with positions as doubles, and normals and texture coordinates
/// as floats. Colors are bytes if that is exact, otherwise floats, otherwise doubles.
///
/// Only the first UV set is written. The format cannot store skin, materials and textures.
pub(in crate::io) fn write(mesh: &TriMesh, writer: &mut dyn Write) -> io::Result<()> {
    let records = Records::of(mesh);
    writer.write_all(records.header().as_bytes())?;
    let mut bytes = Vec::with_capacity(FLUSH_AT + 1024);
    for vertex in 0..mesh.positions.len() {
        records.push_vertex(vertex, &mut bytes);
        flush(&mut bytes, writer, FLUSH_AT)?;
    }
    for triangle in 0..mesh.triangles.len() {
        records.push_face(triangle, &mut bytes);
        flush(&mut bytes, writer, FLUSH_AT)?;
    }
    flush(&mut bytes, writer, 0)
}

/// The records of vertices and faces, with the element that stores each attribute.
struct Records<'a> {
    mesh: &'a TriMesh,
    /// Attributes of the vertices, if all corners at each vertex agree.
    vertex_uvs: Option<Vec<Vec2>>,
    vertex_normals: Option<Vec<Vec3>>,
    /// Attributes of the corners otherwise, as lists of the faces.
    uv_lists: &'a [[Vec2; 3]],
    normal_lists: &'a [[Vec3; 3]],
    vertex_color_depth: Depth,
    corner_color_depth: Depth,
}

impl<'a> Records<'a> {
    fn of(mesh: &'a TriMesh) -> Self {
        let uvs = mesh.corner.uvs.first().map_or([].as_slice(), Vec::as_slice);
        let vertex_uvs = by_vertex(mesh, uvs);
        let vertex_normals = by_vertex(mesh, &mesh.corner.normals);
        Self {
            mesh,
            uv_lists: if vertex_uvs.is_none() { uvs } else { &[] },
            normal_lists: if vertex_normals.is_none() { &mesh.corner.normals } else { &[] },
            vertex_uvs,
            vertex_normals,
            vertex_color_depth: Depth::of(mesh.vertex.colors.iter()),
            corner_color_depth: Depth::of(mesh.corner.colors.iter().flatten()),
        }
    }

    fn header(&self) -> String {
        let mesh = self.mesh;
        let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len());
        header.push_str("property double x\nproperty double y\nproperty double z\n");
        if self.vertex_normals.is_some() {
            header.push_str("property float nx\nproperty float ny\nproperty float nz\n");
        }
        if self.vertex_uvs.is_some() {
            header.push_str("property float s\nproperty float t\n");
        }
        if !mesh.vertex.colors.is_empty() {
            for name in ["red", "green", "blue", "alpha"] {
                header.push_str(&format!("property {} {name}\n", self.vertex_color_depth.name()));
            }
        }
        header.push_str(&format!("element face {}\n", mesh.triangles.len()));
        header.push_str("property list uchar uint vertex_indices\n");
        if !self.uv_lists.is_empty() {
            header.push_str("property list uchar float texcoord\n");
        }
        if !self.normal_lists.is_empty() {
            header.push_str("property list uchar float normal\n");
        }
        if !mesh.corner.colors.is_empty() {
            header.push_str(&format!("property list uchar {} color\n", self.corner_color_depth.name()));
        }
        header.push_str("end_header\n");
        header
    }

    fn push_vertex(&self, vertex: usize, bytes: &mut Vec<u8>) {
        push_doubles(bytes, self.mesh.positions[vertex].to_array());
        if let Some(normals) = &self.vertex_normals {
            push_singles(bytes, normals[vertex].to_array());
        }
        if let Some(uvs) = &self.vertex_uvs {
            push_singles(bytes, uvs[vertex].to_array());
        }
        if let Some(&color) = self.mesh.vertex.colors.get(vertex) {
            self.vertex_color_depth.push(bytes, color);
        }
    }

    /// Each list begins with its length.
    fn push_face(&self, triangle: usize, bytes: &mut Vec<u8>) {
        bytes.push(3);
        self.mesh.triangles[triangle].iter().for_each(|vertex| bytes.extend_from_slice(&vertex.to_le_bytes()));
        if let Some(uvs) = self.uv_lists.get(triangle) {
            bytes.push(6);
            uvs.iter().for_each(|uv| push_singles(bytes, uv.to_array()));
        }
        if let Some(normals) = self.normal_lists.get(triangle) {
            bytes.push(9);
            normals.iter().for_each(|normal| push_singles(bytes, normal.to_array()));
        }
        if let Some(colors) = self.mesh.corner.colors.get(triangle) {
            bytes.push(12);
            colors.iter().for_each(|&color| self.corner_color_depth.push(bytes, color));
        }
    }
}

/// Values by vertex. `None` if two corners at a vertex differ, or without values.
fn by_vertex<T: Copy + Default + PartialEq>(mesh: &TriMesh, corners: &[[T; 3]]) -> Option<Vec<T>> {
    if corners.is_empty() {
        return None;
    }
    let mut values: Vec<Option<T>> = vec![None; mesh.positions.len()];
    for (vertices, corners) in mesh.triangles.iter().zip(corners) {
        for (&vertex, &corner) in vertices.iter().zip(corners) {
            if *values[vertex as usize].get_or_insert(corner) != corner {
                return None;
            }
        }
    }
    Some(values.into_iter().map(Option::unwrap_or_default).collect())
}

fn push_doubles(records: &mut Vec<u8>, numbers: impl IntoIterator<Item = f64>) {
    numbers.into_iter().for_each(|number| records.extend_from_slice(&number.to_le_bytes()));
}

fn push_singles(records: &mut Vec<u8>, numbers: impl IntoIterator<Item = f32>) {
    numbers.into_iter().for_each(|number| records.extend_from_slice(&number.to_le_bytes()));
}

/// Number type of written colors.
#[derive(Clone, Copy, PartialEq)]
enum Depth {
    Byte,
    Float,
    Double,
}

impl Depth {
    /// The smallest type that represents all colors exactly.
    fn of<'a>(colors: impl Iterator<Item = &'a DVec4>) -> Self {
        let depth_of = |value: f64| match value {
            _ if (0.0..=1.0).contains(&value) && f64::from(byte(value)) / 255.0 == value => Self::Byte,
            _ if f64::from(value as f32) == value => Self::Float,
            _ => Self::Double,
        };
        colors.flat_map(|color| color.to_array()).fold(Self::Byte, |depth, value| match (depth, depth_of(value)) {
            (Self::Byte, other) | (other, Self::Byte) => other,
            (Self::Float, Self::Float) => Self::Float,
            _ => Self::Double,
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Byte => "uchar",
            Self::Float => "float",
            Self::Double => "double",
        }
    }

    fn push(self, records: &mut Vec<u8>, color: DVec4) {
        for value in color.to_array() {
            match self {
                Self::Byte => records.push(byte(value)),
                Self::Float => records.extend_from_slice(&(value as f32).to_le_bytes()),
                Self::Double => records.extend_from_slice(&value.to_le_bytes()),
            }
        }
    }
}

fn byte(value: f64) -> u8 {
    (value * 255.0).round() as u8
}
