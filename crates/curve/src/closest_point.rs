//! Closest points on a curve: the nearest point, and all local minima of the distance.

use glam::DVec3;

use crate::Curve;

mod piece;
mod query;

use piece::{Piece, split};
use query::Query;

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

impl<C: Curve> ClosestPoint<C> {
    /// Splits `curve` into pieces and computes their bounds.
    pub fn new(curve: C) -> Self {
        let pieces = split(&curve);
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
        Query { curve: &self.curve, point: query }.minima(piece, guess, &mut |found| {
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
                Query { curve: &self.curve, point: query }.minima(piece, guess, &mut |branch| {
                    if branch.distance <= within {
                        found.push(branch);
                    }
                });
            }
        }
        found.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.parameter.total_cmp(&b.parameter)));
        found
    }
}

#[cfg(test)]
mod tests;
