//! Twist: additional rotation about the tangent, distributed so that frames meet conditions with
//! the smallest motion.
//!
//! Source: Wang et al. 2008, section 6.3. If a frame is rotated by α(s) relative to a
//! rotation-minimizing frame, its squared angular velocity is κ² + α′². The total angular speed
//! (equation 21) is smallest if α′ is proportional to the curvature. The total squared angular
//! speed (equation 24) is smallest if α′ is constant.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::{Frame, Spine};

/// Distribution of twist along a spine.
///
/// # Examples
/// ```
/// use isochore_curve::{Bezier, Spine, TwistLaw, twist_fractions};
///
/// let spine = Spine::sample(&Bezier::s_curve(0.5), 100)?;
/// let even = twist_fractions(&spine, TwistLaw::ArcLength);
/// let curved = twist_fractions(&spine, TwistLaw::Curvature);
/// assert_eq!((even[0], even[100]), (0.0, 1.0));
/// // The curve is straight at its ends: the curvature law starts slowly.
/// assert!(curved[1] < even[1]);
/// # Ok::<(), isochore_curve::SpineError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TwistLaw {
    /// Proportional to arc length: the smallest total squared angular speed. The usual choice.
    #[default]
    ArcLength,
    /// Proportional to the turning of the tangent: the smallest total angular speed. On a straight
    /// spine, where all monotonic laws are equally good, proportional to arc length.
    Curvature,
}

/// Largest total turning of a straight spine, radians. Larger: gentle curves lose the curvature
/// law. Smaller: the rounding of the tangents determines the distribution of the twist.
const STRAIGHT: f64 = 1e-9;

/// Frames with twist.
#[derive(Debug, Clone, PartialEq)]
pub struct TwistedFrames {
    /// One frame per station.
    pub stations: Vec<Frame>,
    /// Rotation of each frame relative to the rotation-minimizing frame, radians.
    pub angles: Vec<f64>,
}

/// A prescribed direction of the reference vector at a station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwistConstraint {
    /// Station on the spine.
    pub station: usize,
    /// Direction of the reference vector. Only the component normal to the tangent counts.
    pub direction: DVec3,
    /// Full turns in addition to the smallest rotation from the previous constraint.
    pub turns: i32,
}

/// Errors when meeting twist constraints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TwistError {
    /// The list of constraints is empty.
    #[error("the list of twist constraints is empty; give at least one")]
    Empty,
    /// The stations of the constraints do not ascend, or one is beyond the end of the spine.
    #[error(
        "twist constraint {index}: its station is not after that of the previous one, or beyond the end of the spine"
    )]
    Station {
        /// The constraint, counted from zero.
        index: usize,
    },
    /// The direction has no component normal to the tangent.
    #[error("twist constraint {index}: its direction is zero, not finite, or parallel to the tangent")]
    Direction {
        /// The constraint, counted from zero.
        index: usize,
    },
}

/// Fraction of the total twist at each station, from 0 at the first to 1 at the last.
pub fn twist_fractions(spine: &Spine, law: TwistLaw) -> Vec<f64> {
    let turning = spine.turning_angles();
    let chords = spine.chords();
    let steps = if law == TwistLaw::Curvature && turning.iter().sum::<f64>() > STRAIGHT { turning } else { chords };
    let mut sums = vec![0.0];
    for (i, step) in steps.iter().enumerate() {
        sums.push(sums[i] + step);
    }
    let total = sums[steps.len()];
    if total > 0.0 {
        sums.iter().map(|sum| sum / total).collect()
    } else {
        // All points coincide: equal steps.
        (0..sums.len()).map(|i| i as f64 / steps.len() as f64).collect()
    }
}

/// Angle about the tangent that rotates the last frame of a closed spine to its first, in (−π, π].
///
/// For rotation-minimizing frames, it equals the total torsion up to full turns.
///
/// # Panics
/// If `frames` is empty.
pub fn closing_angle(frames: &[Frame]) -> f64 {
    frames[frames.len() - 1].angle_to(frames[0].r)
}

/// Twists rotation-minimizing `frames` of a closed `spine` so that the last frame equals the first,
/// with `turns` full turns in addition to the smallest rotation.
///
/// # Panics
/// If there is not one frame per station.
///
/// # Examples
/// ```
/// use isochore_curve::{Spine, TrigonometricCurve, TwistLaw, close_frames, rotation_minimizing_frames};
///
/// let spine = Spine::sample(&TrigonometricCurve::trefoil(), 200)?;
/// let start = spine.default_reference();
/// let frames = rotation_minimizing_frames(&spine, start, Default::default(), Default::default())?;
/// let closed = close_frames(&spine, &frames.stations, TwistLaw::ArcLength, 0);
/// assert!(closed.stations[200].r.distance(closed.stations[0].r) < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn close_frames(spine: &Spine, frames: &[Frame], law: TwistLaw, turns: i32) -> TwistedFrames {
    spread(spine, frames, closing_angle(frames) + TAU * f64::from(turns), law)
}

/// Twists rotation-minimizing `frames` so that the last reference vector points in `direction`,
/// with `turns` full turns in addition to the smallest rotation (equations 18 and 19).
///
/// # Errors
/// [`TwistError::Direction`] if `direction` has no component normal to the last tangent.
///
/// # Panics
/// If there is not one frame per station.
pub fn meet_end_direction(
    spine: &Spine,
    frames: &[Frame],
    direction: DVec3,
    law: TwistLaw,
    turns: i32,
) -> Result<TwistedFrames, TwistError> {
    let angle = angle_to(&frames[frames.len() - 1], direction).ok_or(TwistError::Direction { index: 0 })?;
    Ok(spread(spine, frames, angle + TAU * f64::from(turns), law))
}

/// Twists rotation-minimizing `frames` by `total` radians from end to end.
///
/// # Panics
/// If there is not one frame per station.
pub fn spread(spine: &Spine, frames: &[Frame], total: f64, law: TwistLaw) -> TwistedFrames {
    turn(frames, twist_fractions(spine, law).iter().map(|fraction| total * fraction).collect())
}

/// Twists rotation-minimizing `frames` to meet each constraint, with the smallest rotation between
/// neighboring constraints.
///
/// On an open spine, the twist is constant before the first constraint and after the last. On a
/// closed spine, the twist continues from the last constraint to the first, so that the frames
/// close; the `turns` of the first constraint apply to this interval.
///
/// # Errors
/// - [`TwistError::Empty`] if `constraints` is empty.
/// - [`TwistError::Station`] if the stations do not ascend or one is beyond the spine.
/// - [`TwistError::Direction`] if a direction has no component normal to the tangent.
///
/// # Panics
/// If there is not one frame per station.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{Spine, TwistConstraint, TwistLaw, meet_constraints, rotation_minimizing_frames};
///
/// // A straight spine along z, twisted by a quarter turn.
/// let points: Vec<DVec3> = (0..5).map(|i| DVec3::Z * f64::from(i)).collect();
/// let spine = Spine::new(points, vec![DVec3::Z; 5], false)?;
/// let frames = rotation_minimizing_frames(&spine, DVec3::X, Default::default(), Default::default())?;
/// let [first, last] = [(0, DVec3::X), (4, DVec3::Y)]
///     .map(|(station, direction)| TwistConstraint { station, direction, turns: 0 });
/// let twisted = meet_constraints(&spine, &frames.stations, &[first, last], TwistLaw::ArcLength)?;
/// assert!((twisted.angles[2] - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn meet_constraints(
    spine: &Spine,
    frames: &[Frame],
    constraints: &[TwistConstraint],
    law: TwistLaw,
) -> Result<TwistedFrames, TwistError> {
    let segments = spine.segments();
    let last_station = if spine.is_closed() { segments - 1 } else { segments };
    let fractions = twist_fractions(spine, law);
    let mut angles: Vec<f64> = Vec::new();
    for (index, constraint) in constraints.iter().enumerate() {
        let is_in_order = index == 0 || constraint.station > constraints[index - 1].station;
        if !is_in_order || constraint.station > last_station {
            return Err(TwistError::Station { index });
        }
        let target =
            angle_to(&frames[constraint.station], constraint.direction).ok_or(TwistError::Direction { index })?;
        angles.push(match angles.last() {
            Some(&before) => next_angle(before, target, constraint.turns),
            None => target,
        });
    }
    let (Some(first), Some(last), Some(&first_angle), Some(&last_angle)) =
        (constraints.first(), constraints.last(), angles.first(), angles.last())
    else {
        return Err(TwistError::Empty);
    };
    let mut knots: Vec<(f64, f64)> =
        constraints.iter().zip(&angles).map(|(constraint, &angle)| (fractions[constraint.station], angle)).collect();
    let closing = if spine.is_closed() { closing_angle(frames) } else { 0.0 };
    if spine.is_closed() {
        // After one round, the rotation-minimizing frame lags by the closing angle, and the first
        // constraint applies again.
        let again = next_angle(last_angle, first_angle + closing, first.turns);
        knots.push((fractions[first.station] + 1.0, again));
        knots.insert(0, (fractions[last.station] - 1.0, last_angle - (again - first_angle)));
    }
    Ok(turn(frames, fractions.iter().map(|&fraction| interpolate(&knots, fraction)).collect()))
}

/// The angle closest to `before` that equals `target` up to full turns, plus `turns` full turns.
fn next_angle(before: f64, target: f64, turns: i32) -> f64 {
    before + wrap(target - before) + TAU * f64::from(turns)
}

/// Reduces `angle` by full turns into (−π, π].
fn wrap(angle: f64) -> f64 {
    let wrapped = angle - TAU * libm::round(angle / TAU);
    if wrapped <= -PI { wrapped + TAU } else { wrapped }
}

fn angle_to(frame: &Frame, direction: DVec3) -> Option<f64> {
    let across = direction.try_normalize()?.reject_from_normalized(frame.t);
    // Ten thousand times the rounding error. Below it, the direction counts as parallel to the
    // tangent.
    (across.length() > 1e-12).then(|| frame.angle_to(direction))
}

/// Piecewise linear interpolation of `knots`, constant beyond them.
fn interpolate(knots: &[(f64, f64)], at: f64) -> f64 {
    let next = knots.partition_point(|&(position, _)| position <= at);
    if next == 0 {
        return knots[0].1;
    }
    let (start, value) = knots[next - 1];
    match knots.get(next) {
        Some(&(end, end_value)) => value + (end_value - value) * ((at - start) / (end - start)),
        None => value,
    }
}

fn turn(frames: &[Frame], angles: Vec<f64>) -> TwistedFrames {
    assert_eq!(frames.len(), angles.len(), "one frame per station");
    let stations = frames.iter().zip(&angles).map(|(frame, &angle)| frame.turned(angle)).collect();
    TwistedFrames { stations, angles }
}

/// Σ √(turning² + Δα²), the discrete total angular speed (equation 21), radians.
pub fn total_angular_speed(spine: &Spine, angles: &[f64]) -> f64 {
    spine
        .turning_angles()
        .iter()
        .zip(angles.windows(2))
        .map(|(&turning, pair)| libm::hypot(turning, pair[1] - pair[0]))
        .sum()
}

/// Σ (turning² + Δα²)/chord, the discrete total squared angular speed (equation 24), per model
/// unit.
pub fn total_squared_angular_speed(spine: &Spine, angles: &[f64]) -> f64 {
    spine
        .turning_angles()
        .iter()
        .zip(spine.chords())
        .zip(angles.windows(2))
        .map(|((turning, chord), pair)| {
            let twist = pair[1] - pair[0];
            (turning * turning + twist * twist) / chord
        })
        .sum()
}
