//! The statements of an OBJ file, made ready for the library.

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
        for (_, statement) in split_statements(bytes) {
            statements.push(statement);
        }
        if !statements.colors.is_empty() {
            statements.colors.resize(statements.counts[0], DVec4::ONE);
        }
        statements
    }

    fn push(&mut self, statement: &[u8]) {
        let mut words = Words { rest: statement };
        match words.next().unwrap_or_default() {
            b"v" => self.push_vertex(without_comment(statement)),
            b"vt" => {
                self.counts[1] += 1;
                // The library wants two numbers where one will do, and passes over a third.
                self.push_line(without_comment(statement), b" 0\n");
            }
            b"vn" => {
                self.counts[2] += 1;
                self.push_line(without_comment(statement), b"\n");
            }
            b"f" => self.push_face(without_comment(statement)),
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
        if memchr::memchr(b'/', statement).is_some() {
            let mut corners = Words { rest: statement }.skip(1).peekable();
            // All corners of a face have the same attributes.
            let mut fields = corners.peek().copied().unwrap_or_default().split(|&byte| byte == b'/').skip(1);
            let mut has_next = || fields.next().is_some_and(|field| !field.is_empty());
            (has_uvs, has_normals) = (has_next(), has_next());
            self.is_suspect |= corners.any(|corner| corner.split(|&byte| byte == b'/').any(is_unusual_index));
        }
        let material = self.material;
        match self.runs.last_mut() {
            Some(run) if (run.material, run.has_uvs, run.has_normals) == (material, has_uvs, has_normals) => {
                run.faces += 1
            }
            _ => self.runs.push(FaceRun { faces: 1, material, has_uvs, has_normals }),
        }
    }

    /// Appends a line. Where a backslash joins lines, spaces do so as well.
    fn push_line(&mut self, statement: &[u8], end: &[u8]) {
        match memchr::memchr(b'\\', statement) {
            None => self.lines.extend_from_slice(statement),
            Some(_) => {
                let joined = statement.iter().map(|&byte| if matches!(byte, b'\\' | b'\n') { b' ' } else { byte });
                self.lines.extend(joined);
            }
        }
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
fn is_unusual_index(field: &[u8]) -> bool {
    field.len() > 10 || field.first().is_some_and(|first| !(b'1'..=b'9').contains(first))
}

pub(super) fn without_comment(statement: &[u8]) -> &[u8] {
    memchr::memchr(b'#', statement).map_or(statement, |comment| &statement[..comment])
}

/// What comes up to the third number of a vertex, and what comes after it.
fn split_vertex(statement: &[u8]) -> (&[u8], &[u8]) {
    // The usual vertex has three spaces, and needs no closer look at its words.
    if statement.iter().filter(|&&byte| byte <= b' ' || byte == b'\\').count() <= 3 {
        return (statement, &[]);
    }
    let mut words = Words { rest: statement };
    words.nth(3);
    statement.split_at(statement.len() - words.rest.len())
}

/// Statements with the number, from one, of the line on which each begins. A backslash at the end joins lines.
pub(super) fn split_statements(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let (mut rest, mut line) = (bytes, 1);
    std::iter::from_fn(move || {
        let (first_line, mut end) = (line, 0);
        while end < rest.len() {
            line += 1;
            end = memchr::memchr(b'\n', &rest[end..]).map_or(rest.len(), |offset| end + offset + 1);
            let statement = rest[..end].trim_ascii_end();
            if statement.last() != Some(&b'\\') || end == rest.len() {
                rest = &rest[end..];
                return Some((first_line, statement));
            }
        }
        None
    })
}
