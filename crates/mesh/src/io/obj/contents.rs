//! What an OBJ file says, in its own numbering.

use glam::{DVec2, DVec3, DVec4};
use rustc_hash::FxHashMap;

use super::corner::{NONE, check_range, next_corner};
use super::statement::split_statements;
use crate::io::text::{Words, at_line, read_numbers, text};
use crate::io::{LineProblem, ParseError};

/// Everything in the file that bears on the surface. All numbers count from zero.
#[derive(Default)]
pub(super) struct Contents {
    pub(super) positions: Vec<DVec3>,
    /// As many as there are vertices, or none.
    pub(super) colors: Vec<DVec4>,
    pub(super) uvs: Vec<DVec2>,
    pub(super) normals: Vec<DVec3>,
    /// Kinds of the faces in their order, each with how many of it follow each other.
    pub(super) runs: Vec<(FaceKind, usize)>,
    /// Vertices of the corners of all faces, one after the other.
    pub(super) corner_vertices: Vec<u32>,
    /// Texture coordinates of the corners of those faces that have them.
    pub(super) corner_uvs: Vec<u32>,
    /// Normals of the corners of those faces that have them.
    pub(super) corner_normals: Vec<u32>,
    /// Names of the materials, of which the empty one is that of faces without any.
    pub(super) materials: Vec<String>,
    pub(super) libraries: Vec<String>,
    /// How many vertices, texture coordinates and normals there must be for what the corners name.
    named: [u32; 3],
    material: u32,
    material_numbers: FxHashMap<String, u32>,
}

/// What faces may have in common.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct FaceKind {
    /// Number of corners.
    pub(super) size: usize,
    pub(super) material: u32,
    pub(super) has_uvs: bool,
    pub(super) has_normals: bool,
}

impl Contents {
    /// # Errors
    /// [`ParseError::Line`] with the first broken line; a number that is too large counts where no line is broken.
    pub(super) fn of(bytes: &[u8]) -> Result<Self, ParseError> {
        let mut contents = Self::default();
        for statement in split_statements(bytes) {
            let plain = statement.plain();
            let mut words = Words { rest: &plain };
            let read = match words.next().unwrap_or_default() {
                b"v" => contents.push_vertex(words),
                b"vt" => read_numbers::<2>(words, 1).map(|(uv, _)| contents.uvs.push(DVec2::from_array(uv))),
                b"vn" => read_numbers::<3>(words, 3).map(|(n, _)| contents.normals.push(DVec3::from_array(n))),
                b"f" => contents.push_face(words),
                b"usemtl" => {
                    contents.use_material(&name(statement.verbatim()));
                    Ok(())
                }
                b"mtllib" => {
                    contents.libraries.push(name(statement.verbatim()));
                    Ok(())
                }
                _ => Ok(()),
            };
            read.map_err(at_line(statement.line))?;
        }
        if !contents.colors.is_empty() {
            contents.colors.resize(contents.positions.len(), DVec4::ONE);
        }
        contents.check_ranges(bytes)?;
        Ok(contents)
    }

    /// Numbers of vertices, texture coordinates and normals so far.
    fn counts(&self) -> [usize; 3] {
        [self.positions.len(), self.uvs.len(), self.normals.len()]
    }

    /// A position, which a weight or a color with or without alpha may follow.
    fn push_vertex(&mut self, words: Words<'_>) -> Result<(), LineProblem> {
        let ([x, y, z, r, g, b, alpha], found) = read_numbers(words, 3)?;
        if found >= 6 {
            self.colors.resize(self.positions.len(), DVec4::ONE);
            self.colors.push(DVec4::new(r, g, b, if found == 7 { alpha } else { 1.0 }));
        }
        self.positions.push(DVec3::new(x, y, z));
        Ok(())
    }

    /// A face has texture coordinates, or normals, where all its corners do.
    fn push_face(&mut self, mut words: Words<'_>) -> Result<(), LineProblem> {
        let counts = self.counts();
        let starts = [&self.corner_vertices, &self.corner_uvs, &self.corner_normals].map(Vec::len);
        while let Some(corner @ [vertex, uv, normal]) = next_corner(&mut words, counts)? {
            for (named, number) in self.named.iter_mut().zip(corner) {
                *named = (*named).max(number.wrapping_add(1));
            }
            self.corner_vertices.push(vertex);
            if uv != NONE {
                self.corner_uvs.push(uv);
            }
            if normal != NONE {
                self.corner_normals.push(normal);
            }
        }
        let size = self.corner_vertices.len() - starts[0];
        if size < 3 {
            return Err(LineProblem::TooFewCorners(size));
        }
        let [has_uvs, has_normals] =
            [(&mut self.corner_uvs, starts[1]), (&mut self.corner_normals, starts[2])].map(|(numbers, start)| {
                let is_complete = numbers.len() - start == size;
                if !is_complete {
                    numbers.truncate(start);
                }
                is_complete
            });
        if self.materials.is_empty() {
            self.use_material("");
        }
        let kind = FaceKind { size, material: self.material, has_uvs, has_normals };
        match self.runs.last_mut() {
            Some((known, faces)) if *known == kind => *faces += 1,
            _ => self.runs.push((kind, 1)),
        }
        Ok(())
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

    /// Refuses corners that name what the file does not have. Only then are lines counted, by reading the faces again.
    fn check_ranges(&self, bytes: &[u8]) -> Result<(), ParseError> {
        let totals = self.counts();
        if self.named.iter().zip(totals).all(|(&named, total)| named as usize <= total) {
            return Ok(());
        }
        let mut counts = [0; 3];
        for statement in split_statements(bytes) {
            let plain = statement.plain();
            let mut words = Words { rest: &plain };
            match words.next().unwrap_or_default() {
                b"v" => counts[0] += 1,
                b"vt" => counts[1] += 1,
                b"vn" => counts[2] += 1,
                b"f" => {
                    while let Some(corner) = next_corner(&mut words, counts).map_err(at_line(statement.line))? {
                        check_range(corner, totals).map_err(at_line(statement.line))?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// What follows the first word.
fn name(statement: &[u8]) -> String {
    let mut words = Words { rest: statement };
    words.next();
    text(words.rest)
}
