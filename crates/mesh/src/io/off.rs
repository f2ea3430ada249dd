//! Object File Format.

use std::io::{self, Write};

use glam::DVec3;

use super::element::{Dropped, distinct_corners, has_repeated_corner, is_triangle};
use super::polygon::triangulate;
use super::sniff::is_off;
use super::text::{LineWriter, Tokens, at_line, decode, numbered_lines, parse_integer, read_numbers, text};
use super::{LineProblem, ParseError};
use crate::TriMesh;

/// Reads the positions and faces of OFF and of its variants with normals, colors or texture
/// coordinates.
///
/// Lines decide what a number means, because many files have colors that their header does not
/// announce. A file whose numbers are wrapped differently is read again by its numbers alone.
pub(super) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let text = decode(bytes)?;
    let mut tokens = Tokens::of(&text);
    let header = Header::read(&mut tokens)?;
    match parse_lines(&text, &header) {
        Ok((mesh, false)) => Ok(mesh),
        Ok((mesh, true)) => Ok(parse_tokens(tokens, &header).unwrap_or(mesh)),
        Err(error) => {
            let read = parse_tokens(tokens.clone(), &header);
            // The number of edges may be on a line of its own.
            let read = read.or_else(|| tokens.next().and_then(|_| parse_tokens(tokens, &header)));
            read.ok_or(error)
        }
    }
}

struct Header {
    vertices: usize,
    faces: usize,
    /// Line of the last count.
    line: usize,
    /// Numbers after the position of a vertex.
    extra: usize,
}

impl Header {
    fn read(tokens: &mut Tokens<'_>) -> Result<Self, ParseError> {
        let keyword = tokens.next().ok_or_else(truncated)?;
        if !is_off(keyword) {
            return Err(ParseError::Malformed(format!("'{}' is not a header of OFF", text(keyword))));
        }
        // Some programs write the first count directly after the keyword.
        let end = keyword.iter().rposition(|byte| !byte.is_ascii_digit()).map_or(0, |last| last + 1);
        let (kind, glued) = keyword.split_at(end);
        let has = |letter: u8| kind[..kind.len() - 3].iter().any(|byte| byte.to_ascii_uppercase() == letter);
        let extra = [(b'4', 1), (b'N', 3), (b'C', 4), (b'S', 2)];
        let extra = extra.iter().filter(|(letter, _)| has(*letter)).map(|(_, count)| count).sum();
        let mut first = Some(glued).filter(|glued| !glued.is_empty());
        let mut counts = [0; 2];
        for (found, count) in counts.iter_mut().enumerate() {
            let word = first.take().or_else(|| tokens.next()).ok_or_else(truncated)?;
            if word.eq_ignore_ascii_case(b"binary") && found == 0 {
                return Err(ParseError::Malformed("binary OFF is not supported; save it as text".into()));
            }
            let value = parse_integer(word).and_then(|value| usize::try_from(value).ok());
            *count = value.ok_or_else(|| at_line(tokens.line())(LineProblem::NotANumber(text(word))))?;
        }
        let line = tokens.line();
        // The number of edges is optional.
        tokens.skip_line();
        Ok(Self { vertices: counts[0], faces: counts[1], line, extra })
    }
}

fn truncated() -> ParseError {
    ParseError::Malformed("the file ends too early".into())
}

/// Reads one element per line; further words of a line are ignored. The flag is `true` if lines are
/// left over.
fn parse_lines(text: &[u8], header: &Header) -> Result<(TriMesh, bool), ParseError> {
    let mut lines = numbered_lines(text).skip_while(|&(line, _)| line <= header.line);
    let mut mesh = TriMesh::default();
    for _ in 0..header.vertices {
        let (line, words) = lines.next().ok_or_else(truncated)?;
        let (numbers, _) = read_numbers::<3>(words, 3).map_err(at_line(line))?;
        mesh.positions.push(DVec3::from_array(numbers));
    }
    let mut faces = Faces::default();
    for _ in 0..header.faces {
        let (line, mut words) = lines.next().ok_or_else(truncated)?;
        faces.read(&mut words, header.vertices).map_err(at_line(line))?;
        faces.push(&mut mesh);
    }
    Ok((faces.finish(mesh), lines.next().is_some()))
}

/// Reads elements by the numbers that the header announces. `None` if they do not fit.
fn parse_tokens(mut tokens: Tokens<'_>, header: &Header) -> Option<TriMesh> {
    let mut mesh = TriMesh::default();
    for _ in 0..header.vertices {
        mesh.positions.push(DVec3::from_array(tokens.numbers::<3>().ok()?));
        for _ in 0..header.extra {
            tokens.numbers::<1>().ok()?;
        }
    }
    let mut faces = Faces::default();
    for _ in 0..header.faces {
        faces.read(&mut tokens, header.vertices).ok()?;
        faces.push(&mut mesh);
        // A color of the face.
        if tokens.rest_of_line().next().is_some_and(|word| word.contains(&b'.')) {
            tokens.skip_line();
        }
    }
    tokens.next().is_none().then(|| faces.finish(mesh))
}

/// The current face, and the faces that were left out.
#[derive(Default)]
struct Faces {
    corners: Vec<u32>,
    kept: Vec<usize>,
    polygon: Vec<DVec3>,
    dropped: Dropped,
}

impl Faces {
    fn read<'a>(&mut self, words: &mut impl Iterator<Item = &'a [u8]>, count: usize) -> Result<(), LineProblem> {
        let not_a_number = |word| LineProblem::NotANumber(text(word));
        let word = words.next().unwrap_or_default();
        let size = parse_integer(word).and_then(|size| usize::try_from(size).ok());
        let expected = size.ok_or_else(|| not_a_number(word))?;
        self.corners.clear();
        for word in words.take(expected) {
            let index = parse_integer(word).ok_or_else(|| not_a_number(word))?;
            let is_in_range = usize::try_from(index).is_ok_and(|index| index < count);
            match u32::try_from(index) {
                Ok(vertex) if is_in_range => self.corners.push(vertex),
                _ => return Err(LineProblem::IndexOutOfRange { kind: "vertex", index, count }),
            }
        }
        match self.corners.len() {
            found if found < expected => Err(LineProblem::TooFewNumbers { expected, found }),
            _ => Ok(()),
        }
    }

    fn push(&mut self, mesh: &mut TriMesh) {
        let Self { corners, kept, polygon, dropped } = self;
        if has_repeated_corner(corners) {
            if !distinct_corners(corners, kept) {
                dropped.faces += 1;
                return;
            }
            dropped.corners += 1;
            *corners = kept.iter().map(|&corner| corners[corner]).collect();
        }
        polygon.clear();
        polygon.extend(corners.iter().map(|&vertex| mesh.positions[vertex as usize]));
        triangulate(polygon, |triangle| {
            mesh.triangles.extend(Some(triangle.map(|corner| corners[corner])).filter(is_triangle));
        });
    }

    fn finish(self, mesh: TriMesh) -> TriMesh {
        let mut mesh = mesh.welded_at_boundary();
        self.dropped.note(&mut mesh);
        mesh
    }
}

/// Writes positions and triangles.
pub(super) fn write(mesh: &TriMesh, writer: &mut dyn Write) -> io::Result<()> {
    let mut out = LineWriter::new(writer);
    out.push_text(&format!("OFF\n{} {} 0", mesh.positions.len(), mesh.triangles.len()));
    out.end_line()?;
    for position in &mesh.positions {
        out.push_number(position.x);
        out.push_numbers([position.y, position.z]);
        out.end_line()?;
    }
    for triangle in &mesh.triangles {
        out.push_text("3");
        for &vertex in triangle {
            out.push_text(" ");
            out.push_index(vertex);
        }
        out.end_line()?;
    }
    out.finish()
}
