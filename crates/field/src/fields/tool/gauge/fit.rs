//! Fit of the gauge that minimizes the tangential potential on a tool's surface.
//!
//! ```text
//! minimize ∫ |(A + ∇Ψ) tangential|² over the surface
//! ```
//!
//! The flow around the tool is (g′/R) n × (A + ∇Ψ), so a small tangential part gives a slow flow.
//! The surface is sampled along the lines of a grid; the normal equations are solved by
//! elimination.

use glam::DVec3;
use isochore_mesh::{Distance, DistanceBlock, LANES, PointBlock};

use super::{
    Gauge,
    polynomial::{Cubic, POWERS, TERMS},
};
use crate::fields::rigid_motion::RigidMotion;

/// Number of cells along each side of the tool's bounds; the surface is searched between their
/// corners. Larger: the time grows with the cube. Smaller: thin parts are missed.
const CELLS: usize = 48;

/// Ridge added to the diagonal of the normal equations, relative to its mean. Larger: the fit is
/// visibly worse than the optimum. Smaller: terms that vanish on the surface, such as |r|² on a
/// sphere, grow from rounding errors.
const RIDGE: f64 = 1e-9;

/// Relative amount by which a higher degree may raise the largest tangential potential, to allow
/// for rounding and the ridge. Larger: accepts fits with a faster flow. Smaller: rejects good fits.
const MAXIMUM_SLACK: f64 = 1e-6;

/// A surface point relative to the center, its unit normal, and the surface area it represents.
struct Sample {
    position: DVec3,
    normal: DVec3,
    area: f64,
}

impl Gauge {
    /// The `fraction` of the polynomials that minimize the mean of |(A + ∇Ψ) tangential|² over the
    /// surface of `distance`. A is centered on `center`.
    ///
    /// For each basis motion the degree is the highest up to 3 that does not raise the maximum over
    /// the surface.
    pub(crate) fn fitted(distance: &dyn Distance, center: DVec3, fraction: f64) -> Self {
        let samples = surface_samples(distance, center);
        // Scales the coordinates to about one on each axis, so that no term dominates.
        let size = 0.5 * distance.bounds().size();
        let unit = |axis: usize, value: f64| std::array::from_fn::<f64, 3, _>(|i| if i == axis { value } else { 0.0 });
        let motions = std::array::from_fn(|index| {
            let axis = DVec3::from_array(unit(index % 3, 1.0));
            let (linear, angular) = if index < 3 { (axis, DVec3::ZERO) } else { (DVec3::ZERO, axis) };
            let motion = RigidMotion { center: DVec3::ZERO, linear, angular };
            let limit = largest(&samples, &motion, &Cubic::ZERO) * (1.0 + MAXIMUM_SLACK);
            let fits = (1..=3).rev().map(|degree| fit(&samples, &motion, degree, size));
            let best = fits.into_iter().flatten().find(|cubic| largest(&samples, &motion, cubic) <= limit);
            best.unwrap_or(Cubic::ZERO) * fraction
        });
        Self { motions }
    }
}

/// Tangential part of A + ∇Ψ.
fn tangential(sample: &Sample, motion: &RigidMotion, cubic: &Cubic) -> DVec3 {
    (motion.potential(sample.position).0 + cubic.gradient(sample.position)).reject_from_normalized(sample.normal)
}

/// Largest tangential potential over the samples.
fn largest(samples: &[Sample], motion: &RigidMotion, cubic: &Cubic) -> f64 {
    samples.iter().map(|sample| tangential(sample, motion, cubic).length()).fold(0.0, f64::max)
}

/// Points where grid lines through the bounds cross the surface, relative to `center`.
///
/// A line along an axis represents the area of a cell across it, divided by the cosine between axis
/// and normal. Weighted by the squared cosine, the three families of lines add up to the area of
/// the surface.
fn surface_samples(distance: &dyn Distance, center: DVec3) -> Vec<Sample> {
    let bounds = distance.bounds();
    // Slightly larger than the bounds, so that no line runs inside a flat side.
    let bounds = bounds.expanded(0.01 * bounds.size().min_element());
    let cell = bounds.size() / CELLS as f64;
    let mut samples = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for line in 0..CELLS * CELLS {
            let mut start = bounds.min;
            start[u] += (0.5 + (line % CELLS) as f64) * cell[u];
            start[v] += (0.5 + (line / CELLS) as f64) * cell[v];
            let node = |index: usize| {
                let mut point = start;
                point[axis] += index as f64 * cell[axis];
                point
            };
            let mut before: Option<f64> = None;
            for first in (0..=CELLS).step_by(LANES) {
                let nodes: Vec<DVec3> = (first..=CELLS).take(LANES).map(node).collect();
                let mut block = DistanceBlock::FAR;
                distance.sample_into(&PointBlock::gather(&nodes), &mut block);
                for lane in 0..nodes.len() {
                    let value = block.value[lane];
                    if let Some(before) = before.replace(value)
                        && (before < 0.0) != (value < 0.0)
                        && before.is_finite()
                        && value.is_finite()
                    {
                        let mut crossing = nodes[lane];
                        crossing[axis] -= cell[axis] * value / (value - before);
                        let Some((position, normal)) = projected(distance, crossing) else { continue };
                        let area = normal[axis].abs() * cell[u] * cell[v];
                        samples.push(Sample { position: position - center, normal, area });
                    }
                }
            }
        }
    }
    samples
}

/// A point near the surface moved onto it by one Newton step, and the unit normal. The step removes
/// the error of the secant on a curved surface.
fn projected(distance: &dyn Distance, point: DVec3) -> Option<(DVec3, DVec3)> {
    let (rest, gradient) = distance.sample(point);
    let normal = gradient.try_normalize()?;
    Some((point - rest * normal, normal))
}

/// The polynomial of this degree that minimizes |(A + ∇Ψ) tangential|², or `None` if the normal
/// equations are singular, as they are without samples.
fn fit(samples: &[Sample], motion: &RigidMotion, degree: usize, size: DVec3) -> Option<Cubic> {
    let terms = TERMS[degree];
    let scale: Vec<f64> = POWERS[..terms].iter().map(|powers| scale_of(powers, size)).collect();
    let mut matrix = vec![vec![0.0; terms + 1]; terms];
    let mut slopes = vec![DVec3::ZERO; terms];
    for sample in samples {
        let target = motion.potential(sample.position).0.reject_from_normalized(sample.normal);
        for (term, slope) in slopes.iter_mut().enumerate() {
            let mut alone = Cubic::ZERO;
            alone.0[term] = scale[term];
            *slope = alone.gradient(sample.position).reject_from_normalized(sample.normal);
        }
        for row in 0..terms {
            for column in row..terms {
                matrix[row][column] += sample.area * slopes[row].dot(slopes[column]);
            }
            matrix[row][terms] -= sample.area * slopes[row].dot(target);
        }
    }
    // Regularize, then fill the lower triangle from the upper one.
    let ridge = RIDGE * (0..terms).map(|term| matrix[term][term]).sum::<f64>() / terms as f64;
    for row in 0..terms {
        matrix[row][row] += ridge;
        for column in 0..row {
            matrix[row][column] = matrix[column][row];
        }
    }
    let solution = solve(matrix)?;
    let mut cubic = Cubic::ZERO;
    for term in 0..terms {
        cubic.0[term] = solution[term] * scale[term];
    }
    Some(cubic)
}

/// Scale of a term: the inverse of its size at the corner of the bounds, times a length, so that
/// its gradient is about one.
fn scale_of(powers: &[i32; 3], size: DVec3) -> f64 {
    let product: f64 =
        powers.iter().zip(size.to_array()).map(|(&power, size)| (0..power).map(|_| size).product::<f64>()).product();
    size.min_element() / product
}

/// Solves a symmetric positive definite system by elimination. The last column is the right-hand
/// side. Returns `None` if a pivot is not positive.
fn solve(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let count = rows.len();
    for pivot in 0..count {
        let (done, rest) = rows.split_at_mut(pivot + 1);
        let top = &done[pivot];
        if top[pivot].is_nan() || top[pivot] <= 0.0 {
            return None;
        }
        for row in rest {
            let factor = row[pivot] / top[pivot];
            for column in pivot..=count {
                row[column] -= factor * top[column];
            }
        }
    }
    let mut solution = vec![0.0; count];
    for row in (0..count).rev() {
        let known: f64 = (row + 1..count).map(|column| rows[row][column] * solution[column]).sum();
        solution[row] = (rows[row][count] - known) / rows[row][row];
    }
    Some(solution)
}
