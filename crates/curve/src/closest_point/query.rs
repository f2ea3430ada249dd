//! Local minima of the distance from one point to a piece of a curve.

use glam::DVec3;

use super::{CurveProjection, piece::Piece};
use crate::Curve;

/// Largest number of halvings of a piece during a query, if the derivative of the distance is not
/// monotonic. Larger: each step doubles the cost of such queries. Smaller: minima that are close
/// together beyond the center of curvature are missed.
const QUERY_DEPTH: u32 = 6;

/// Largest number of bracketed Newton steps. Larger: no effect, because bisection alone reaches
/// rounding error. Smaller: digits are lost near cusps.
const STEPS: usize = 60;

/// Relative size of the last Newton step, as a fraction of the piece. The error after it is its
/// square. Larger: digits are lost. Smaller: one more step without effect.
const LAST_STEP: f64 = 1e-8;

/// Half the derivative of the squared distance with respect to the parameter.
struct Slope {
    /// The derivative.
    value: f64,
    /// Derivative of `value`, for Newton's method.
    derivative: f64,
    /// A positive multiple of the derivative with respect to arc length, 1 − κ n · (point − x).
    /// Unlike `derivative`, it does not depend on the parametrization. An interval of constant sign
    /// has at most one root.
    rise: f64,
}

/// A search for the points of a curve nearest to one point.
#[derive(Debug)]
pub(super) struct Query<'a, C> {
    /// The curve.
    pub(super) curve: &'a C,
    /// The query point.
    pub(super) point: DVec3,
}

impl<C: Curve> Query<'_, C> {
    /// The point of the curve at `parameter`.
    fn project(&self, parameter: f64) -> CurveProjection {
        let position = self.curve.position(parameter);
        CurveProjection { parameter, position, distance: position.distance(self.point) }
    }

    /// The slope at `parameter`.
    fn slope(&self, parameter: f64) -> Slope {
        let jet = self.curve.jet(parameter);
        let offset = jet.position - self.point;
        let squared_speed = jet.first.length_squared();
        let value = offset.dot(jet.first);
        let bend = offset.dot(jet.second);
        Slope {
            value,
            derivative: squared_speed + bend,
            rise: squared_speed * (squared_speed + bend) - value * jet.second.dot(jet.first),
        }
    }

    /// Reports the local minima of a piece: roots of the slope in (start, end] at which it rises,
    /// and the ends of an open curve. `guess` is a parameter near the root, if there is only one.
    pub(super) fn minima(&self, piece: &Piece, guess: f64, report: &mut impl FnMut(CurveProjection)) {
        let start = self.slope(piece.start);
        let end = self.slope(piece.end_of_slope);
        if piece.is_first && start.value >= 0.0 {
            report(self.project(piece.start));
        }
        if piece.is_last && end.value < 0.0 {
            report(self.project(piece.end));
        }
        if piece.center.distance(self.point) + piece.radius <= piece.calm_distance {
            if start.value < 0.0 && end.value >= 0.0 {
                report(self.project(self.root(piece.start, piece.end, guess)));
            }
            return;
        }
        self.roots((piece.start, &start), (piece.end, &end), QUERY_DEPTH, report);
    }

    /// Reports the minima in (low, high]. Halves the interval until `rise` has one sign on it.
    fn roots(
        &self,
        (low, at_low): (f64, &Slope),
        (high, at_high): (f64, &Slope),
        depth: u32,
        report: &mut impl FnMut(CurveProjection),
    ) {
        let middle = 0.5 * (low + high);
        let at_middle = self.slope(middle);
        let is_rising = at_low.rise > 0.0 && at_middle.rise > 0.0 && at_high.rise > 0.0;
        let is_falling = at_low.rise < 0.0 && at_middle.rise < 0.0 && at_high.rise < 0.0;
        if depth == 0 || is_rising {
            if at_low.value < 0.0 && at_high.value >= 0.0 {
                report(self.project(self.root(low, high, middle)));
            }
        } else if !is_falling {
            self.roots((low, at_low), (middle, &at_middle), depth - 1, report);
            self.roots((middle, &at_middle), (high, at_high), depth - 1, report);
        }
    }

    /// Root of the slope in (low, high], by Newton's method with bisection. The slope is negative
    /// at `low` and not negative at `high`.
    fn root(&self, mut low: f64, mut high: f64, guess: f64) -> f64 {
        let size = high - low;
        let mut parameter = guess;
        for _ in 0..STEPS {
            let slope = self.slope(parameter);
            if slope.value < 0.0 {
                low = parameter;
            } else {
                high = parameter;
            }
            let step = -slope.value / slope.derivative;
            let next = parameter + step;
            if step.abs() <= LAST_STEP * size {
                return next.clamp(low, high);
            }
            parameter = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        parameter
    }
}
