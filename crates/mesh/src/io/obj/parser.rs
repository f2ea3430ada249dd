//! Reading OBJ.

use glam::{DVec2, DVec3, DVec4};
use rustc_hash::FxHashMap;

use crate::TriMesh;
use crate::io::polygon::triangulate;
use crate::io::text::{Words, at_line, parse_integer, read_numbers, text};
use crate::io::{LineProblem, ParseError};
use crate::measure::triangle_normal;

/// Reads OBJ: `v` with optional color, `vt`, `vn`, `f`, `usemtl` and `mtllib`; other statements are passed over.
///
/// Faces may refer to vertices that come later. Vertices keep their order, used or not, except that those which the file
/// splits along seams are welded.
pub(in crate::io) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let mut obj = Obj::default();
    let mut line = 0;
    let mut rest = bytes;
    while !rest.is_empty() {
        let (statement, lines) = split_statement(&mut rest);
        obj.read_statement(statement, line + 1).map_err(at_line(line + 1))?;
        line += lines;
    }
    Ok(obj.into_mesh()?.welded_at_boundary())
}

/// Takes the next statement off `text`, with the number of lines it spans: a backslash at the end joins lines.
fn split_statement<'a>(text: &mut &'a [u8]) -> (&'a [u8], usize) {
    let (mut end, mut lines) = (0, 0);
    loop {
        lines += 1;
        end = memchr::memchr(b'\n', &text[end..]).map_or(text.len(), |offset| end + offset + 1);
        let statement = text[..end].trim_ascii_end();
        if statement.last() != Some(&b'\\') || end == text.len() {
            *text = &text[end..];
            return (statement, lines);
        }
    }
}

/// Statements as they stand in the file.
#[derive(Default)]
struct Obj {
    positions: Vec<DVec3>,
    /// As long as `positions`, or shorter where the last vertices have no color.
    colors: Vec<DVec4>,
    uvs: Vec<DVec2>,
    normals: Vec<DVec3>,
    corners: Vec<Corner>,
    faces: Vec<Face>,
    materials: Vec<String>,
    material_numbers: FxHashMap<String, u32>,
    material: u32,
    libraries: Vec<String>,
}

/// Indices from one, zero for none.
#[derive(Clone, Copy)]
struct Corner {
    position: u32,
    uv: u32,
    normal: u32,
}

struct Face {
    corners_end: usize,
    material: u32,
    line: usize,
}

impl Obj {
    fn read_statement(&mut self, statement: &[u8], line: usize) -> Result<(), LineProblem> {
        let mut words = Words { rest: statement };
        let Some(keyword) = words.next() else { return Ok(()) };
        match keyword {
            b"v" => self.read_vertex(words),
            b"vt" => {
                let (numbers, found) = read_numbers::<3>(words, 1)?;
                self.uvs.push(DVec2::new(numbers[0], if found > 1 { numbers[1] } else { 0.0 }));
                Ok(())
            }
            b"vn" => {
                let (numbers, _) = read_numbers::<3>(words, 3)?;
                self.normals.push(DVec3::from_array(numbers));
                Ok(())
            }
            b"f" => self.read_face(words, line),
            b"usemtl" => {
                self.use_material(&text(words.rest));
                Ok(())
            }
            b"mtllib" => {
                self.libraries.push(text(words.rest));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn read_vertex(&mut self, words: Words<'_>) -> Result<(), LineProblem> {
        let (numbers, found) = read_numbers::<7>(words, 3)?;
        if found >= 6 {
            self.colors.resize(self.positions.len(), DVec4::ONE);
            let alpha = if found == 7 { numbers[6] } else { 1.0 };
            self.colors.push(DVec4::new(numbers[3], numbers[4], numbers[5], alpha));
        }
        self.positions.push(DVec3::new(numbers[0], numbers[1], numbers[2]));
        Ok(())
    }

    fn read_face(&mut self, words: Words<'_>, line: usize) -> Result<(), LineProblem> {
        let start = self.corners.len();
        for word in words {
            if word[0] == b'#' {
                break;
            }
            let corner = self.read_corner(word)?;
            self.corners.push(corner);
        }
        let found = self.corners.len() - start;
        if found < 3 {
            return Err(LineProblem::TooFewCorners(found));
        }
        if self.materials.is_empty() {
            self.use_material("");
        }
        self.faces.push(Face { corners_end: self.corners.len(), material: self.material, line });
        Ok(())
    }

    fn read_corner(&self, word: &[u8]) -> Result<Corner, LineProblem> {
        let not_a_corner = || LineProblem::NotACorner(text(word));
        let mut indices = [0; 3];
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut fields = word.split(|&byte| byte == b'/');
        for ((index, count), kind) in indices.iter_mut().zip(counts).zip(KINDS) {
            match fields.next() {
                None => break,
                Some([]) if kind != KINDS[0] => {}
                Some(field) => {
                    let value = parse_integer(field).ok_or_else(not_a_corner)?;
                    let out_of_range = LineProblem::IndexOutOfRange { kind, index: value, count };
                    let absolute = if value < 0 { count as i64 + 1 + value } else { value };
                    *index = u32::try_from(absolute).ok().filter(|&index| index > 0).ok_or(out_of_range)?;
                }
            }
        }
        match fields.next() {
            Some(_) => Err(not_a_corner()),
            None => Ok(Corner { position: indices[0], uv: indices[1], normal: indices[2] }),
        }
    }

    fn use_material(&mut self, name: &str) {
        self.material = match self.material_numbers.get(name) {
            Some(&number) => number,
            None => {
                let number = self.materials.len() as u32;
                self.material_numbers.insert(name.to_owned(), number);
                self.materials.push(name.to_owned());
                number
            }
        };
    }

    fn into_mesh(mut self) -> Result<TriMesh, ParseError> {
        let mut mesh = TriMesh { positions: self.positions, ..TriMesh::default() };
        if !self.colors.is_empty() {
            self.colors.resize(mesh.positions.len(), DVec4::ONE);
            mesh.vertex.colors = self.colors;
        }
        mesh.assets.material_libraries = self.libraries;
        // Without a `usemtl` there is only the unnamed material that faces before one get.
        let has_materials = self.materials.iter().any(|name| !name.is_empty());
        if has_materials {
            mesh.materials = self.materials;
        }
        let has_uvs = self.corners.iter().any(|corner| corner.uv != 0);
        let has_normals = self.corners.iter().any(|corner| corner.normal != 0);
        let mut uvs = Vec::new();
        let mut polygon = Vec::new();
        let mut start = 0;
        mesh.triangles.reserve(self.faces.len());
        for face in &self.faces {
            let corners = &self.corners[start..face.corners_end];
            start = face.corners_end;
            for corner in corners {
                check_range(corner, [mesh.positions.len(), self.uvs.len(), self.normals.len()])
                    .map_err(at_line(face.line))?;
            }
            polygon.clear();
            polygon.extend(corners.iter().map(|corner| mesh.positions[corner.position as usize - 1]));
            triangulate(&polygon, |triangle| {
                let corners = triangle.map(|corner| corners[corner]);
                mesh.triangles.push(corners.map(|corner| corner.position - 1));
                if has_materials {
                    mesh.triangle_materials.push(face.material);
                }
                if has_uvs {
                    let uv = |corner: Corner| corner.uv.checked_sub(1).map_or(DVec2::ZERO, |uv| self.uvs[uv as usize]);
                    uvs.push(corners.map(uv));
                }
                if has_normals {
                    let flat = || triangle_normal(triangle.map(|corner| polygon[corner]));
                    mesh.corner.normals.push(corners.map(|corner| match corner.normal {
                        0 => flat(),
                        normal => self.normals[normal as usize - 1],
                    }));
                }
            });
        }
        if has_uvs {
            mesh.corner.uvs.push(uvs);
        }
        Ok(mesh)
    }
}

/// What the three indices of a corner stand for.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

fn check_range(corner: &Corner, counts: [usize; 3]) -> Result<(), LineProblem> {
    for ((index, count), kind) in [corner.position, corner.uv, corner.normal].into_iter().zip(counts).zip(KINDS) {
        if index as usize > count {
            return Err(LineProblem::IndexOutOfRange { kind, index: index.into(), count });
        }
    }
    Ok(())
}
