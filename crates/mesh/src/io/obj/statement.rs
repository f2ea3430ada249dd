//! The statements of an OBJ file.

use std::borrow::Cow;

use crate::io::text::Words;

/// A statement of the file, unmodified.
pub(super) struct Statement<'a> {
    /// The line on which it begins, counted from one.
    pub(super) line: usize,
    bytes: &'a [u8],
    /// Whether it may contain a comment or a backslash.
    is_marked: bool,
}

impl<'a> Statement<'a> {
    /// The statement on one line and without its comment.
    pub(super) fn plain(&self) -> Cow<'a, [u8]> {
        if !self.is_marked {
            return Cow::Borrowed(self.bytes);
        }
        // Some programs print a number that is not finite as `1.#QNAN`.
        let is_comment = |&at: &usize| !self.bytes[..at].ends_with(b"1.");
        let end = memchr::memchr_iter(b'#', self.bytes).find(is_comment).unwrap_or(self.bytes.len());
        let joined = |&byte: &u8| if matches!(byte, b'\\' | b'\n') { b' ' } else { byte };
        Cow::Owned(self.bytes[..end].iter().map(joined).collect())
    }

    /// The first word.
    pub(super) fn keyword(&self) -> &'a [u8] {
        keyword(self.bytes)
    }

    /// The whole statement, for names that may contain a `#`.
    pub(super) fn verbatim(&self) -> &'a [u8] {
        self.bytes
    }
}

/// The first word, which a backslash at the end of the line may follow directly.
fn keyword(statement: &[u8]) -> &[u8] {
    let word = Words { rest: statement }.next().unwrap_or_default();
    word.strip_suffix(b"\\").unwrap_or(word)
}

/// Whether a backslash at the end joins `line` to the next one. Names and comments may end in a
/// backslash by chance, for example as the second byte of a character in Shift-JIS.
fn continues(line: &[u8]) -> bool {
    const JOINED: [&[u8]; 22] = [
        b"v", b"vt", b"vn", b"vp", b"f", b"fo", b"p", b"l", b"deg", b"bmat", b"step", b"cstype", b"curv", b"curv2",
        b"surf", b"parm", b"trim", b"hole", b"scrv", b"sp", b"con", b"end",
    ];
    line.last() == Some(&b'\\') && JOINED.contains(&keyword(line)) && memchr::memchr(b'#', line).is_none()
}

/// The statements of a file. A backslash at the end joins lines of numbers.
pub(super) struct Statements<'a> {
    bytes: &'a [u8],
    start: usize,
    line: usize,
    /// Position of the next comment or backslash.
    mark: usize,
}

impl<'a> Statements<'a> {
    pub(super) fn of(bytes: &'a [u8]) -> Self {
        Self { bytes, start: 0, line: 1, mark: next_mark(bytes, 0) }
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = Statement<'a>;

    fn next(&mut self) -> Option<Statement<'a>> {
        let (first_line, mut end) = (self.line, self.start);
        while end < self.bytes.len() {
            self.line += 1;
            end = memchr::memchr(b'\n', &self.bytes[end..]).map_or(self.bytes.len(), |offset| end + offset + 1);
            let bytes = self.bytes[self.start..end].trim_ascii();
            let is_marked = self.mark < end;
            if !is_marked || !continues(bytes) || end == self.bytes.len() {
                if is_marked {
                    self.mark = next_mark(self.bytes, end);
                }
                self.start = end;
                return Some(Statement { line: first_line, bytes, is_marked });
            }
        }
        None
    }
}

fn next_mark(bytes: &[u8], from: usize) -> usize {
    memchr::memchr2(b'#', b'\\', &bytes[from..]).map_or(bytes.len(), |at| from + at)
}
