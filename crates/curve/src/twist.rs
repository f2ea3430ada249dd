//! Extra rotation about the tangent, spread so that frames meet conditions with the least motion.
//!
//! Source: Wang et al. 2008, section 6.3. The angular velocity of a frame turned by α(s) against a rotation-minimizing
//! one has the square κ² + α′². Its least total (equation 21) makes α′ proportional to the curvature, its least total
//! square (equation 24) makes it constant.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::{Frame, Spine};

/// How extra rotation is spread along a spine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TwistLaw {
    /// Proportional to arc length: the least total squared angular speed. The usual choice.
    #[default]
    ArcLength,
    /// Proportional to turning: the least total angular speed. On a straight spine, where every monotonic law is as
    /// good, proportional to arc length.
    Curvature,
}

/// Total turning below this, radians, is a straight spine. Larger: gentle curves lose the curvature law. Smaller: the
/// rounding of the tangents decides where the twist goes.
const STRAIGHT: f64 = 1e-9;

/// Frames with an extra rotation about the tangent.
#[derive(Debug, Clone, PartialEq)]
pub struct TwistedFrames {
    /// One frame a station.
    pub stations: Vec<Frame>,
    /// Rotation of each against the rotation-minimizing frame, radians.
    pub angles: Vec<f64>,
}

/// A direction that the reference vector must have at a station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwistConstraint {
    /// Station on the spine.
    pub station: usize,
    /// Where the reference vector points; the part normal to the tangent counts.
    pub direction: DVec3,
    /// Full turns beyond the least rotation since the constraint before.
    pub turns: i32,
}

/// Why constraints cannot be met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TwistError {
    /// There is no constraint.
    #[error("there is no constraint")]
    Empty,
    /// The stations of the constraints do not ascend, or one is beyond the spine.
    #[error("constraint {index} is not after the one before it, or beyond the end of the spine")]
    Station {
        /// The constraint, counted from zero.
        index: usize,
    },
    /// The direction has no part normal to the tangent.
    #[error("constraint {index} has a direction that is zero, not finite, or along the tangent")]
    Direction {
        /// The constraint, counted from zero.
        index: usize,
    },
}

/// Share of the whole twist that each station has, from 0 at the first to 1 at the last.
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
        // All points coincide: equal shares.
        (0..sums.len()).map(|i| i as f64 / steps.len() as f64).collect()
    }
}

/// Angle about the tangent that takes the last frame of a closed spine to its first, in (−π, π].
///
/// For a rotation-minimizing frame it is the total torsion up to full turns.
///
/// # Panics
/// If there are no frames.
pub fn closing_angle(frames: &[Frame]) -> f64 {
    frames[frames.len() - 1].angle_to(frames[0].r)
}

/// Twists rotation-minimizing `frames` of a closed `spine` so that the last is the first, with `turns` full turns
/// beyond the least rotation.
///
/// # Panics
/// If there is not one frame a station.
pub fn close_frames(spine: &Spine, frames: &[Frame], law: TwistLaw, turns: i32) -> TwistedFrames {
    spread(spine, frames, closing_angle(frames) + TAU * f64::from(turns), law)
}

/// Twists rotation-minimizing `frames` so that the last has its reference vector along `direction`, with `turns` full
/// turns beyond the least rotation (equations 18 and 19).
///
/// # Errors
/// [`TwistError::Direction`] where `direction` has no part normal to the last tangent.
///
/// # Panics
/// If there is not one frame a station.
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
/// If there is not one frame a station.
pub fn spread(spine: &Spine, frames: &[Frame], total: f64, law: TwistLaw) -> TwistedFrames {
    turn(frames, twist_fractions(spine, law).iter().map(|share| total * share).collect())
}

/// Twists rotation-minimizing `frames` so that each constraint is met, by the least rotation between neighboring ones.
///
/// Before the first and after the last constraint an open spine carries no further twist. A closed spine turns on from
/// the last to the first, whose `turns` count for that way round, and so closes.
///
/// # Errors
/// No constraints, stations out of order, and directions along the tangent.
///
/// # Panics
/// If there is not one frame a station.
pub fn meet_constraints(
    spine: &Spine,
    frames: &[Frame],
    constraints: &[TwistConstraint],
    law: TwistLaw,
) -> Result<TwistedFrames, TwistError> {
    let segments = spine.segments();
    let last_station = if spine.is_closed() { segments - 1 } else { segments };
    let shares = twist_fractions(spine, law);
    let mut angles: Vec<f64> = Vec::new();
    for (index, constraint) in constraints.iter().enumerate() {
        let is_in_order = index == 0 || constraint.station > constraints[index - 1].station;
        if !is_in_order || constraint.station > last_station {
            return Err(TwistError::Station { index });
        }
        let wanted =
            angle_to(&frames[constraint.station], constraint.direction).ok_or(TwistError::Direction { index })?;
        angles.push(match angles.last() {
            Some(&before) => next_angle(before, wanted, constraint.turns),
            None => wanted,
        });
    }
    let (Some(first), Some(last), Some(&first_angle), Some(&last_angle)) =
        (constraints.first(), constraints.last(), angles.first(), angles.last())
    else {
        return Err(TwistError::Empty);
    };
    let mut knots: Vec<(f64, f64)> =
        constraints.iter().zip(&angles).map(|(constraint, &angle)| (shares[constraint.station], angle)).collect();
    let closing = if spine.is_closed() { closing_angle(frames) } else { 0.0 };
    if spine.is_closed() {
        // Once round, the rotation-minimizing frame lags by the closing angle; the first constraint comes again there.
        let again = next_angle(last_angle, first_angle + closing, first.turns);
        knots.push((shares[first.station] + 1.0, again));
        knots.insert(0, (shares[last.station] - 1.0, last_angle - (again - first_angle)));
    }
    Ok(turn(frames, shares.iter().map(|&share| interpolate(&knots, share)).collect()))
}

/// The angle closest to `before` that is `wanted` up to full turns, and `turns` turns more.
fn next_angle(before: f64, wanted: f64, turns: i32) -> f64 {
    before + wrap(wanted - before) + TAU * f64::from(turns)
}

/// `angle` up to full turns, in (−π, π].
fn wrap(angle: f64) -> f64 {
    let wrapped = angle - TAU * libm::round(angle / TAU);
    if wrapped <= -PI { wrapped + TAU } else { wrapped }
}

fn angle_to(frame: &Frame, direction: DVec3) -> Option<f64> {
    let across = direction.try_normalize()?.reject_from_normalized(frame.t);
    // Ten thousand times rounding: below it the direction is along the tangent.
    (across.length() > 1e-12).then(|| frame.angle_to(direction))
}

/// Piecewise linear through `knots`, constant beyond them.
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
    assert_eq!(frames.len(), angles.len(), "one frame a station");
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

/// Σ (turning² + Δα²)/chord, the discrete total squared angular speed (equation 24), per model unit.
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
