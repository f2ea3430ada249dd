//! Writing OBJ.

use std::hash::Hash;
use std::io::{self, Write};

use rustc_hash::FxHashMap;

use crate::TriMesh;

/// Writes OBJ. Numbers are the shortest decimals that read back as the same doubles. Of several UV sets the first is
/// written; corner colors, skin and textures have no place in the format.
pub(in crate::io) fn write(mesh: &TriMesh, writer: &mut dyn Write) -> io::Result<()> {
    let mut out = Lines { writer, buffer: Vec::with_capacity(FLUSH_AT + 4096) };
    for library in &mesh.assets.material_libraries {
        out.buffer.extend_from_slice(format!("mtllib {library}\n").as_bytes());
    }
    for (vertex, position) in mesh.positions.iter().enumerate() {
        out.buffer.extend_from_slice(b"v");
        position.to_array().into_iter().for_each(|number| out.push_number(number));
        if let Some(color) = mesh.vertex.colors.get(vertex) {
            let shown = if color.w == 1.0 { 3 } else { 4 };
            color.to_array().into_iter().take(shown).for_each(|number| out.push_number(number));
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
            // Faces without material that come first need no name; later ones can only be told apart by one.
            if triangle > 0 || !name.is_empty() {
                let name = if name.is_empty() { "none" } else { name };
                out.buffer.extend_from_slice(format!("usemtl {name}\n").as_bytes());
            }
        }
        out.buffer.extend_from_slice(b"f");
        for (corner, vertex) in vertices.iter().enumerate() {
            out.buffer.push(b' ');
            out.push_index(vertex + 1);
            let uv = uvs.get(triangle).map(|uvs| uvs[corner]);
            let normal = normals.get(triangle).map(|normals| normals[corner]);
            if let Some(uv) = uv {
                out.buffer.push(b'/');
                out.push_index(uv);
            }
            if let Some(normal) = normal {
                out.buffer.extend_from_slice(if uv.is_some() { b"/" } else { b"//" });
                out.push_index(normal);
            }
        }
        out.end_line()?;
    }
    out.writer.write_all(&out.buffer)
}

/// Writes each distinct value once, in the order of first use, and returns the numbers of the corners, from one.
fn write_distinct<T: Copy, const N: usize>(
    out: &mut Lines<'_>,
    keyword: &str,
    corners: &[[T; 3]],
    numbers: impl Fn(T) -> [f64; N],
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
            *index = *known.entry(value.map(f64::to_bits)).or_insert(next);
            if *index == next {
                out.buffer.extend_from_slice(keyword.as_bytes());
                value.into_iter().for_each(|number| out.push_number(number));
                out.end_line()?;
            }
        }
        indices.push(triangle_indices);
    }
    Ok(indices)
}

/// Bytes gathered before they go to the writer.
const FLUSH_AT: usize = 1 << 16;

struct Lines<'a> {
    writer: &'a mut dyn Write,
    buffer: Vec<u8>,
}

impl Lines<'_> {
    fn push_number(&mut self, number: f64) {
        let mut digits = ryu::Buffer::new();
        let digits = digits.format_finite(number);
        self.buffer.push(b' ');
        self.buffer.extend_from_slice(digits.strip_suffix(".0").unwrap_or(digits).as_bytes());
    }

    fn push_index(&mut self, mut index: u32) {
        let mut digits = [0; 10];
        let mut start = digits.len();
        loop {
            start -= 1;
            digits[start] = b'0' + (index % 10) as u8;
            index /= 10;
            if index == 0 {
                break;
            }
        }
        self.buffer.extend_from_slice(&digits[start..]);
    }

    fn end_line(&mut self) -> io::Result<()> {
        self.buffer.push(b'\n');
        if self.buffer.len() >= FLUSH_AT {
            self.writer.write_all(&self.buffer)?;
            self.buffer.clear();
        }
        Ok(())
    }
}
