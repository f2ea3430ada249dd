//! Estimation of tangents from points.
//!
//! Source: Wang et al. 2008, section 6.1, and Zheng's thesis, section 7.1. Corrections: the
//! direction error of the five-point stencils is of fourth order, not of fifth order as printed.
//! The circle weights printed in the thesis give the bisector of the two chords; the weights in
//! this file give the tangent of the circle.

use glam::DVec3;

/// Rule by which [`Spine::from_points`](crate::Spine::from_points) estimates tangents.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TangentRule<'a> {
    /// [`Uniform`](Self::Uniform) if the spacing of the points varies as smoothly as that of
    /// samples at equal steps of a smooth parameter, otherwise [`ArcLength`](Self::ArcLength).
    #[default]
    Automatic,
    /// Five-point stencils for points at equal steps of some smooth parameter: fourth order.
    Uniform,
    /// Five-point stencils on estimated arc lengths, for points at any spacing: fourth order.
    ArcLength,
    /// Five-point stencils on the given ascending parameters, one per point: fourth order. A closed
    /// curve needs one more parameter, at which it returns to the first point.
    Parameters(&'a [f64]),
    /// Tangent of the circle through each point and its neighbors, for any spacing: second order,
    /// exact on circles.
    Circle,
}

/// Errors when estimating tangents. Indices count from zero.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TangentError {
    /// Two neighbors coincide.
    #[error("points {index} and {next} coincide; remove one of them, or give the tangents")]
    RepeatedPoint {
        /// The first of the two.
        index: usize,
        /// The other.
        next: usize,
    },
    /// The differences to the neighboring points cancel, as at a cusp.
    #[error("the neighbors of point {index} do not determine a tangent: it is a cusp, or the samples are too coarse")]
    Undetermined {
        /// The point.
        index: usize,
    },
    /// The parameters are too few, too many, not finite or not ascending.
    #[error("parameter {index} is missing, superfluous, not finite, or not greater than the previous one")]
    Parameter {
        /// The parameter.
        index: usize,
    },
}

/// Points count as uniform samples if the second differences of the logarithm of their spacing are
/// at most this multiple of the squared turning angle. Larger: jittered points get uniform
/// stencils, which do not converge on them. Smaller: coarse uniform samples get arc-length
/// stencils, whose error on such samples is about three times as large.
const ROUGHNESS: f64 = 0.25;

/// Smallest length of a tangent relative to the largest weighted chord. Larger: strongly turning
/// samples are rejected. Smaller: rounding errors are accepted as a direction.
const CANCELLATION: f64 = 1e-10;

/// Unit tangents at `points`. The caller has checked that there are enough points and that all are
/// finite.
pub(crate) fn estimate_tangents(
    points: &[DVec3],
    closed: bool,
    rule: TangentRule<'_>,
) -> Result<Vec<DVec3>, TangentError> {
    let samples = Samples { points, closed };
    match rule {
        TangentRule::Uniform => samples.uniform(),
        TangentRule::Circle => samples.circle(),
        TangentRule::ArcLength => samples.arc_length(),
        TangentRule::Parameters(parameters) => {
            samples.check_parameters(parameters)?;
            samples.on_parameters(parameters)
        }
        TangentRule::Automatic if samples.is_uniform()? => samples.uniform(),
        TangentRule::Automatic => samples.arc_length(),
    }
}

#[derive(Debug, Clone, Copy)]
struct Samples<'a> {
    points: &'a [DVec3],
    closed: bool,
}

impl Samples<'_> {
    fn segments(&self) -> usize {
        if self.closed { self.points.len() } else { self.points.len() - 1 }
    }

    fn at(&self, index: isize) -> DVec3 {
        self.points[index.rem_euclid(self.points.len() as isize) as usize]
    }

    fn chord(&self, index: usize) -> DVec3 {
        self.at(index as isize + 1) - self.points[index]
    }

    /// Chord lengths. Returns an error if one is zero.
    fn chord_lengths(&self) -> Result<Vec<f64>, TangentError> {
        (0..self.segments())
            .map(|index| match self.chord(index).length() {
                0.0 => Err(TangentError::RepeatedPoint { index, next: (index + 1) % self.points.len() }),
                length => Ok(length),
            })
            .collect()
    }

    /// Unit vector along `weighted`, a sum of differences whose largest has the length `scale`.
    fn direction(&self, index: usize, weighted: DVec3, scale: f64) -> Result<DVec3, TangentError> {
        if weighted.length() <= CANCELLATION * scale {
            return Err(TangentError::Undetermined { index });
        }
        weighted.try_normalize().ok_or(TangentError::Undetermined { index })
    }

    fn uniform(&self) -> Result<Vec<DVec3>, TangentError> {
        let count = self.points.len();
        let last = count - 1;
        (0..count)
            .map(|index| {
                let i = index as isize;
                // Weights by offset from this point. The stencils at the end mirror those at the
                // start, with opposite sign.
                let (forward, weights): (bool, &[(isize, f64)]) = match (index, last - index, last) {
                    _ if self.closed => (true, &[(-2, 1.0), (-1, -8.0), (1, 8.0), (2, -1.0)]),
                    (_, _, 1) => (index == 0, &[(1, 1.0)]),
                    (1, _, 2) => (true, &[(-1, -1.0), (1, 1.0)]),
                    (_, _, 2) => (index == 0, &[(0, -3.0), (1, 4.0), (2, -1.0)]),
                    (0 | 3, _, 3) => (index == 0, &[(0, -11.0), (1, 18.0), (2, -9.0), (3, 2.0)]),
                    (_, _, 3) => (index == 1, &[(-1, -2.0), (0, -3.0), (1, 6.0), (2, -1.0)]),
                    (0, _, _) | (_, 0, _) => (index == 0, &[(0, -25.0), (1, 48.0), (2, -36.0), (3, 16.0), (4, -3.0)]),
                    (1, _, _) | (_, 1, _) => (index == 1, &[(-1, -3.0), (0, -10.0), (1, 18.0), (2, -6.0), (3, 1.0)]),
                    _ => (true, &[(-2, 1.0), (-1, -8.0), (1, 8.0), (2, -1.0)]),
                };
                let sign = if forward { 1 } else { -1 };
                let origin = self.points[index];
                let mut scale: f64 = 0.0;
                let sum: DVec3 = weights
                    .iter()
                    .map(|&(offset, weight)| {
                        let difference = (self.at(i + sign * offset) - origin) * (weight * sign as f64);
                        scale = scale.max(difference.length());
                        difference
                    })
                    .sum();
                self.direction(index, sum, scale)
            })
            .collect()
    }

    /// Tangents from the derivative of the polynomial through five neighbors, at ascending
    /// parameters.
    fn on_parameters(&self, parameters: &[f64]) -> Result<Vec<DVec3>, TangentError> {
        let count = self.points.len();
        let width = count.min(5);
        let period = parameters[parameters.len() - 1] - parameters[0];
        let parameter = |index: isize| {
            let turns = index.div_euclid(count as isize);
            parameters[index.rem_euclid(count as isize) as usize] + turns as f64 * period
        };
        (0..count)
            .map(|index| {
                let i = index as isize;
                let start = if self.closed {
                    i - width as isize / 2
                } else {
                    (i - width as isize / 2).clamp(0, (count - width) as isize)
                };
                let neighbors: Vec<isize> = (start..start + width as isize).collect();
                let at = parameter(i);
                let mut scale: f64 = 0.0;
                let mut sum = DVec3::ZERO;
                for &k in neighbors.iter().filter(|&&k| k != i) {
                    // Derivative at point i of the Lagrange polynomial that is one at k and zero at
                    // the others.
                    let mut weight = 1.0 / (parameter(k) - at);
                    for &j in neighbors.iter().filter(|&&j| j != k && j != i) {
                        weight *= (at - parameter(j)) / (parameter(k) - parameter(j));
                    }
                    let difference = (self.at(k) - self.points[index]) * weight;
                    scale = scale.max(difference.length());
                    sum += difference;
                }
                self.direction(index, sum, scale)
            })
            .collect()
    }

    fn check_parameters(&self, parameters: &[f64]) -> Result<(), TangentError> {
        let expected = self.segments() + 1;
        if parameters.len() != expected {
            return Err(TangentError::Parameter { index: parameters.len().min(expected) });
        }
        for (index, parameter) in parameters.iter().enumerate() {
            if !parameter.is_finite() || (index > 0 && *parameter <= parameters[index - 1]) {
                return Err(TangentError::Parameter { index });
            }
        }
        Ok(())
    }

    /// Tangents from stencils on chord lengths, then refined twice on arc lengths. The arc lengths
    /// follow from the chords and the turning of the previous tangents.
    fn arc_length(&self) -> Result<Vec<DVec3>, TangentError> {
        let chords = self.chord_lengths()?;
        let mut tangents = self.on_parameters(&cumulative(&chords))?;
        for _ in 0..2 {
            let arcs: Vec<f64> = chords
                .iter()
                .enumerate()
                .map(|(i, chord)| {
                    let (start, end) = (tangents[i], tangents[(i + 1) % tangents.len()]);
                    let turning = libm::atan2(start.cross(end).length(), start.dot(end));
                    // To leading order, an arc of a circle is longer than its chord by the factor 1
                    // + θ²/24.
                    chord * (1.0 + turning * turning / 24.0)
                })
                .collect();
            tangents = self.on_parameters(&cumulative(&arcs))?;
        }
        Ok(tangents)
    }

    fn circle(&self) -> Result<Vec<DVec3>, TangentError> {
        let lengths = self.chord_lengths()?;
        let count = self.points.len();
        let mut tangents = vec![DVec3::ZERO; count];
        for (index, tangent) in tangents.iter_mut().enumerate() {
            if !self.closed && (index == 0 || index == count - 1) {
                continue;
            }
            let before = (index + lengths.len() - 1) % lengths.len();
            let (a, b) = (self.chord(before), self.chord(index));
            let (a_squared, b_squared) = (a.length_squared(), b.length_squared());
            *tangent = self.direction(index, a * b_squared + b * a_squared, a_squared * b.length())?;
        }
        if !self.closed {
            let mirror = |tangent: DVec3, chord: DVec3| {
                if count == 2 {
                    chord.normalize()
                } else {
                    chord * (2.0 * tangent.dot(chord) / chord.length_squared()) - tangent
                }
            };
            tangents[0] = mirror(tangents[1], self.chord(0));
            tangents[count - 1] = mirror(tangents[count - 2], self.chord(count - 2));
        }
        Ok(tangents)
    }

    /// Returns true if the spacing is consistent with equal steps of a smooth parameter.
    fn is_uniform(&self) -> Result<bool, TangentError> {
        let lengths = self.chord_lengths()?;
        let count = lengths.len();
        let triples = if self.closed { count } else { count.saturating_sub(2) };
        let mut roughness: f64 = 0.0;
        let mut turning: f64 = 0.0;
        for i in 0..triples {
            let [a, b, c] = [i, i + 1, i + 2].map(|k| lengths[k % count]);
            roughness = roughness.max(libm::log(a * c / (b * b)).abs());
        }
        for i in 0..if self.closed { count } else { count - 1 } {
            let (a, b) = (self.chord(i), self.chord((i + 1) % count));
            turning = turning.max(libm::atan2(a.cross(b).length(), a.dot(b)));
        }
        Ok(roughness <= ROUGHNESS * turning * turning)
    }
}

fn cumulative(steps: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0];
    for (i, step) in steps.iter().enumerate() {
        sums.push(sums[i] + step);
    }
    sums
}
