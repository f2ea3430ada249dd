//! The lines of an OBJ file as the library gets them.

use std::io::{self, BufRead, Read};

use glam::DVec4;
use rustc_hash::FxHashMap;

use super::fault::check_face;
use super::statement::{Statement, Statements};
use crate::io::LineProblem;
use crate::io::text::{Words, push_index, read_numbers, text};

/// Bytes that are made ready at a time.
const BUFFER: usize = 1 << 15;

/// The statements `v`, `vt`, `vn` and `f` in the order of the file, a line each, without comments; the others are of no
/// concern to the library, or taken for something else by it.
///
/// It numbers the vertices of every object anew, in the order of their use, and tells no more about them than their
/// position and color. So each vertex has its number in the file for a color.
pub(super) struct Lines<'a> {
    statements: Statements<'a>,
    buffer: Vec<u8>,
    /// Bytes of the buffer that the library has.
    consumed: usize,
    object_size: usize,
    faces_of_object: usize,
    pub(super) kept: Kept,
}

/// What the library has no place for.
#[derive(Default)]
pub(super) struct Kept {
    /// Numbers of vertices, texture coordinates and normals.
    pub(super) counts: [usize; 3],
    /// As many as there are vertices, or none.
    pub(super) colors: Vec<DVec4>,
    /// Kinds of the faces in their order, each with how many of it follow each other.
    pub(super) runs: Vec<(FaceKind, usize)>,
    /// Names of the materials, of which the empty one is that of faces without any.
    pub(super) materials: Vec<String>,
    pub(super) libraries: Vec<String>,
    /// True where corners of a face name different kinds of attributes, to the rest of which the library pays no heed.
    pub(super) has_uneven_faces: bool,
    material: u32,
    material_numbers: FxHashMap<String, u32>,
}

/// What faces may have in common.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct FaceKind {
    pub(super) material: u32,
    /// Whether all corners have texture coordinates.
    pub(super) has_uvs: bool,
    pub(super) has_normals: bool,
}

impl<'a> Lines<'a> {
    /// Those of a file, with a new object after every `object_size` faces.
    pub(super) fn new(bytes: &'a [u8], object_size: usize) -> Self {
        let statements = Statements::of(bytes);
        let buffer = Vec::with_capacity(2 * BUFFER);
        Self { statements, buffer, consumed: 0, object_size, faces_of_object: 0, kept: Kept::default() }
    }

    fn push(&mut self, statement: &Statement<'_>) -> Result<(), LineProblem> {
        let plain = statement.plain();
        let mut words = Words { rest: &plain };
        match words.next().unwrap_or_default() {
            b"v" => self.push_vertex(&plain)?,
            b"vt" => {
                self.kept.counts[1] += 1;
                // The library wants two numbers where one will do, and passes over a third.
                self.push_line(&plain, b" 0\n");
            }
            b"vn" => {
                self.kept.counts[2] += 1;
                self.push_line(&plain, b"\n");
            }
            b"f" => {
                self.kept.push_face(words)?;
                if self.faces_of_object == self.object_size {
                    self.faces_of_object = 0;
                    self.buffer.extend_from_slice(b"o\n");
                }
                self.faces_of_object += 1;
                self.push_line(&plain, b"\n");
            }
            b"usemtl" => self.kept.use_material(&name(statement)),
            b"mtllib" => self.kept.libraries.push(name(statement)),
            _ => {}
        }
        Ok(())
    }

    fn push_vertex(&mut self, statement: &[u8]) -> Result<(), LineProblem> {
        let (position, color) = split_vertex(statement)?;
        self.buffer.extend_from_slice(position);
        self.buffer.push(b' ');
        push_index(&mut self.buffer, self.kept.counts[0] as u32);
        self.buffer.extend_from_slice(b" 0 0\n");
        self.kept.push_color(color)?;
        self.kept.counts[0] += 1;
        Ok(())
    }

    fn push_line(&mut self, statement: &[u8], end: &[u8]) {
        self.buffer.extend_from_slice(statement);
        self.buffer.extend_from_slice(end);
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.consumed == self.buffer.len() {
            self.buffer.clear();
            self.consumed = 0;
            while self.buffer.len() < BUFFER
                && let Some(statement) = self.statements.next()
            {
                self.push(&statement).map_err(io::Error::other)?;
            }
        }
        Ok(&self.buffer[self.consumed..])
    }

    fn consume(&mut self, amount: usize) {
        self.consumed += amount;
    }
}

impl Read for Lines<'_> {
    fn read(&mut self, target: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(target)?;
        self.consume(read);
        Ok(read)
    }
}

impl Kept {
    /// The color after a position, with or without alpha; one number there is a weight.
    fn push_color(&mut self, words: &[u8]) -> Result<(), LineProblem> {
        if let ([r, g, b, alpha], found @ 3..) = read_numbers(Words { rest: words }, 0)? {
            self.colors.resize(self.counts[0], DVec4::ONE);
            self.colors.push(DVec4::new(r, g, b, if found == 4 { alpha } else { 1.0 }));
        }
        Ok(())
    }

    fn push_face(&mut self, words: Words<'_>) -> Result<(), LineProblem> {
        if self.materials.is_empty() {
            self.use_material("");
        }
        let attributes = if memchr::memchr(b'/', words.rest).is_some() { Attributes::of(words.rest) } else { NONE };
        if attributes.are_unusual {
            // Whatever is named may come later in the file.
            check_face(words, self.counts, [usize::MAX; 3])?;
        }
        let Attributes { has_uvs, has_normals, is_uneven, .. } = attributes;
        self.has_uneven_faces |= is_uneven;
        let kind = FaceKind { material: self.material, has_uvs, has_normals };
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
}

/// What the corners of a face name beside vertices.
struct Attributes {
    has_uvs: bool,
    has_normals: bool,
    is_uneven: bool,
    /// True for indices on which the library's arithmetic may overflow (negative or very long ones), and for zero, which it
    /// takes for none.
    are_unusual: bool,
}

const NONE: Attributes = Attributes { has_uvs: false, has_normals: false, is_uneven: false, are_unusual: false };

/// Digits of the largest index that there can be.
const MOST_DIGITS: usize = 10;

impl Attributes {
    fn of(corners: &[u8]) -> Self {
        // How many corners have each of the three indices.
        let mut found = [0_usize; 3];
        let (mut field, mut digits) = (0, 0);
        let mut are_unusual = false;
        for &byte in corners {
            match byte {
                b'0'..=b'9' => {
                    if digits == 0 {
                        found[field] += 1;
                        are_unusual |= byte == b'0';
                    }
                    digits += 1;
                    are_unusual |= digits > MOST_DIGITS;
                }
                b'/' => {
                    field = (field + 1) % 3;
                    are_unusual |= field == 0;
                    digits = 0;
                }
                b' ' => (field, digits) = (0, 0),
                _ => {
                    are_unusual |= byte == b'-';
                    (field, digits) = (0, 0);
                }
            }
        }
        let [vertices, uvs, normals] = found;
        let [has_uvs, has_normals] = [uvs, normals].map(|found| found == vertices);
        Self { has_uvs, has_normals, is_uneven: (!has_uvs && uvs > 0) || (!has_normals && normals > 0), are_unusual }
    }
}

/// A vertex up to its third number, and what comes after it.
pub(super) fn split_vertex(statement: &[u8]) -> Result<(&[u8], &[u8]), LineProblem> {
    // The usual vertex has three spaces, and needs no closer look at its words.
    if statement.iter().filter(|&&byte| byte <= b' ').count() == 3 {
        return Ok((statement, &[]));
    }
    let mut words = Words { rest: statement };
    match words.by_ref().take(4).count() {
        4 => Ok(statement.split_at(statement.len() - words.rest.len())),
        found => Err(LineProblem::TooFewNumbers { expected: 3, found: found - 1 }),
    }
}

/// What follows the first word, which may hold the sign of a comment.
fn name(statement: &Statement<'_>) -> String {
    let mut words = Words { rest: statement.verbatim() };
    words.next();
    text(words.rest)
}
