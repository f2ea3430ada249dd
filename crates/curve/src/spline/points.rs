//! Checks of the points of a spline, and the parameter steps between them.

use glam::DVec3;

use super::{Parametrization, SplineError};

/// Largest coordinate. Larger: sixth powers of lengths, as in the torsion, overflow. Smaller: no
/// realistic data are rejected down to about 1e30.
pub(crate) const COORDINATE_LIMIT: f64 = 1e50;

/// Parameter steps between neighbors.
pub(super) fn spacings(
    points: &[DVec3],
    parametrization: Parametrization,
    closed: bool,
) -> Result<Vec<f64>, SplineError> {
    check_points(points, if closed { 3 } else { 2 })?;
    let count = points.len();
    let segments = if closed { count } else { count - 1 };
    (0..segments)
        .map(|index| {
            let next = (index + 1) % count;
            let chord = points[index].distance(points[next]);
            if chord == 0.0 {
                return Err(SplineError::RepeatedPoint { index, next });
            }
            Ok(match parametrization {
                Parametrization::Centripetal => chord.sqrt(),
                Parametrization::ChordLength => chord,
            })
        })
        .collect()
}

/// Checks that there are at least `needed` points, with finite coordinates up to
/// [`COORDINATE_LIMIT`].
pub(super) fn check_points(points: &[DVec3], needed: usize) -> Result<(), SplineError> {
    let count = points.len();
    if count < needed {
        return Err(SplineError::TooFewPoints { count, needed });
    }
    // The comparison is false for NaN.
    match points.iter().position(|point| !(point.abs().max_element() <= COORDINATE_LIMIT && point.is_finite())) {
        Some(index) => Err(SplineError::NotFinite { index }),
        None => Ok(()),
    }
}
