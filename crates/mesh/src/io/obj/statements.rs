//! The statements of an OBJ file, made ready for the library.

use std::borrow::Cow;

use glam::DVec4;
use rustc_hash::FxHashMap;

use crate::io::text::{Words, read_numbers, text};

/// Lines for the library, and what is kept beside them because it has no place for it.
#[derive(Default)]
pub(super) struct Statements {
    /// `v`, `vt`, `vn` and `f` in the order of the file, a line each, without comments and colors. The library takes
    /// polylines for faces and numbers the vertices of every group and material anew.
    pub(super) lines: Vec<u8>,
    /// Numbers of vertices, texture coordinates and normals.
    pub(super) counts: [usize; 3],
    /// As many as there are vertices, or none.
    pub(super) colors: Vec<DVec4>,
    pub(super) runs: Vec<FaceRun>,
    /// Names of the materials, of which the empty one is that of faces without any.
    pub(super) materials: Vec<String>,
    pub(super) libraries: Vec<String>,
    /// True where something has to be looked at before the library may read it.
    pub(super) is_suspect: bool,
    material: u32,
    material_numbers: FxHashMap<String, u32>,
}

/// Faces in a row that are alike.
pub(super) struct FaceRun {
    pub(super) faces: usize,
    pub(super) material: u32,
    pub(super) has_uvs: bool,
    pub(super) has_normals: bool,
}

impl Statements {
    pub(super) fn of(bytes: &[u8]) -> Self {
        let mut statements = Self { lines: Vec::with_capacity(bytes.len()), ..Self::default() };
        for statement in split_statements(bytes) {
            statements.push(&statement);
        }
        if !statements.colors.is_empty() {
            statements.colors.resize(statements.counts[0], DVec4::ONE);
        }
        statements
    }

    fn push(&mut self, statement: &Statement<'_>) {
        let mut words = Words { rest: statement.bytes };
        match words.next().unwrap_or_default() {
            b"v" => self.push_vertex(&statement.plain()),
            b"vt" => {
                self.counts[1] += 1;
                // The library wants two numbers where one will do, and passes over a third.
                self.push_line(&statement.plain(), b" 0\n");
            }
            b"vn" => {
                self.counts[2] += 1;
                self.push_line(&statement.plain(), b"\n");
            }
            b"f" => self.push_face(&statement.plain()),
            b"usemtl" => self.use_material(&text(words.rest)),
            b"mtllib" => self.libraries.push(text(words.rest)),
            _ => {}
        }
    }

    /// Only the position goes on: the library mistakes colors where some vertices have none, and refuses an alpha.
    fn push_vertex(&mut self, statement: &[u8]) {
        let (position, color) = split_vertex(statement);
        self.push_line(position, b"\n");
        if !color.is_empty() {
            match read_numbers::<4>(Words { rest: color }, 0) {
                Ok((numbers, found @ 3..)) => {
                    self.colors.resize(self.counts[0], DVec4::ONE);
                    let alpha = if found == 4 { numbers[3] } else { 1.0 };
                    self.colors.push(DVec4::new(numbers[0], numbers[1], numbers[2], alpha));
                }
                Ok(_) => {}
                Err(_) => self.is_suspect = true,
            }
        }
        self.counts[0] += 1;
    }

    fn push_face(&mut self, statement: &[u8]) {
        if self.materials.is_empty() {
            self.use_material("");
        }
        self.push_line(statement, b"\n");
        let (mut has_uvs, mut has_normals) = (false, false);
        if statement.contains(&b'/') {
            // All corners of a face have the same attributes.
            let corner = Words { rest: statement }.nth(1).unwrap_or_default();
            let mut fields = corner.split(|&byte| byte == b'/').skip(1);
            let mut has_next = || fields.next().is_some_and(|field| !field.is_empty());
            (has_uvs, has_normals) = (has_next(), has_next());
            self.is_suspect |= statement.split(|&byte| byte == b'/').skip(1).any(begins_with_unusual_index);
        }
        let material = self.material;
        match self.runs.last_mut() {
            Some(run) if (run.material, run.has_uvs, run.has_normals) == (material, has_uvs, has_normals) => {
                run.faces += 1
            }
            _ => self.runs.push(FaceRun { faces: 1, material, has_uvs, has_normals }),
        }
    }

    fn push_line(&mut self, statement: &[u8], end: &[u8]) {
        self.lines.extend_from_slice(statement);
        self.lines.extend_from_slice(end);
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

/// True for indices of attributes on which the library's arithmetic may overflow (negative or very long ones), and for
/// zero, which it takes for none. Those of vertices it handles well.
fn begins_with_unusual_index(text: &[u8]) -> bool {
    match text.first() {
        Some(b'1'..=b'9') => text.iter().take_while(|byte| byte.is_ascii_digit()).count() > 10,
        Some(byte) => !byte.is_ascii_whitespace(),
        None => false,
    }
}

/// What comes up to the third number of a vertex, and what comes after it.
fn split_vertex(statement: &[u8]) -> (&[u8], &[u8]) {
    // The usual vertex has three spaces, and needs no closer look at its words.
    if statement.iter().filter(|&&byte| byte <= b' ').count() <= 3 {
        return (statement, &[]);
    }
    let mut words = Words { rest: statement };
    words.nth(3);
    statement.split_at(statement.len() - words.rest.len())
}

/// A statement as it stands in the file.
pub(super) struct Statement<'a> {
    /// The line on which it begins, counted from one.
    pub(super) line: usize,
    pub(super) bytes: &'a [u8],
    /// True where there may be a comment or a backslash in it.
    is_marked: bool,
}

impl<'a> Statement<'a> {
    /// The statement on one line and without its comment.
    pub(super) fn plain(&self) -> Cow<'a, [u8]> {
        if !self.is_marked {
            return Cow::Borrowed(self.bytes);
        }
        let end = memchr::memchr(b'#', self.bytes).unwrap_or(self.bytes.len());
        let joined = |&byte: &u8| if matches!(byte, b'\\' | b'\n') { b' ' } else { byte };
        Cow::Owned(self.bytes[..end].iter().map(joined).collect())
    }
}

/// The statements of a file. A backslash at the end joins lines.
pub(super) fn split_statements(bytes: &[u8]) -> impl Iterator<Item = Statement<'_>> {
    let next_mark = |from: usize| memchr::memchr2(b'#', b'\\', &bytes[from..]).map_or(bytes.len(), |at| from + at);
    let (mut start, mut line, mut mark) = (0, 1, next_mark(0));
    std::iter::from_fn(move || {
        let (first_line, mut end) = (line, start);
        while end < bytes.len() {
            line += 1;
            end = memchr::memchr(b'\n', &bytes[end..]).map_or(bytes.len(), |offset| end + offset + 1);
            let statement = bytes[start..end].trim_ascii_end();
            let is_marked = mark < end;
            if !is_marked || statement.last() != Some(&b'\\') || end == bytes.len() {
                if is_marked {
                    mark = next_mark(end);
                }
                start = end;
                return Some(Statement { line: first_line, bytes: statement, is_marked });
            }
        }
        None
    })
}
