//! Writing PLY.

use std::io::{self, Write};

use glam::DVec4;

use crate::TriMesh;
use crate::io::text::{FLUSH_AT, flush};

/// Writes binary little-endian PLY with doubles, and normals and texture coordinates in floats, as meshes have them. Colors are bytes
/// where bytes say the same, else floats.
///
/// Of several UV sets the first is written; skin, materials and textures have no place in the format.
pub(in crate::io) fn write(mesh: &TriMesh, writer: &mut dyn Write) -> io::Result<()> {
    let uvs = mesh.corner.uvs.first().map_or([].as_slice(), Vec::as_slice);
    let normals = &mesh.corner.normals;
    let corner_colors = &mesh.corner.colors;
    let vertex_uvs = by_vertex(mesh, uvs);
    let vertex_normals = by_vertex(mesh, normals);
    let vertex_color_depth = Depth::of(mesh.vertex.colors.iter());
    let corner_color_depth = Depth::of(corner_colors.iter().flatten());

    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len());
    header.push_str("property double x\nproperty double y\nproperty double z\n");
    if vertex_normals.is_some() {
        header.push_str("property float nx\nproperty float ny\nproperty float nz\n");
    }
    if vertex_uvs.is_some() {
        header.push_str("property float s\nproperty float t\n");
    }
    if !mesh.vertex.colors.is_empty() {
        for name in ["red", "green", "blue", "alpha"] {
            header.push_str(&format!("property {} {name}\n", vertex_color_depth.name()));
        }
    }
    header.push_str(&format!("element face {}\n", mesh.triangles.len()));
    header.push_str("property list uchar uint vertex_indices\n");
    let has_uv_lists = vertex_uvs.is_none() && !uvs.is_empty();
    if has_uv_lists {
        header.push_str("property list uchar float texcoord\n");
    }
    let has_normal_lists = vertex_normals.is_none() && !normals.is_empty();
    if has_normal_lists {
        header.push_str("property list uchar float normal\n");
    }
    if !corner_colors.is_empty() {
        header.push_str(&format!("property list uchar {} color\n", corner_color_depth.name()));
    }
    header.push_str("end_header\n");
    writer.write_all(header.as_bytes())?;

    let mut records = Vec::with_capacity(FLUSH_AT + 1024);
    for (vertex, position) in mesh.positions.iter().enumerate() {
        push_doubles(&mut records, position.to_array());
        if let Some(normals) = &vertex_normals {
            push_singles(&mut records, normals[vertex].to_array());
        }
        if let Some(uvs) = &vertex_uvs {
            push_singles(&mut records, uvs[vertex].to_array());
        }
        if let Some(&color) = mesh.vertex.colors.get(vertex) {
            vertex_color_depth.push(&mut records, color);
        }
        flush(&mut records, writer, FLUSH_AT)?;
    }
    for (triangle, vertices) in mesh.triangles.iter().enumerate() {
        records.push(3);
        vertices.iter().for_each(|vertex| records.extend_from_slice(&vertex.to_le_bytes()));
        if has_uv_lists {
            records.push(6);
            uvs[triangle].iter().for_each(|uv| push_singles(&mut records, uv.to_array()));
        }
        if has_normal_lists {
            records.push(9);
            normals[triangle].iter().for_each(|normal| push_singles(&mut records, normal.to_array()));
        }
        if let Some(colors) = corner_colors.get(triangle) {
            records.push(12);
            colors.iter().for_each(|&color| corner_color_depth.push(&mut records, color));
        }
        flush(&mut records, writer, FLUSH_AT)?;
    }
    flush(&mut records, writer, 0)
}

/// Values by vertex where all corners at each vertex agree; none where there are no values.
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

/// How colors are written.
#[derive(Clone, Copy, PartialEq)]
enum Depth {
    Byte,
    Float,
    Double,
}

impl Depth {
    /// The smallest that loses nothing.
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
