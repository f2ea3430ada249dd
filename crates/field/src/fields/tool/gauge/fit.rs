//! The gauge that makes the flow along a tool's surface small.

use glam::DVec3;
use isochore_mesh::{Distance, DistanceBlock, LANES, PointBlock};

use super::{
    Gauge,
    polynomial::{Cubic, POWERS, TERMS},
};
use crate::fields::rigid_motion::RigidMotion;

/// Cells along each side of the tool's bounds, between whose corners its surface is looked for. More: time, growing with the
/// cube. Fewer: thin parts are overlooked.
const CELLS: usize = 48;

/// Added to the diagonal of the normal equations, as a share of its mean. Larger: the fit falls visibly short of the best.
/// Smaller: what does not show on the surface, as |r|² on a sphere, grows out of rounding.
const RIDGE: f64 = 1e-9;

/// A higher degree must not raise the largest speed by more than this share, which leaves room for rounding and the ridge.
const MAXIMUM_SLACK: f64 = 1e-6;

/// A point of the surface: where, the unit normal, and the area it stands for.
struct Sample {
    place: DVec3,
    normal: DVec3,
    area: f64,
}

impl Gauge {
    /// `share` of the polynomials that make |(A + ∇Ψ) along the surface|² least in the mean over the surface of `distance`; A
    /// is centered on `center`.
    ///
    /// Of each basis motion the degree is 3, or the highest below that does not raise the maximum over the surface.
    pub(crate) fn fitted(distance: &dyn Distance, center: DVec3, share: f64) -> Self {
        let samples = surface_samples(distance, center);
        // Coordinates of the order of one along each axis, so that no term drowns the others.
        let size = 0.5 * distance.bounds().size();
        let unit = |axis: usize, value: f64| std::array::from_fn::<f64, 3, _>(|i| if i == axis { value } else { 0.0 });
        let motions = std::array::from_fn(|index| {
            let axis = DVec3::from_array(unit(index % 3, 1.0));
            let (linear, angular) = if index < 3 { (axis, DVec3::ZERO) } else { (DVec3::ZERO, axis) };
            let motion = RigidMotion { center: DVec3::ZERO, linear, angular };
            let limit = largest(&samples, &motion, &Cubic::ZERO) * (1.0 + MAXIMUM_SLACK);
            let fits = (1..=3).rev().map(|degree| fit(&samples, &motion, degree, size));
            let best = fits.into_iter().flatten().find(|cubic| largest(&samples, &motion, cubic) <= limit);
            best.unwrap_or(Cubic::ZERO) * share
        });
        Self { motions }
    }
}

/// (A + ∇Ψ) along the surface.
fn along(sample: &Sample, motion: &RigidMotion, cubic: &Cubic) -> DVec3 {
    (motion.potential(sample.place).0 + cubic.gradient(sample.place)).reject_from_normalized(sample.normal)
}

fn largest(samples: &[Sample], motion: &RigidMotion, cubic: &Cubic) -> f64 {
    samples.iter().map(|sample| along(sample, motion, cubic).length()).fold(0.0, f64::max)
}

/// Points where lines of a grid through the bounds cross the surface, relative to `center`.
///
/// A line along an axis stands for the area of a cell across it, divided by the cosine between axis and normal; a weight of the
/// squared cosine makes the three families of lines add up to the area.
fn surface_samples(distance: &dyn Distance, center: DVec3) -> Vec<Sample> {
    let bounds = distance.bounds();
    // A little more than the bounds, so that no line runs along a flat side.
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
                        let mut place = nodes[lane];
                        place[axis] -= cell[axis] * value / (value - before);
                        // One step down the gradient takes off what the surface's bend adds to the secant.
                        let (rest, gradient) = distance.sample(place);
                        let Some(normal) = gradient.try_normalize() else { continue };
                        let area = normal[axis].abs() * cell[u] * cell[v];
                        samples.push(Sample { place: place - rest * normal - center, normal, area });
                    }
                }
            }
        }
    }
    samples
}

/// The polynomial of this degree that makes |(A + ∇Ψ) along the surface|² least; none where there is no surface.
fn fit(samples: &[Sample], motion: &RigidMotion, degree: usize, size: DVec3) -> Option<Cubic> {
    let terms = TERMS[degree];
    let scale: Vec<f64> = POWERS[..terms].iter().map(|powers| scale_of(powers, size)).collect();
    let mut matrix = vec![vec![0.0; terms + 1]; terms];
    let mut slopes = vec![DVec3::ZERO; terms];
    for sample in samples {
        let target = motion.potential(sample.place).0.reject_from_normalized(sample.normal);
        for (term, slope) in slopes.iter_mut().enumerate() {
            let mut alone = Cubic::ZERO;
            alone.0[term] = scale[term];
            *slope = alone.gradient(sample.place).reject_from_normalized(sample.normal);
        }
        for row in 0..terms {
            for column in row..terms {
                matrix[row][column] += sample.area * slopes[row].dot(slopes[column]);
            }
            matrix[row][terms] -= sample.area * slopes[row].dot(target);
        }
    }
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

/// One over the size of the term at the corner of the bounds, times a length, so that its gradient is of the order of one.
fn scale_of(powers: &[i32; 3], size: DVec3) -> f64 {
    let product: f64 =
        powers.iter().zip(size.to_array()).map(|(&power, size)| (0..power).map(|_| size).product::<f64>()).product();
    size.min_element() / product
}

/// Solves a symmetric positive definite system, whose last column is the right side, by elimination.
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
