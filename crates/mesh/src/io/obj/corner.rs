//! The corners of faces.

use crate::io::LineProblem;
use crate::io::text::{Words, is_space, text};

/// What the three indices of a corner stand for.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// Numbers from zero of a corner's vertex, texture coordinate and normal; [`NONE`] for those that it has not.
pub(super) type Corner = [u32; 3];

/// Stands for no number. One more is zero, which is how many elements it takes.
pub(super) const NONE: u32 = u32::MAX;

/// The next corner of a face; none at its end. Negative indices count back from `counts`, the numbers of vertices, texture
/// coordinates and normals so far. Others may be too large: what they stand for may come later in the file.
#[inline]
pub(super) fn next_corner(words: &mut Words<'_>, counts: [usize; 3]) -> Result<Option<Corner>, LineProblem> {
    words.skip_spaces();
    let mut corner = [NONE; 3];
    if words.rest.is_empty() {
        return Ok(None);
    }
    let word = words.rest;
    let not_a_corner = || LineProblem::NotACorner(text(Words { rest: word }.next().unwrap_or_default()));
    for kind in 0..3 {
        if let Some((index, length)) = leading_integer(words.rest) {
            words.rest = &words.rest[length..];
            corner[kind] = number(index, counts[kind]).ok_or(LineProblem::IndexOutOfRange {
                kind: KINDS[kind],
                index,
                count: counts[kind],
            })?;
        } else if kind == 0 {
            return Err(not_a_corner());
        }
        match words.rest.first() {
            Some(b'/') if kind < 2 => words.rest = &words.rest[1..],
            Some(byte) if !is_space(byte) => return Err(not_a_corner()),
            _ => return Ok(Some(corner)),
        }
    }
    Err(not_a_corner())
}

/// The number from zero that an index from one, or one that counts back from `count`, stands for.
#[inline]
fn number(index: i64, count: usize) -> Option<u32> {
    match index {
        0 => None,
        1.. => u32::try_from(index - 1).ok().filter(|&number| number != NONE),
        ..0 => u32::try_from(count as i64 + index).ok(),
    }
}

/// The whole number at the beginning of `bytes` and its length; none if there is none, or one of more than ten digits, which
/// hold every index that there can be.
#[inline]
fn leading_integer(bytes: &[u8]) -> Option<(i64, usize)> {
    let sign = usize::from(bytes.first() == Some(&b'-'));
    let mut value = 0;
    let mut length = sign;
    while let Some(digit) = bytes.get(length).map(|byte| byte.wrapping_sub(b'0')).filter(|&digit| digit < 10) {
        value = 10 * value + i64::from(digit);
        length += 1;
        if length - sign > 10 {
            return None;
        }
    }
    (length > sign).then_some((if sign == 1 { -value } else { value }, length))
}

/// Refuses a corner that names what the file, with `totals` of each kind, has not.
pub(super) fn check_range(corner: Corner, totals: [usize; 3]) -> Result<(), LineProblem> {
    for kind in 0..3 {
        if corner[kind] != NONE && corner[kind] as usize >= totals[kind] {
            let index = i64::from(corner[kind]) + 1;
            return Err(LineProblem::IndexOutOfRange { kind: KINDS[kind], index, count: totals[kind] });
        }
    }
    Ok(())
}
