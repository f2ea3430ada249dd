//! The statements of an OBJ file.

use std::borrow::Cow;

/// A statement as it stands in the file.
pub(super) struct Statement<'a> {
    /// The line on which it begins, counted from one.
    pub(super) line: usize,
    bytes: &'a [u8],
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

    /// All of it, for names that may hold the sign of a comment.
    pub(super) fn verbatim(&self) -> &'a [u8] {
        self.bytes
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
