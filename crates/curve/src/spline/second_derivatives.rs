//! Second derivatives of a spline at its points: the unknowns of a linear system whose rows express
//! the continuity of the first derivative.
//!
//! `spacings` are the parameter steps between neighbors, and `slopes` the differences of neighbors
//! divided by them.

use glam::DVec3;

use super::EndCondition;

/// Second derivatives at the points of an open spline.
pub(super) fn of_open(spacings: &[f64], slopes: &[DVec3], end_condition: EndCondition) -> Vec<DVec3> {
    let inner = spacings.len() - 1;
    let mut seconds = vec![DVec3::ZERO; inner + 2];
    if inner == 0 {
        return seconds;
    }
    let mut matrix = Tridiagonal {
        lower: spacings[..inner].to_vec(),
        diagonal: (0..inner).map(|i| 2.0 * (spacings[i] + spacings[i + 1])).collect(),
        upper: spacings[1..].to_vec(),
    };
    let mut right: Vec<DVec3> = (0..inner).map(|i| 6.0 * (slopes[i + 1] - slopes[i])).collect();
    if end_condition == EndCondition::NotAKnot {
        matrix.eliminate_ends(spacings);
    }
    matrix.solve(&mut right);
    seconds[1..=inner].copy_from_slice(&right);
    if end_condition == EndCondition::NotAKnot {
        extrapolate_ends(&mut seconds, spacings);
    }
    seconds
}

/// Second derivatives at the points of a closed spline. Solves a cyclic tridiagonal system with the
/// Sherman–Morrison formula.
pub(super) fn of_closed(spacings: &[f64], slopes: &[DVec3]) -> Vec<DVec3> {
    let count = spacings.len();
    let before = |i: usize| (i + count - 1) % count;
    let mut matrix = Tridiagonal {
        lower: (0..count).map(|i| spacings[before(i)]).collect(),
        diagonal: (0..count).map(|i| 2.0 * (spacings[before(i)] + spacings[i])).collect(),
        upper: spacings.to_vec(),
    };
    let mut right: Vec<DVec3> = (0..count).map(|i| 6.0 * (slopes[i] - slopes[before(i)])).collect();
    // Both corner entries of the matrix equal `corner`. Write the matrix as tridiagonal + u vᵀ with
    // u = (gamma, 0, …, corner) and v = (1, 0, …, corner / gamma), which changes two diagonal
    // entries.
    let corner = spacings[count - 1];
    let gamma = -matrix.diagonal[0];
    matrix.diagonal[0] -= gamma;
    matrix.diagonal[count - 1] -= corner * corner / gamma;
    let mut correction = vec![DVec3::ZERO; count];
    correction[0] = DVec3::splat(gamma);
    correction[count - 1] = DVec3::splat(corner);
    matrix.solve(&mut right);
    matrix.solve(&mut correction);
    let ratio = corner / gamma;
    let denominator = 1.0 + correction[0].x + ratio * correction[count - 1].x;
    let factor = (right[0] + right[count - 1] * ratio) / denominator;
    right.iter().zip(&correction).map(|(&value, &column)| value - factor * column.x).collect()
}

/// Sets the second derivatives at the ends of a not-a-knot spline from those at the inner points.
fn extrapolate_ends(seconds: &mut [DVec3], spacings: &[f64]) {
    let last = seconds.len() - 1;
    if last == 2 {
        // The spline is a parabola: all second derivatives are equal.
        seconds[0] = seconds[1];
        seconds[2] = seconds[1];
        return;
    }
    seconds[0] = seconds[1] + (seconds[1] - seconds[2]) * (spacings[0] / spacings[1]);
    seconds[last] =
        seconds[last - 1] + (seconds[last - 1] - seconds[last - 2]) * (spacings[last - 1] / spacings[last - 2]);
}

/// A diagonally dominant tridiagonal matrix. The first entry of `lower` and the last of `upper` are
/// outside the matrix.
struct Tridiagonal {
    /// Entry left of the diagonal in each row.
    lower: Vec<f64>,
    /// Diagonal.
    diagonal: Vec<f64>,
    /// Entry right of the diagonal in each row.
    upper: Vec<f64>,
}

impl Tridiagonal {
    /// Applies the condition of a not-a-knot spline: the third derivative is continuous at the
    /// second and the second-to-last point. This gives the second derivatives at the ends, which are
    /// eliminated from the first and last rows.
    fn eliminate_ends(&mut self, spacings: &[f64]) {
        let last_row = self.diagonal.len() - 1;
        if last_row == 0 {
            // The spline is a parabola: all second derivatives are equal.
            self.diagonal[0] += spacings[0] + spacings[1];
            return;
        }
        let (first, second) = (spacings[0], spacings[1]);
        self.diagonal[0] += first * (first + second) / second;
        self.upper[0] -= first * first / second;
        let (last, before) = (spacings[last_row + 1], spacings[last_row]);
        self.diagonal[last_row] += last * (last + before) / before;
        self.lower[last_row] -= last * last / before;
    }

    /// Replaces the right-hand side by the solution. Elimination without pivoting is stable because
    /// the matrix is diagonally dominant.
    fn solve(&self, right: &mut [DVec3]) {
        let count = self.diagonal.len();
        let mut pivots = self.diagonal.clone();
        for i in 1..count {
            let factor = self.lower[i] / pivots[i - 1];
            pivots[i] -= factor * self.upper[i - 1];
            let previous = right[i - 1];
            right[i] -= previous * factor;
        }
        right[count - 1] /= pivots[count - 1];
        for i in (0..count - 1).rev() {
            let next = right[i + 1];
            right[i] = (right[i] - next * self.upper[i]) / pivots[i];
        }
    }
}
