//! Lines of values that are interleaved: the values of one line are `width` apart.
//!
//! With a width of one this is a row along x, with the length of a row it is a layer whose lines
//! run along y.

/// Writes `lines` to `extended`, with `before` more values at the start of each line and `after` at
/// its end. They continue the line by its first and last slope. A line of one value is continued by
/// that value.
pub(super) fn extend(lines: &[f32], width: usize, before: usize, after: usize, extended: &mut Vec<f32>) {
    let second = if lines.len() > width { width } else { 0 };
    let last = lines.len() - width;
    extended.clear();
    for step in (1..=before).rev() {
        let ends = lines[..width].iter().zip(&lines[second..]);
        extended.extend(ends.map(|(end, inner)| end + step as f32 * (end - inner)));
    }
    extended.extend_from_slice(lines);
    for step in 1..=after {
        let ends = lines[last..].iter().zip(&lines[last - second..]);
        extended.extend(ends.map(|(end, inner)| end + step as f32 * (end - inner)));
    }
}
