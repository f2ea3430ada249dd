//! The cross-section of a strip: signed distance from a polygon, smoothed by a spline.
//!
//! Outside a concave polygon the distance has kinks, at which the field would jump. There the samples
//! are smoothed like those of a [`SmoothDistance`].
//!
//! Source: M. Unser, *Splines: a perfect fit for signal and image processing*, 1999 (the recursive
//! prefilter).

use glam::DVec2;
use isochore_mesh::{NoProgress, SmoothDistance};

use super::StripError;

/// Number of samples across the support, or across the narrower side of the bounds if that is
/// smaller. Larger: more memory without benefit. Smaller: the corners of the polygon are visibly
/// rounded.
const SAMPLES: f64 = 8.0;

/// The same for a concave polygon. Smaller: the smoothing has fewer levels, and kinks of the distance
/// show in the field.
const CONCAVE_SAMPLES: f64 = 16.0;

/// Distance, relative to the product of two sides, by which a corner may be on the wrong side of an
/// edge of a convex polygon. Larger: shallow notches keep their kinks. Smaller: rounding makes a
/// convex polygon concave.
const STRAIGHTNESS: f64 = 1e-12;

/// Largest number of samples: 8 MiB, which fit in cache and are computed quickly.
const MOST_SAMPLES: usize = 1 << 20;

/// Cells beyond the support. At the end of the spline its boundary condition shows.
const MARGIN: f64 = 3.0;

/// Pole of the filter that turns samples into coefficients of a cubic B-spline, √3 − 2.
const POLE: f64 = -0.267_949_192_431_122_7;

/// Terms of the initial value of the filter. Powers of the pole beyond are below rounding.
const START_TERMS: usize = 28;

/// Signed distance of a closed polygon in a spine's normal plane, around the origin. It is sampled
/// on a grid and interpolated by a bicubic B-spline: twice continuously differentiable everywhere,
/// with the exact gradient of the interpolant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Section {
    origin: DVec2,
    cell: f64,
    counts: [usize; 2],
    /// Row by row; the first coordinate varies fastest.
    coefficients: Vec<f64>,
    depth: f64,
    radius: f64,
}

impl Section {
    /// Samples the distance of `polygon`, in either orientation, up to `support` beyond it.
    pub(super) fn new(polygon: &[DVec2], support: f64) -> Result<Self, StripError> {
        if polygon.len() < 3 || !polygon.iter().all(|point| point.is_finite()) {
            return Err(StripError::SectionPoints);
        }
        let (low, high) = polygon
            .iter()
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &point| (low.min(point), high.max(point)));
        let narrowest = (high - low).min_element();
        if narrowest <= 0.0 {
            return Err(StripError::SectionEmpty);
        }
        let is_convex = is_convex(polygon, (high - low).max_element());
        let cell = support.min(narrowest) / if is_convex { SAMPLES } else { CONCAVE_SAMPLES };
        let margin = support + MARGIN * cell;
        let origin = low - margin;
        let cells = ((high - low + 2.0 * margin) / cell).ceil() + 1.0;
        if cells.x * cells.y > MOST_SAMPLES as f64 {
            return Err(StripError::SectionCells { cells: cells.x * cells.y, most: MOST_SAMPLES });
        }
        let counts = [cells.x as usize, cells.y as usize];
        let node = |index: usize| origin + cell * DVec2::new((index % counts[0]) as f64, (index / counts[0]) as f64);
        let mut coefficients: Vec<f64> =
            (0..counts[0] * counts[1]).map(|index| signed_distance(polygon, node(index))).collect();
        if coefficients.iter().all(|distance| *distance >= 0.0) {
            return Err(StripError::SectionEmpty);
        }
        if !is_convex {
            coefficients = smoothed(&coefficients, counts, cell, support);
        }
        for row in 0..counts[1] {
            prefilter(&mut coefficients, row * counts[0], 1, counts[0]);
        }
        for column in 0..counts[0] {
            prefilter(&mut coefficients, column, counts[0], counts[1]);
        }
        // The interpolant is a convex combination of its coefficients.
        let depth = -coefficients.iter().copied().fold(f64::INFINITY, f64::min);
        // The interpolant is within a cell of the distance, whose slope is one.
        let radius = polygon.iter().map(|point| point.length()).fold(0.0, f64::max) + cell;
        Ok(Self { origin, cell, counts, coefficients, depth, radius })
    }

    /// Upper bound on the depth of a point inside.
    pub(super) fn depth(&self) -> f64 {
        self.depth
    }

    /// Upper bound on the distance of a point inside from the origin.
    pub(super) fn radius(&self) -> f64 {
        self.radius
    }

    /// Smallest half width that the field must resolve.
    pub(super) fn feature_size(&self) -> f64 {
        self.depth
    }

    /// Distance and gradient at a point of the normal plane, or `None` beyond the samples, which
    /// extend beyond the support.
    pub(super) fn sample(&self, point: DVec2) -> Option<(f64, DVec2)> {
        let grid_point = (point - self.origin) / self.cell;
        let last = DVec2::new((self.counts[0] - 2) as f64, (self.counts[1] - 2) as f64);
        // Four coefficients per axis are needed. The comparisons are false for NaN.
        if !(grid_point.cmpge(DVec2::ONE).all() && grid_point.cmplt(last).all()) {
            return None;
        }
        let corner = grid_point.floor();
        let [column, row] = [corner.x as usize - 1, corner.y as usize - 1];
        let (across, across_slopes) = weights(grid_point.x - corner.x);
        let (up, up_slopes) = weights(grid_point.y - corner.y);
        let (mut value, mut gradient) = (0.0, DVec2::ZERO);
        for j in 0..4 {
            let start = (row + j) * self.counts[0] + column;
            let line = &self.coefficients[start..start + 4];
            let (mut sum, mut slope) = (0.0, 0.0);
            for i in 0..4 {
                sum += across[i] * line[i];
                slope += across_slopes[i] * line[i];
            }
            value += up[j] * sum;
            gradient += DVec2::new(up[j] * slope, up_slopes[j] * sum);
        }
        Some((value, gradient / self.cell))
    }
}

/// Weights of the uniform cubic B-spline at `t` in a cell, and their derivatives.
fn weights(t: f64) -> ([f64; 4], [f64; 4]) {
    let rest = 1.0 - t;
    let (square, rest_square) = (t * t, rest * rest);
    let values = [
        rest * rest_square / 6.0,
        (4.0 - 3.0 * square * (2.0 - t)) / 6.0,
        (4.0 - 3.0 * rest_square * (1.0 + t)) / 6.0,
        t * square / 6.0,
    ];
    let slopes = [-0.5 * rest_square, t * (1.5 * t - 2.0), rest * (0.5 + 1.5 * t), 0.5 * square];
    (values, slopes)
}

/// Turns samples along a line into coefficients, in place. The samples are mirrored at both ends; a
/// causal and an anticausal recursive filter are applied.
fn prefilter(values: &mut [f64], start: usize, stride: usize, count: usize) {
    let at = |index: usize| start + index * stride;
    let mut power = 1.0;
    let mut first = 0.0;
    for index in 0..START_TERMS.min(count) {
        first += power * values[at(index)];
        power *= POLE;
    }
    values[at(0)] = first;
    for index in 1..count {
        values[at(index)] += POLE * values[at(index - 1)];
    }
    let last = count - 1;
    values[at(last)] = POLE / (POLE * POLE - 1.0) * (values[at(last)] + POLE * values[at(last - 1)]);
    for index in (0..last).rev() {
        values[at(index)] = POLE * (values[at(index + 1)] - values[at(index)]);
    }
    for index in 0..count {
        values[at(index)] *= 6.0;
    }
}

/// Whether all corners are on one side of each edge.
fn is_convex(polygon: &[DVec2], size: f64) -> bool {
    let tolerance = STRAIGHTNESS * size * size;
    (0..polygon.len()).all(|index| {
        let (start, edge) = (polygon[index], polygon[(index + 1) % polygon.len()] - polygon[index]);
        let sides = polygon.iter().map(|&corner| edge.perp_dot(corner - start));
        let (least, greatest) =
            sides.fold((0.0, 0.0), |(least, greatest), side| (f64::min(least, side), f64::max(greatest, side)));
        least >= -tolerance || greatest <= tolerance
    })
}

/// The samples of a distance without the kinks outside.
fn smoothed(samples: &[f64], [nx, ny]: [usize; 2], cell: f64, support: f64) -> Vec<f64> {
    let single = samples.iter().map(|&sample| sample as f32).collect();
    match SmoothDistance::smooth_samples(single, [nx, ny, 1], cell, support, &NoProgress) {
        Ok(smooth) => smooth.into_iter().map(f64::from).collect(),
        // Not reached: nothing cancels.
        Err(_) => samples.to_vec(),
    }
}

/// Exact distance from a closed polygon, negative where the winding number is nonzero.
fn signed_distance(polygon: &[DVec2], point: DVec2) -> f64 {
    let mut squared = f64::INFINITY;
    let mut winding = 0;
    for (index, &start) in polygon.iter().enumerate() {
        let end = polygon[(index + 1) % polygon.len()];
        let (edge, offset) = (end - start, point - start);
        let length_squared = edge.length_squared();
        let fraction = if length_squared > 0.0 { (offset.dot(edge) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
        squared = squared.min((offset - edge * fraction).length_squared());
        let side = edge.perp_dot(offset);
        if start.y <= point.y && end.y > point.y && side > 0.0 {
            winding += 1;
        } else if start.y > point.y && end.y <= point.y && side < 0.0 {
            winding -= 1;
        }
    }
    if winding == 0 { squared.sqrt() } else { -squared.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arrow with a notch.
    fn arrow() -> Vec<DVec2> {
        [[0.0, 0.4], [-0.3, -0.3], [0.0, -0.1], [0.3, -0.3]].map(DVec2::from_array).to_vec()
    }

    fn scattered() -> impl Iterator<Item = DVec2> {
        (1..400).map(f64::from).map(|i| DVec2::new((0.618 * i).fract() - 0.5, (0.7548 * i).fract() - 0.5))
    }

    #[test]
    fn the_interpolant_is_close_to_the_distance() {
        let polygon = arrow();
        let section = Section::new(&polygon, 0.2).unwrap();
        for point in scattered() {
            let (value, gradient) = section.sample(point).unwrap();
            let exact = signed_distance(&polygon, point);
            // At a kink, where the slope changes from −1 to 1, the spline deviates by at most a
            // third of a cell. Outside, the smooth distance is up to a fifth smaller.
            let rounding = 0.34 * section.cell;
            let least = if exact > 0.0 { 0.8 * exact } else { exact };
            assert!((least - rounding..exact + rounding).contains(&value), "{point}: {value} {exact}");
            assert!(gradient.length() < 1.35);
        }
        // Far from kinks, above the sides of the tip, it equals the distance.
        let (value, gradient) = section.sample(DVec2::new(0.35, 0.15)).unwrap();
        assert!((value - signed_distance(&polygon, DVec2::new(0.35, 0.15))).abs() < 1e-4);
        assert!((gradient.length() - 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_gradient_is_that_of_the_interpolant() {
        let section = Section::new(&arrow(), 0.2).unwrap();
        let h = 1e-6;
        for point in scattered() {
            let at = |shift: DVec2| section.sample(point + shift).unwrap().0;
            let difference =
                DVec2::new(at(h * DVec2::X) - at(-h * DVec2::X), at(h * DVec2::Y) - at(-h * DVec2::Y)) / (2.0 * h);
            // Rounding of 1e-16/h, plus h² over the squared cell.
            assert!(difference.distance(section.sample(point).unwrap().1) < 1e-8, "{point}");
        }
    }

    #[test]
    fn the_samples_cover_the_support() {
        let polygon = arrow();
        let section = Section::new(&polygon, 0.2).unwrap();
        for point in scattered().map(|point| 3.0 * point) {
            assert!(section.sample(point).is_some() || signed_distance(&polygon, point) > 0.2);
        }
        assert!(section.depth() > 0.1 && section.depth() < 0.3 && section.radius() > 0.42);
        assert_eq!(section.sample(DVec2::NAN), None);
    }

    #[test]
    fn the_orientation_does_not_matter() {
        let backwards: Vec<DVec2> = arrow().into_iter().rev().collect();
        let point = DVec2::new(0.05, 0.1);
        let values = [arrow(), backwards].map(|polygon| Section::new(&polygon, 0.2).unwrap().sample(point).unwrap().0);
        // The samples are equal up to rounding.
        assert!((values[0] - values[1]).abs() < 1e-14 && values[0] < 0.0);
    }

    #[test]
    fn rejects_sections_without_area() {
        let line = [DVec2::ZERO, DVec2::ONE, DVec2::splat(2.0)];
        assert_eq!(Section::new(&line, 0.1).unwrap_err(), StripError::SectionEmpty);
        assert_eq!(Section::new(&line[..2], 0.1).unwrap_err(), StripError::SectionPoints);
        assert_eq!(Section::new(&[DVec2::ZERO, DVec2::X, DVec2::NAN], 0.1).unwrap_err(), StripError::SectionPoints);
        let flat = [DVec2::ZERO, DVec2::X, DVec2::new(1.0, 1e-6)];
        assert!(matches!(Section::new(&flat, 0.1).unwrap_err(), StripError::SectionCells { .. }));
    }
}
