//! Reading and writing of the words and numbers of text formats.

use std::borrow::Cow;
use std::io::{self, Write};

use super::{LineProblem, ParseError};

/// The text of a file without its byte order mark, with LF at the end of every line.
///
/// # Errors
/// [`ParseError::Malformed`] if the text is UTF-16 or UTF-32.
pub(super) fn decode(bytes: &[u8]) -> Result<Cow<'_, [u8]>, ParseError> {
    let bytes = without_mark(bytes)?;
    // CR before LF is white space at the end of a line. Only a lone CR ends a line itself.
    let is_lone = |&at: &usize| bytes.get(at + 1) != Some(&b'\n');
    let Some(first) = memchr::memchr_iter(b'\r', bytes).find(is_lone) else { return Ok(bytes.into()) };
    let mut text = bytes.to_vec();
    for at in first..text.len() {
        if text[at] == b'\r' && text.get(at + 1) != Some(&b'\n') {
            text[at] = b'\n';
        }
    }
    Ok(text.into())
}

/// The bytes after a byte order mark.
///
/// # Errors
/// [`ParseError::Malformed`] if the bytes are UTF-16 or UTF-32.
pub(super) fn without_mark(bytes: &[u8]) -> Result<&[u8], ParseError> {
    let encoding = match *bytes {
        [0xFF, 0xFE, 0, 0, ..] | [0, 0, 0xFE, 0xFF, ..] => "UTF-32",
        [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => "UTF-16",
        // Without a mark, every second byte of ASCII characters is zero.
        [1..=0x7F, 0, 1..=0x7F, 0, ..] | [0, 1..=0x7F, 0, 1..=0x7F, ..] => "UTF-16",
        _ => return Ok(bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)),
    };
    Err(ParseError::Malformed(format!("the text is encoded in {encoding}; save it in UTF-8")))
}

/// Words separated by white space.
#[derive(Clone)]
pub(super) struct Words<'a> {
    pub(super) rest: &'a [u8],
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        self.skip_spaces();
        let end = self.rest.iter().position(is_space).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }
}

impl Words<'_> {
    /// The next word as a finite number. `None` at the end of the line and before a comment.
    #[inline]
    pub(super) fn next_number(&mut self) -> Result<Option<f64>, LineProblem> {
        self.skip_spaces();
        // The parser finds the end of the number, so no byte is scanned twice.
        match fast_float2::parse_partial::<f64, _>(self.rest) {
            Ok((number, length)) if number.is_finite() && self.rest.get(length).is_none_or(is_space) => {
                self.rest = &self.rest[length..];
                Ok(Some(number))
            }
            _ => match self.next() {
                Some([b'#', ..]) | None => Ok(None),
                Some(word) => Err(LineProblem::NotANumber(text(word))),
            },
        }
    }

    /// The next word as a number, which may be infinite or NaN. `None` at the end of the line and
    /// before a comment.
    pub(super) fn next_value(&mut self) -> Result<Option<f64>, LineProblem> {
        let start = self.clone();
        match self.next_number() {
            Err(_) if start.clone().next().is_some_and(is_non_finite) => {
                *self = start;
                self.next();
                Ok(Some(f64::NAN))
            }
            result => result,
        }
    }

    #[inline]
    pub(super) fn skip_spaces(&mut self) {
        while let [first, rest @ ..] = self.rest
            && is_space(first)
        {
            self.rest = rest;
        }
    }
}

#[inline]
pub(super) fn is_space(byte: &u8) -> bool {
    byte.is_ascii_whitespace()
}

/// Whether a word is an infinite or undefined number, as any of the usual libraries prints it:
/// `nan`, `-nan(ind)`, `1.#QNAN`, `inf`, `-Infinity`, or a number beyond double precision.
pub(super) fn is_non_finite(word: &[u8]) -> bool {
    let word = word.to_ascii_lowercase();
    let unsigned = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(&word);
    unsigned.starts_with(b"nan")
        || matches!(unsigned, b"inf" | b"infinity")
        || unsigned.starts_with(b"1.#")
        || fast_float2::parse::<f64, _>(unsigned).is_ok_and(|number| !number.is_finite())
}

/// Lines that are neither blank nor only a comment, with their numbers counted from one.
pub(super) fn numbered_lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Words<'_>)> {
    bytes.split(|&byte| byte == b'\n').zip(1..).filter_map(|(line, number)| {
        let text = line.split(|&byte| byte == b'#').next().unwrap_or_default();
        (!text.trim_ascii().is_empty()).then_some((number, Words { rest: text }))
    })
}

/// Reads up to `N` finite numbers and returns them with their count. Further words are ignored.
pub(super) fn read_numbers<const N: usize>(
    words: Words<'_>,
    expected: usize,
) -> Result<([f64; N], usize), LineProblem> {
    read_with(words, expected, Words::next_number)
}

/// As [`read_numbers`], but the numbers may be infinite or NaN.
pub(super) fn read_values<const N: usize>(words: Words<'_>, expected: usize) -> Result<([f64; N], usize), LineProblem> {
    read_with(words, expected, Words::next_value)
}

#[inline]
fn read_with<'a, const N: usize>(
    mut words: Words<'a>,
    expected: usize,
    next: impl Fn(&mut Words<'a>) -> Result<Option<f64>, LineProblem>,
) -> Result<([f64; N], usize), LineProblem> {
    let mut numbers = [0.0; N];
    for found in 0..N {
        match next(&mut words)? {
            Some(number) => numbers[found] = number,
            None if found < expected => return Err(LineProblem::TooFewNumbers { expected, found }),
            None => return Ok((numbers, found)),
        }
    }
    Ok((numbers, N))
}

/// The words of a whole file, where line ends are plain white space. `#` begins a comment.
#[derive(Clone)]
pub(super) struct Tokens<'a> {
    bytes: &'a [u8],
    words: Words<'a>,
}

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            let word = self.words.next()?;
            match memchr::memchr(b'#', word) {
                None => return Some(word),
                Some(at) => {
                    self.words.rest = &self.bytes[self.offset() - word.len() + at..];
                    self.skip_line();
                    if at > 0 {
                        return Some(&word[..at]);
                    }
                }
            }
        }
    }
}

impl<'a> Tokens<'a> {
    pub(super) fn of(bytes: &'a [u8]) -> Self {
        Self { bytes, words: Words { rest: bytes } }
    }

    fn offset(&self) -> usize {
        self.bytes.len() - self.words.rest.len()
    }

    /// The words before the next line end.
    pub(super) fn rest_of_line(&self) -> Words<'a> {
        let rest = self.words.rest;
        let end = memchr::memchr2(b'\n', b'#', rest).unwrap_or(rest.len());
        Words { rest: &rest[..end] }
    }

    /// Skips the rest of the line.
    pub(super) fn skip_line(&mut self) {
        let rest = self.words.rest;
        self.words.rest = &rest[memchr::memchr(b'\n', rest).unwrap_or(rest.len())..];
    }

    /// The line of the last word, counted from one. For errors, since it counts from the start.
    pub(super) fn line(&self) -> usize {
        1 + memchr::memchr_iter(b'\n', &self.bytes[..self.offset()]).count()
    }

    /// The next `N` words as finite numbers.
    #[inline]
    pub(super) fn numbers<const N: usize>(&mut self) -> Result<[f64; N], LineProblem> {
        let mut numbers = [0.0; N];
        for found in 0..N {
            numbers[found] = match self.words.next_number() {
                Ok(Some(number)) => number,
                // The end, or a comment in the middle of a number, which the token reader skips.
                Ok(None) => {
                    self.skip_line();
                    let word = self.next().ok_or(LineProblem::TooFewNumbers { expected: N, found })?;
                    let parsed = Words { rest: word }.next_number()?;
                    parsed.ok_or(LineProblem::TooFewNumbers { expected: N, found })?
                }
                Err(problem) => return Err(problem),
            };
        }
        Ok(numbers)
    }
}

/// An integer with an optional minus sign and at most ten digits.
pub(super) fn parse_integer(word: &[u8]) -> Option<i64> {
    let (digits, sign) = match word.strip_prefix(b"-") {
        Some(digits) => (digits, -1),
        None => (word, 1),
    };
    // Ten digits suffice for every 32-bit index and cannot overflow 64 bits.
    if digits.is_empty() || digits.len() > 10 {
        return None;
    }
    let mut value = 0;
    for &digit in digits {
        let digit = digit.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = 10 * value + i64::from(digit);
    }
    Some(sign * value)
}

/// Bytes of a file as trimmed text, to show or to keep.
pub(super) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes.trim_ascii()).into_owned()
}

/// Attaches the number of the line to a defect in it.
pub(super) fn at_line(line: usize) -> impl Fn(LineProblem) -> ParseError {
    move |problem| ParseError::Line { line, problem }
}

/// Bytes collected before they go to the writer. Smaller values make writing PLY a fifth slower;
/// larger ones exceed the cache.
pub(super) const FLUSH_AT: usize = 1 << 20;

/// Passes `bytes` to the writer and clears them once they number at least `most`.
#[inline]
pub(super) fn flush(bytes: &mut Vec<u8>, writer: &mut dyn Write, most: usize) -> io::Result<()> {
    if bytes.len() >= most {
        writer.write_all(bytes)?;
        bytes.clear();
    }
    Ok(())
}

/// Appends an integer in decimal.
pub(super) fn push_index(bytes: &mut Vec<u8>, index: u32) {
    bytes.extend_from_slice(itoa::Buffer::new().format(index).as_bytes());
}

/// A floating-point number of either precision.
pub(super) trait Number: ryu::Float + Into<f64> + Default {}

impl Number for f32 {}

impl Number for f64 {}

/// Writes lines of words through a buffer.
pub(super) struct LineWriter<'a> {
    writer: &'a mut dyn Write,
    buffer: Vec<u8>,
}

impl<'a> LineWriter<'a> {
    pub(super) fn new(writer: &'a mut dyn Write) -> Self {
        Self { writer, buffer: Vec::with_capacity(FLUSH_AT + 4096) }
    }

    pub(super) fn push_text(&mut self, text: &str) {
        self.push_bytes(text.as_bytes());
    }

    pub(super) fn push_bytes(&mut self, bytes: &[u8]) {
        self.buffer.extend_from_slice(bytes);
    }

    /// Appends the shortest decimal that reads back as the same number. Writes zero instead of a
    /// number that is not finite, which no reader would accept.
    pub(super) fn push_number<T: Number>(&mut self, number: T) {
        let mut digits = ryu::Buffer::new();
        let digits = digits.format_finite(if number.into().is_finite() { number } else { T::default() });
        self.push_text(digits.strip_suffix(".0").unwrap_or(digits));
    }

    /// Appends numbers, each preceded by a space.
    pub(super) fn push_numbers(&mut self, numbers: impl IntoIterator<Item = impl Number>) {
        for number in numbers {
            self.buffer.push(b' ');
            self.push_number(number);
        }
    }

    pub(super) fn push_index(&mut self, index: u32) {
        push_index(&mut self.buffer, index);
    }

    pub(super) fn end_line(&mut self) -> io::Result<()> {
        self.buffer.push(b'\n');
        flush(&mut self.buffer, self.writer, FLUSH_AT)
    }

    pub(super) fn finish(self) -> io::Result<()> {
        self.writer.write_all(&self.buffer)
    }
}
