//! The lines of an OBJ file as the library gets them.

use std::io::{self, BufRead, Read};

use glam::DVec4;
use rustc_hash::FxHashMap;

use super::fault::check_face;
use super::statement::{Statement, Statements};
use crate::io::LineProblem;
use crate::io::text::{Words, parse_integer, read_numbers, text};

/// Bytes that are made ready at a time.
const BUFFER: usize = 1 << 15;

/// The statements `v`, `vt`, `vn` and `f` in the order of the file, a line each, without comments; the others are of no
/// concern to the library, or taken for something else by it.
///
/// It numbers the vertices of every object anew, in the order of their use, and does not tell which they were. So the corners
/// of faces are kept.
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
    /// Vertices of the corners of all faces, by their numbers in the file.
    pub(super) corners: Vec<u32>,
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
        self.push_line(position, b"\n");
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
        let start = self.corners.len();
        let [vertices, uvs, normals] = match read_usual_corners(words.rest, &mut self.corners) {
            Some(found) => found,
            None => {
                self.corners.truncate(start);
                read_corners(words, self.counts, &mut self.corners)?
            }
        };
        let [has_uvs, has_normals] = [uvs, normals].map(|found| found == vertices);
        self.has_uneven_faces |= (!has_uvs && uvs > 0) || (!has_normals && normals > 0);
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

/// Most digits of an index in a usual face: one more, and it may not fit into 32 bits.
const MOST_DIGITS: usize = 9;

/// How many corners of a face have each of the three indices, of which the vertices are added. None for faces that take a closer
/// look: other spaces, indices with a sign, of zero or very long ones, and whatever is no corner.
fn read_usual_corners(mut rest: &[u8], vertices: &mut Vec<u32>) -> Option<[usize; 3]> {
    let mut found = [0; 3];
    while let [b' ', corner @ ..] = rest {
        let vertex;
        (vertex, rest) = split_number(corner)?;
        vertices.push(vertex.checked_sub(1)?);
        found[0] += 1;
        for found in &mut found[1..] {
            let [b'/', field @ ..] = rest else { break };
            let number;
            (number, rest) = split_number(field)?;
            *found += usize::from(number > 0);
        }
    }
    rest.is_empty().then_some(found)
}

/// A number in front of other bytes, zero where there are no digits.
fn split_number(bytes: &[u8]) -> Option<(u32, &[u8])> {
    let (mut number, mut length) = (0, 0);
    while let Some(digit @ 0..=9) = bytes.get(length).map(|byte| byte.wrapping_sub(b'0')) {
        if length == MOST_DIGITS || (number == 0 && digit == 0) {
            return None;
        }
        number = 10 * number + u32::from(digit);
        length += 1;
    }
    Some((number, &bytes[length..]))
}

/// The same of any face, of whose indices negative ones count back from `counts`.
fn read_corners(words: Words<'_>, counts: [usize; 3], vertices: &mut Vec<u32>) -> Result<[usize; 3], LineProblem> {
    // Whatever is named may come later in the file. On what is refused here, the library's arithmetic may overflow.
    check_face(words.clone(), counts, [usize::MAX; 3])?;
    let mut found = [0; 3];
    for word in words {
        let indices = word.split(|&byte| byte == b'/').map(parse_integer);
        if let Some(vertex) = indices.clone().next().flatten() {
            vertices.push(if vertex < 0 { counts[0] as i64 + vertex } else { vertex - 1 } as u32);
        }
        found.iter_mut().zip(indices).for_each(|(found, index)| *found += usize::from(index.is_some()));
    }
    Ok(found)
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
