//! Points in lines of text.

use glam::DVec3;

use crate::io::text::Words;

/// Writes `line` with the numbers in `columns` replaced and the rest unchanged.
///
/// Numbers are the shortest decimals that read back as the same number, in single or double
/// precision. An unchanged number keeps its digits.
pub(super) fn write_point(line: &[u8], columns: [usize; 3], point: DVec3, is_single: bool, out: &mut Vec<u8>) {
    let mut words = Words { rest: line };
    let mut written = 0;
    let mut column = 0;
    while let Some(word) = words.next() {
        if let Some(axis) = columns.iter().position(|&of_axis| of_axis == column) {
            let end = line.len() - words.rest.len();
            out.extend_from_slice(&line[written..end - word.len()]);
            written = end;
            let value = point[axis];
            let is_same = fast_float2::parse::<f64, _>(word).is_ok_and(|old| old.to_bits() == value.to_bits());
            if is_same {
                out.extend_from_slice(word);
            } else {
                push_number(value, is_single, out);
            }
        }
        column += 1;
    }
    out.extend_from_slice(&line[written..]);
}

fn push_number(value: f64, is_single: bool, out: &mut Vec<u8>) {
    let mut digits = ryu::Buffer::new();
    let digits = if is_single { digits.format_finite(value as f32) } else { digits.format_finite(value) };
    out.extend_from_slice(digits.strip_suffix(".0").unwrap_or(digits).as_bytes());
}
