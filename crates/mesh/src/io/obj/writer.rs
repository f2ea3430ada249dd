//! Writing OBJ.

use std::hash::Hash;
use std::io::{self, Write};

use rustc_hash::FxHashMap;

use crate::TriMesh;
use crate::io::text::{LineWriter, Number};

/// Writes OBJ. Numbers are the shortest decimals that read back as the same numbers, normals and
/// texture coordinates in single precision. Only the first UV set is written. The format cannot
/// store corner colors, skin and textures.
pub(in crate::io) fn write(mesh: &TriMesh, writer: &mut dyn Write) -> io::Result<()> {
    let mut out = LineWriter::new(writer);
    for library in &mesh.assets.material_libraries {
        out.push_text("mtllib ");
        push_name(&mut out, mesh, library);
        out.end_line()?;
    }
    for (vertex, position) in mesh.positions.iter().enumerate() {
        out.push_text("v");
        out.push_numbers(position.to_array());
        if let Some(color) = mesh.vertex.colors.get(vertex) {
            let shown = if color.w == 1.0 { 3 } else { 4 };
            out.push_numbers(color.to_array().into_iter().take(shown));
        }
        out.end_line()?;
    }
    let uvs = match mesh.corner.uvs.first() {
        Some(uvs) => write_distinct(&mut out, "vt", uvs, |uv| uv.to_array())?,
        None => Vec::new(),
    };
    let normals = write_distinct(&mut out, "vn", &mesh.corner.normals, |normal| normal.to_array())?;

    let mut material = None;
    for (triangle, vertices) in mesh.triangles.iter().enumerate() {
        let new = mesh.triangle_materials.get(triangle).copied();
        if new != material {
            material = new;
            let name = new.and_then(|number| mesh.materials.get(number as usize)).map_or("", String::as_str);
            // Leading faces without a material need no name. Later ones need one to end the
            // previous material.
            if triangle > 0 || !name.is_empty() {
                out.push_text("usemtl ");
                push_name(&mut out, mesh, if name.is_empty() { "none" } else { name });
                out.end_line()?;
            }
        }
        out.push_text("f");
        for (corner, vertex) in vertices.iter().enumerate() {
            out.push_text(" ");
            out.push_index(vertex + 1);
            let uv = uvs.get(triangle).map(|uvs| uvs[corner]);
            let normal = normals.get(triangle).map(|normals| normals[corner]);
            if let Some(uv) = uv {
                out.push_text("/");
                out.push_index(uv);
            }
            if let Some(normal) = normal {
                out.push_text(if uv.is_some() { "/" } else { "//" });
                out.push_index(normal);
            }
        }
        out.end_line()?;
    }
    out.finish()
}

/// Appends a name in the bytes of the file that it comes from.
fn push_name(out: &mut LineWriter<'_>, mesh: &TriMesh, name: &str) {
    out.push_bytes(mesh.assets.raw_names.get(name).map_or(name.as_bytes(), Vec::as_slice));
}

/// Writes each distinct value once, in the order of first use, and returns the indices of the
/// corners, counted from one.
fn write_distinct<T: Copy, F: Number, const N: usize>(
    out: &mut LineWriter<'_>,
    keyword: &str,
    corners: &[[T; 3]],
    numbers: impl Fn(T) -> [F; N],
) -> io::Result<Vec<[u32; 3]>>
where
    [u64; N]: Hash + Eq,
{
    let mut known: FxHashMap<[u64; N], u32> = FxHashMap::default();
    let mut indices = Vec::with_capacity(corners.len());
    for triangle in corners {
        let mut triangle_indices = [0; 3];
        for (index, &corner) in triangle_indices.iter_mut().zip(triangle) {
            let value = numbers(corner);
            let next = known.len() as u32 + 1;
            *index = *known.entry(value.map(|number| number.into().to_bits())).or_insert(next);
            if *index == next {
                out.push_text(keyword);
                out.push_numbers(value);
                out.end_line()?;
            }
        }
        indices.push(triangle_indices);
    }
    Ok(indices)
}
