//! Recognition of formats by content.

use super::stl;
use super::text::Words;
use super::{Format, ParseError};

/// Bytes in which the words of a text format are looked for.
const SAMPLE: usize = 1 << 12;

/// Beginnings of files in formats that are not supported.
const OTHERS: [(&[u8], &str); 9] = [
    (b"PK\x03\x04", "a ZIP archive, such as 3MF or USDZ"),
    (b"\x1F\x8B", "compressed by gzip; unpack it"),
    (b"Kaydara FBX Binary", "FBX"),
    (b"; FBX", "FBX"),
    (b"BLENDER", "a Blender file"),
    (b"ISO-10303-21", "STEP"),
    (b"DRACO", "Draco"),
    (b"version https://git-lfs", "a pointer of Git LFS; fetch the file itself"),
    (b"<", "XML or HTML"),
];

/// The format of the content, whatever the file is called. `None` if the content does not show it.
///
/// # Errors
/// [`ParseError::Malformed`] names a format that is not supported.
pub(super) fn format_of(bytes: &[u8]) -> Result<Option<Format>, ParseError> {
    if stl::has_exact_size(bytes) {
        return Ok(Some(Format::Stl));
    }
    if bytes.starts_with(b"glTF") {
        return Ok(Some(Format::Glb));
    }
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    if let Some((_, name)) = OTHERS.iter().find(|(start, _)| text.starts_with(start)) {
        return Err(ParseError::Malformed(format!("the content is {name}, not a supported mesh format")));
    }
    if text.starts_with(b"{") {
        return Ok(Some(Format::Gltf));
    }
    let sample = &text[..text.len().min(SAMPLE)];
    let first = first_line(sample);
    let word = Words { rest: first }.next().unwrap_or_default();
    Ok(match word {
        b"ply" if first.trim_ascii() == b"ply" => Some(Format::Ply),
        _ if is_off(word) => Some(Format::Off),
        _ if stl::is_text(sample) => Some(Format::Stl),
        b"mtllib" | b"usemtl" => Some(Format::Obj),
        b"v" | b"vn" | b"vt" if has_numbers(first) => Some(Format::Obj),
        _ => None,
    })
}

/// Whether a word is the header of OFF: with letters before, and perhaps with a number after it.
pub(super) fn is_off(word: &[u8]) -> bool {
    let upper = word.to_ascii_uppercase();
    let Some(at) = upper.windows(3).position(|letters| letters == b"OFF") else { return false };
    // A lower-case n means any number of dimensions, which is another format.
    word[..at].iter().all(|byte| b"STCN4stc".contains(byte)) && upper[at + 3..].iter().all(u8::is_ascii_digit)
}

/// The first line that is neither blank nor a comment.
fn first_line(text: &[u8]) -> &[u8] {
    let mut lines = text.split(|&byte| matches!(byte, b'\n' | b'\r'));
    lines.find(|line| !matches!(line.trim_ascii_start(), [] | [b'#', ..])).unwrap_or_default()
}

fn has_numbers(line: &[u8]) -> bool {
    let mut words = Words { rest: line };
    words.next();
    matches!(words.next_number(), Ok(Some(_))) && matches!(words.next_number(), Ok(Some(_)))
}
