//! The lines of an OBJ file as passed to the library.

use std::collections::BTreeMap;
use std::io::{self, BufRead, Read};

use glam::DVec4;
use rustc_hash::FxHashMap;

use super::fault::check_face;
use super::statement::{Statement, Statements};
use crate::io::LineProblem;
use crate::io::element::{Dropped, distinct_corners, has_repeated_corner};
use crate::io::text::{Words, is_non_finite, parse_integer, read_values};

/// Bytes that are prepared at a time.
const BUFFER: usize = 1 << 15;

/// The statements `v`, `vt`, `vn` and `f` in the order of the file, one per line, without comments.
/// The library does not need the others, or misinterprets them.
///
/// The library renumbers the vertices of every object in the order of their use and drops the
/// original indices. Therefore `kept` stores the corners of all faces.
pub(super) struct Lines<'a> {
    statements: Statements<'a>,
    buffer: Vec<u8>,
    /// Bytes of the buffer that the library has consumed.
    consumed: usize,
    object_size: usize,
    faces_of_object: usize,
    /// Whether numbers of `vt` and `vn` that the library cannot parse are replaced by `nan`.
    is_tolerant: bool,
    pub(super) kept: Kept,
}

/// The contents of the file that the library drops.
#[derive(Default)]
pub(super) struct Kept {
    /// Numbers of vertices, texture coordinates and normals.
    pub(super) counts: [usize; 3],
    /// Vertices of the corners of all faces, as indices of the file.
    pub(super) corners: Vec<u32>,
    /// One color per vertex, or empty.
    pub(super) colors: Vec<DVec4>,
    /// Runs of faces of the same kind, each with its length.
    pub(super) runs: Vec<(FaceKind, usize)>,
    /// Names of the materials. Faces without a material have the empty one.
    pub(super) materials: Vec<String>,
    pub(super) libraries: Vec<String>,
    pub(super) names: RawNames,
    pub(super) dropped: Dropped,
    /// Whether some face names an attribute at some of its corners only. The library does not check
    /// those indices.
    pub(super) has_uneven_faces: bool,
    material: u32,
    material_numbers: FxHashMap<Vec<u8>, u32>,
    /// Buffer for the corners of a face that remain.
    distinct: Vec<usize>,
}

/// Material and attributes of a face.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct FaceKind {
    pub(super) material: u32,
    /// Whether all corners have texture coordinates.
    pub(super) has_uvs: bool,
    pub(super) has_normals: bool,
}

impl<'a> Lines<'a> {
    /// The lines of a file, with a new object after every `object_size` faces.
    pub(super) fn new(bytes: &'a [u8], object_size: usize, is_tolerant: bool) -> Self {
        let statements = Statements::of(bytes);
        let buffer = Vec::with_capacity(2 * BUFFER);
        Self { statements, buffer, consumed: 0, object_size, faces_of_object: 0, is_tolerant, kept: Kept::default() }
    }

    fn push(&mut self, statement: &Statement<'_>) -> Result<(), LineProblem> {
        let plain = statement.plain();
        let mut words = Words { rest: &plain };
        match words.next().unwrap_or_default() {
            b"v" => self.push_vertex(&plain)?,
            b"vt" => {
                self.kept.counts[1] += 1;
                // The library requires two numbers, while the format requires only one. It ignores
                // a third.
                self.push_attribute(&plain, b" 0\n");
            }
            b"vn" => {
                self.kept.counts[2] += 1;
                self.push_attribute(&plain, b"\n");
            }
            b"f" => {
                let corners = words.clone();
                let Some(is_whole) = self.kept.push_face(words)? else { return Ok(()) };
                if self.faces_of_object == self.object_size {
                    self.faces_of_object = 0;
                    self.buffer.extend_from_slice(b"o\n");
                }
                self.faces_of_object += 1;
                if is_whole {
                    self.push_line(&plain, b"\n");
                } else {
                    self.push_distinct_corners(corners);
                }
            }
            b"usemtl" => self.kept.use_material(name(statement)),
            b"mtllib" => {
                let library = self.kept.names.show(name(statement));
                self.kept.libraries.push(library);
            }
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

    fn push_attribute(&mut self, statement: &[u8], end: &[u8]) {
        if !self.is_tolerant {
            return self.push_line(statement, end);
        }
        for word in (Words { rest: statement }) {
            self.buffer.extend_from_slice(if is_non_finite(word) { b"nan" } else { word });
            self.buffer.push(b' ');
        }
        self.buffer.extend_from_slice(end);
    }

    /// Adds a face without its repeated corners.
    fn push_distinct_corners(&mut self, corners: Words<'_>) {
        let corners: Vec<&[u8]> = corners.collect();
        self.buffer.push(b'f');
        for &corner in &self.kept.distinct {
            self.buffer.push(b' ');
            self.buffer.extend_from_slice(corners[corner]);
        }
        self.buffer.push(b'\n');
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
    /// Adds the color after a position, with or without alpha. A single number is a weight and
    /// ignored.
    fn push_color(&mut self, words: &[u8]) -> Result<(), LineProblem> {
        if let ([r, g, b, alpha], found @ 3..) = read_values(Words { rest: words }, 0)? {
            self.colors.resize(self.counts[0], DVec4::ONE);
            self.colors.push(DVec4::new(r, g, b, if found == 4 { alpha } else { 1.0 }));
        }
        Ok(())
    }

    /// Adds a face. Returns whether the face is as in the file or without repeated corners, or
    /// `None` if it is left out.
    fn push_face(&mut self, words: Words<'_>) -> Result<Option<bool>, LineProblem> {
        if self.materials.is_empty() {
            self.use_material(b"");
        }
        let start = self.corners.len();
        let [vertices, uvs, normals] = match read_usual_corners(words.rest, &mut self.corners) {
            Some(found) => found,
            None => {
                self.corners.truncate(start);
                read_corners(words, self.counts, &mut self.corners)?
            }
        };
        let face = &self.corners[start..];
        let is_whole = !has_repeated_corner(face);
        if !is_whole {
            if !distinct_corners(face, &mut self.distinct) {
                self.dropped.faces += 1;
                self.corners.truncate(start);
                return Ok(None);
            }
            self.dropped.corners += 1;
            for (at, &corner) in self.distinct.iter().enumerate() {
                self.corners[start + at] = self.corners[start + corner];
            }
            self.corners.truncate(start + self.distinct.len());
        }
        let [has_uvs, has_normals] = [uvs, normals].map(|found| found == vertices);
        self.has_uneven_faces |= (!has_uvs && uvs > 0) || (!has_normals && normals > 0);
        let kind = FaceKind { material: self.material, has_uvs, has_normals };
        match self.runs.last_mut() {
            Some((known, faces)) if *known == kind => *faces += 1,
            _ => self.runs.push((kind, 1)),
        }
        Ok(Some(is_whole))
    }

    fn use_material(&mut self, name: &[u8]) {
        self.material = match self.material_numbers.get(name) {
            Some(&number) => number,
            None => {
                let number = self.materials.len() as u32;
                self.material_numbers.insert(name.to_owned(), number);
                let shown = self.names.show(name);
                self.materials.push(shown);
                number
            }
        };
    }
}

/// Largest number of digits of an index on the fast path. A larger number may not fit into 32 bits.
const MOST_DIGITS: usize = 9;

/// Adds the vertices of a face and returns how many corners have each of the three indices. `None`
/// for faces that need the general parser: other white space, indices with a sign, leading zeros or
/// many digits, and invalid corners.
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

/// The number at the start of `bytes` and the bytes after it. Zero without digits.
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

/// The general parser of faces. Negative indices count back from `counts`.
fn read_corners(words: Words<'_>, counts: [usize; 3], vertices: &mut Vec<u32>) -> Result<[usize; 3], LineProblem> {
    // Elements may come later in the file, so positive indices are not limited here. The refused
    // indices would overflow in the library's arithmetic.
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

/// Splits a vertex statement after its third number.
pub(super) fn split_vertex(statement: &[u8]) -> Result<(&[u8], &[u8]), LineProblem> {
    // Fast path: a statement with three spaces ends after its third number.
    if statement.iter().filter(|&&byte| byte <= b' ').count() == 3 {
        return Ok((statement, &[]));
    }
    let mut words = Words { rest: statement };
    match words.by_ref().take(4).count() {
        4 => Ok(statement.split_at(statement.len() - words.rest.len())),
        found => Err(LineProblem::TooFewNumbers { expected: 3, found: found - 1 }),
    }
}

/// The bytes after the first word. Names may contain a `#`.
fn name<'a>(statement: &Statement<'a>) -> &'a [u8] {
    let mut words = Words { rest: statement.verbatim() };
    words.next();
    words.rest.trim_ascii()
}

/// Names that are not UTF-8, by the text that is shown for them.
#[derive(Default)]
pub(super) struct RawNames(pub(super) BTreeMap<String, Vec<u8>>);

impl RawNames {
    /// The text for a name. A name that is not UTF-8 is shown as Latin-1, so that different names
    /// stay different.
    fn show(&mut self, name: &[u8]) -> String {
        if let Ok(text) = str::from_utf8(name) {
            return text.to_owned();
        }
        let shown: String = name.iter().map(|&byte| char::from(byte)).collect();
        self.0.insert(shown.clone(), name.to_owned());
        shown
    }
}
