//! Closest points on a curve: the nearest point, and all local minima of the distance.

use glam::DVec3;

use crate::Curve;
use crate::quadrature::gauss;

/// Largest turning of the tangent within one piece of a [`ClosestPoint`], radians. Larger: more
/// pieces fail the monotonicity test and are split again at every query. Smaller: more spheres to
/// test.
const PIECE_TURNING: f64 = 0.3;

/// Largest number of halvings of a smooth piece whose turning is too large. Reached only near
/// cusps. Larger: more pieces at cusps. Smaller: loose bounds at cusps.
const PIECE_DEPTH: u32 = 12;

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

/// A point on a curve at which the distance to the query is a local minimum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveProjection {
    /// Parameter on the curve.
    pub parameter: f64,
    /// Position on the curve.
    pub position: DVec3,
    /// Distance from the query, model units.
    pub distance: f64,
}

/// Closest-point queries on a curve, accelerated by bounding spheres of its pieces.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{ClosestPoint, TrigonometricCurve};
///
/// let circle = TrigonometricCurve::helix(1.0, 0.0, (0.0, std::f64::consts::TAU));
/// let search = ClosestPoint::new(circle);
/// let nearest = search.closest(DVec3::new(0.0, 3.0, 0.0));
/// assert!(nearest.position.distance(DVec3::Y) < 1e-15);
/// assert!((nearest.distance - 2.0).abs() < 1e-15);
/// ```
#[derive(Debug, Clone)]
pub struct ClosestPoint<C> {
    curve: C,
    pieces: Vec<Piece>,
    /// Center and radius of each piece, contiguous in memory because every query reads all of them.
    spheres: Vec<(DVec3, f64)>,
}

#[derive(Debug, Clone, Copy)]
struct Piece {
    start: f64,
    end: f64,
    /// Position at the midpoint of the parameter interval.
    center: DVec3,
    /// Largest arc length from the center to an end. No point of the piece is farther from the
    /// center.
    radius: f64,
    /// Position at the start, and the vector from the start to the end.
    chord: [DVec3; 2],
    /// Upper bound of the distance of the piece from its chord: length · turning / 4. The triangle
    /// of the chord and the farthest point turns at most as much as the piece itself.
    height: f64,
    /// If all points of the piece are nearer to the query than this, the piece has at most one
    /// minimum.
    calm_distance: f64,
    is_first: bool,
    is_last: bool,
    /// Parameter at which the slope at the end is evaluated. For the last piece of a closed curve,
    /// it is the start of the domain. Both pieces at the seam then use the same sign, so rounding
    /// cannot lose a minimum between them.
    end_of_slope: f64,
}

impl Piece {
    /// Distance from `query` to the chord, and an estimate of the nearest parameter: that of the
    /// nearest fraction of the chord.
    fn chord_distance(&self, query: DVec3) -> (f64, f64) {
        let [start, chord] = self.chord;
        let offset = query - start;
        let squared = chord.length_squared();
        let fraction = if squared > 0.0 { (offset.dot(chord) / squared).clamp(0.0, 1.0) } else { 0.5 };
        ((offset - chord * fraction).length(), self.start + (self.end - self.start) * fraction)
    }
}

/// Half the derivative of the squared distance with respect to the parameter.
struct Slope {
    value: f64,
    /// Derivative of `value`, for Newton's method.
    derivative: f64,
    /// A positive multiple of the derivative with respect to arc length, 1 − κ n · (query − x).
    /// Unlike `derivative`, it does not depend on the parametrization. An interval of constant sign
    /// has at most one root.
    rise: f64,
}

impl<C: Curve> ClosestPoint<C> {
    /// Splits `curve` into pieces and computes their bounds.
    pub fn new(curve: C) -> Self {
        let mut pieces = Vec::new();
        for pair in curve.breaks().windows(2) {
            cut(&curve, pair[0], pair[1], PIECE_DEPTH, &mut pieces);
        }
        let last = pieces.len() - 1;
        pieces[0].is_first = !curve.is_closed();
        pieces[last].is_last = !curve.is_closed();
        if curve.is_closed() {
            pieces[last].end_of_slope = pieces[0].start;
        }
        let spheres = pieces.iter().map(|piece| (piece.center, piece.radius)).collect();
        Self { curve, pieces, spheres }
    }

    /// The curve.
    pub fn curve(&self) -> &C {
        &self.curve
    }

    /// Minimum and maximum corner of a box that contains the curve.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let ends = |piece: &Piece| [piece.chord[0], piece.chord[0] + piece.chord[1]];
        self.pieces.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), piece| {
            let [start, end] = ends(piece);
            (low.min(start.min(end) - piece.height), high.max(start.max(end) + piece.height))
        })
    }

    /// Returns the point of the curve nearest to `query`. If several are equally near, returns the
    /// one with the smallest parameter.
    pub fn closest(&self, query: DVec3) -> CurveProjection {
        let mut squared = f64::INFINITY;
        let mut nearest = 0;
        for (index, (center, _)) in self.spheres.iter().enumerate() {
            let distance = center.distance_squared(query);
            if distance < squared {
                squared = distance;
                nearest = index;
            }
        }
        let piece = &self.pieces[nearest];
        let mut best = CurveProjection {
            parameter: 0.5 * (piece.start + piece.end),
            position: piece.center,
            distance: squared.sqrt(),
        };
        // Search the piece with the nearest center first. Its result bounds the search of the
        // others.
        self.improve(piece, query, &mut best);
        for (index, (center, radius)) in self.spheres.iter().enumerate() {
            let reach = best.distance + radius;
            if index != nearest && center.distance_squared(query) <= reach * reach {
                self.improve(&self.pieces[index], query, &mut best);
            }
        }
        best
    }

    /// Updates `best` with the minima of a piece, unless its chord shows that all are farther.
    fn improve(&self, piece: &Piece, query: DVec3, best: &mut CurveProjection) {
        let (chord_distance, guess) = piece.chord_distance(query);
        if chord_distance - piece.height > best.distance {
            return;
        }
        self.minima(piece, query, guess, &mut |found| {
            let is_tie = found.distance == best.distance && found.parameter < best.parameter;
            if found.distance < best.distance || is_tie {
                *best = found;
            }
        });
    }

    /// Returns the nearest points of many queries, in the same order.
    pub fn closest_many(&self, queries: &[DVec3]) -> Vec<CurveProjection> {
        queries.iter().map(|&query| self.closest(query)).collect()
    }

    /// Returns all local minima of the distance to `query` up to the distance `within`, nearest
    /// first.
    ///
    /// An end of an open curve is a minimum if the distance grows from it. A query at the center of
    /// an arc has no isolated minimum, but [`closest`](Self::closest) still returns a point.
    ///
    /// # Examples
    /// ```
    /// use glam::DVec3;
    /// use isochore_curve::{Bezier, ClosestPoint};
    ///
    /// // An arch: a point below its top is near both of its legs.
    /// let arch = Bezier::new([(-1.0, 0.0), (-1.0, 4.0), (1.0, 4.0), (1.0, 0.0)].map(|(x, y)| DVec3::new(x, y, 0.0)).into());
    /// let search = ClosestPoint::new(&arch);
    /// let branches = search.branches(DVec3::new(0.1, 0.5, 0.0), 2.0);
    /// assert_eq!(branches.len(), 2);
    /// assert_eq!(branches[0], search.closest(DVec3::new(0.1, 0.5, 0.0)));
    /// ```
    pub fn branches(&self, query: DVec3, within: f64) -> Vec<CurveProjection> {
        let mut found = Vec::new();
        for piece in &self.pieces {
            let (chord_distance, guess) = piece.chord_distance(query);
            if chord_distance - piece.height <= within {
                self.minima(piece, query, guess, &mut |branch| {
                    if branch.distance <= within {
                        found.push(branch);
                    }
                });
            }
        }
        found.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.parameter.total_cmp(&b.parameter)));
        found
    }

    fn project(&self, parameter: f64, query: DVec3) -> CurveProjection {
        let position = self.curve.position(parameter);
        CurveProjection { parameter, position, distance: position.distance(query) }
    }

    fn slope(&self, parameter: f64, query: DVec3) -> Slope {
        let jet = self.curve.jet(parameter);
        let offset = jet.position - query;
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
    /// and the ends of an open curve.
    fn minima(&self, piece: &Piece, query: DVec3, guess: f64, report: &mut impl FnMut(CurveProjection)) {
        let start = self.slope(piece.start, query);
        let end = self.slope(piece.end_of_slope, query);
        if piece.is_first && start.value >= 0.0 {
            report(self.project(piece.start, query));
        }
        if piece.is_last && end.value < 0.0 {
            report(self.project(piece.end, query));
        }
        if piece.center.distance(query) + piece.radius <= piece.calm_distance {
            if start.value < 0.0 && end.value >= 0.0 {
                report(self.project(self.root(piece.start, piece.end, guess, query), query));
            }
            return;
        }
        self.roots((piece.start, &start), (piece.end, &end), query, QUERY_DEPTH, report);
    }

    /// Reports the minima in (low, high]. Halves the interval until `rise` has one sign on it.
    fn roots(
        &self,
        (low, at_low): (f64, &Slope),
        (high, at_high): (f64, &Slope),
        query: DVec3,
        depth: u32,
        report: &mut impl FnMut(CurveProjection),
    ) {
        let middle = 0.5 * (low + high);
        let at_middle = self.slope(middle, query);
        let is_rising = at_low.rise > 0.0 && at_middle.rise > 0.0 && at_high.rise > 0.0;
        let is_falling = at_low.rise < 0.0 && at_middle.rise < 0.0 && at_high.rise < 0.0;
        if depth == 0 || is_rising {
            if at_low.value < 0.0 && at_high.value >= 0.0 {
                report(self.project(self.root(low, high, middle, query), query));
            }
        } else if !is_falling {
            self.roots((low, at_low), (middle, &at_middle), query, depth - 1, report);
            self.roots((middle, &at_middle), (high, at_high), query, depth - 1, report);
        }
    }

    /// Root of the slope in (low, high], by Newton's method with bisection. The slope is negative
    /// at `low` and not negative at `high`.
    fn root(&self, mut low: f64, mut high: f64, guess: f64, query: DVec3) -> f64 {
        let size = high - low;
        let mut parameter = guess;
        for _ in 0..STEPS {
            let slope = self.slope(parameter, query);
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

/// Halves [start, end] until its turning is at most [`PIECE_TURNING`], and appends the parts to
/// `pieces`.
fn cut(curve: &impl Curve, start: f64, end: f64, depth: u32, pieces: &mut Vec<Piece>) {
    let middle = 0.5 * (start + end);
    // Integrate the turning: differences of sampled tangents would miss full turns.
    let turning = gauss(&mut |u| curve.jet(u).tangent_derivative().length(), start, end);
    if turning > PIECE_TURNING && depth > 0 {
        cut(curve, start, middle, depth - 1, pieces);
        cut(curve, middle, end, depth - 1, pieces);
        return;
    }
    let speed = &mut |u| curve.jet(u).speed();
    // The margins cover rounding and the quadrature error, which is small because the turning is.
    let (left, right) = (gauss(speed, start, middle), gauss(speed, middle, end));
    let radius = left.max(right) * (1.0 + 1e-6);
    let height = (0.25 * turning * (1.0 + 1e-3) * (left + right)).min(2.0 * radius);
    // Queries nearer than the center of curvature have no second minimum. The factor allows for the
    // error of the sampled curvature.
    let samples = [0.0, 0.25, 0.5, 0.75, 1.0].map(|fraction| curve.jet(start + (end - start) * fraction));
    let curvature = samples.iter().map(|jet| jet.curvature()).fold(0.0, f64::max);
    let (first, last) = (curve.position(start), curve.position(end));
    pieces.push(Piece {
        start,
        end,
        center: curve.position(middle),
        radius,
        chord: [first, last - first],
        height,
        calm_distance: 0.7 / curvature,
        is_first: false,
        is_last: false,
        end_of_slope: end,
    });
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Bezier, CubicSpline, EndCondition, Parametrization, TrigonometricCurve};

    /// Distance to the nearest of many samples: an upper bound, accurate up to the sampling error.
    fn brute_force(curve: &impl Curve, query: DVec3, samples: usize) -> f64 {
        let (first, last) = curve.domain();
        (0..=samples)
            .map(|i| curve.position(first + (last - first) * i as f64 / samples as f64).distance(query))
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn points_beside_a_helix_have_one_branch_per_turn() {
        let helix = TrigonometricCurve::helix(1.0, 0.05, (0.0, 4.0 * std::f64::consts::TAU));
        let search = ClosestPoint::new(&helix);
        // A point outside the helix, beside its second turn.
        let query = helix.position(2.0 * std::f64::consts::TAU) * DVec3::new(1.5, 1.0, 1.0);
        let branches = search.branches(query, 10.0);
        assert_eq!(branches.len(), 5, "one minimum on each of the turns 0 to 4: {branches:?}");
        assert!((branches[0].distance - 0.5).abs() < 1e-14);
        for pair in branches.windows(2) {
            assert!(pair[0].distance <= pair[1].distance);
        }
    }

    #[test]
    fn bounds_contain_the_curve_tightly() {
        let knot = TrigonometricCurve::torus_knot();
        let (low, high) = ClosestPoint::new(&knot).bounds();
        let samples = (0..1000).map(|i| knot.position(f64::from(i) * 0.001 * std::f64::consts::TAU));
        let (min, max) =
            samples.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        assert!(low.cmple(min).all() && high.cmpge(max).all());
        // Pieces are shorter than 0.15 and turn by at most 0.3: a quarter of the product is 0.011.
        assert!((min - low).max_element() < 0.012 && (high - max).max_element() < 0.012);
    }

    #[test]
    fn ends_of_open_curves_are_branches() {
        let line = Bezier::new(vec![DVec3::ZERO, DVec3::X]);
        let search = ClosestPoint::new(&line);
        let before = search.closest(DVec3::new(-2.0, 1.0, 0.0));
        assert_eq!((before.parameter, before.position), (0.0, DVec3::ZERO));
        let after = search.closest(DVec3::new(2.0, 1.0, 0.0));
        assert_eq!((after.parameter, after.position), (1.0, DVec3::X));
        assert!((search.closest(DVec3::new(0.25, 3.0, 0.0)).parameter - 0.25).abs() < 1e-15);
    }

    #[test]
    fn points_at_the_seam_of_a_closed_curve_are_found() {
        let knot = TrigonometricCurve::torus_knot();
        let search = ClosestPoint::new(&knot);
        for shift in [-1e-15, 0.0, 1e-15] {
            let query = knot.position(shift) + knot.jet(shift).normal().unwrap() * 0.05;
            // The query is 0.05 from the seam, within the radius of curvature.
            assert!((search.closest(query).distance - 0.05).abs() < 1e-14);
        }
    }

    #[test]
    fn the_center_of_a_circle_has_a_closest_point() {
        let circle = TrigonometricCurve::helix(2.0, 0.0, (0.0, std::f64::consts::TAU));
        let found = ClosestPoint::new(&circle).closest(DVec3::ZERO);
        assert!((found.distance - 2.0).abs() < 1e-15);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn no_sample_is_nearer_than_the_closest_point(
            coordinates in prop::collection::vec(-1.0..1.0f64, 18),
            query in prop::array::uniform3(-1.5..1.5f64),
            closed: bool,
        ) {
            let points: Vec<DVec3> = coordinates.chunks(3).map(DVec3::from_slice).collect();
            let spline = if closed {
                CubicSpline::closed(&points, Parametrization::Centripetal)
            } else {
                CubicSpline::open(&points, Parametrization::Centripetal, EndCondition::Natural)
            }.unwrap();
            let query = DVec3::from_array(query);
            let search = ClosestPoint::new(&spline);
            let found = search.closest(query);
            let sampled = brute_force(&spline, query, 20_000);
            prop_assert!(found.distance <= sampled + 1e-15, "{}, sampled {sampled}", found.distance);
            // Samples are at most 1e-3 apart, and the distance has slope one.
            prop_assert!(found.distance >= sampled - 1e-3);
            prop_assert!((spline.position(found.parameter) - found.position).length() == 0.0);
            // The closest point is the first of the branches.
            let branches = search.branches(query, f64::INFINITY);
            prop_assert!((branches[0].distance - found.distance).abs() < 1e-14);
        }
    }

    #[test]
    fn all_branches_are_found() {
        // The sign changes of the sampled slope are the minima. No two minima of these queries
        // merge.
        let knot = TrigonometricCurve::torus_knot();
        let search = ClosestPoint::new(&knot);
        for query in [DVec3::new(0.1, 0.2, 0.05), DVec3::new(0.6, 0.1, 0.0), DVec3::new(1.4, 0.3, -0.2)] {
            let samples = 100_000;
            let slope = |i: usize| {
                let jet = knot.jet(std::f64::consts::TAU * i as f64 / samples as f64);
                (jet.position - query).dot(jet.first)
            };
            let expected = (0..samples).filter(|&i| slope(i) < 0.0 && slope(i + 1) >= 0.0).count();
            let found = search.branches(query, f64::INFINITY);
            assert_eq!(found.len(), expected, "query {query}");
        }
    }
}
