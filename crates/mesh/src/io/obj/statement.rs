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
        let end = memchr::memchr(b'#', self.bytes).unwrap_or(self.bytes.len());
        let joined = |&byte: &u8| if matches!(byte, b'\\' | b'\n') { b' ' } else { byte };
        Cow::Owned(self.bytes[..end].iter().map(joined).collect())
    }

    /// The first word.
    pub(super) fn keyword(&self) -> &'a [u8] {
        Words { rest: self.bytes }.next().unwrap_or_default()
    }

    /// The whole statement, for names that may contain a `#`.
    pub(super) fn verbatim(&self) -> &'a [u8] {
        self.bytes
    }
}

/// The statements of a file. A backslash at the end joins lines.
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
            if !is_marked || bytes.last() != Some(&b'\\') || end == self.bytes.len() {
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
