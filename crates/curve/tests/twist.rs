//! Twist on the torus knot and the cinquefoil: golden closing angles, laws, turns and constraints.
#![allow(clippy::excessive_precision, reason = "golden values keep all computed digits")]

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use isochore_curve::{
    Curve, DegenerateSegment, Frame, FrameMethod, Spine, TrigonometricCurve, TwistConstraint, TwistError, TwistLaw,
    close_frames, closing_angle, exact_frames, length, meet_constraints, meet_end_direction,
    rotation_minimizing_frames, spread, total_angular_speed, total_curvature, total_squared_angular_speed,
    total_squared_curvature, twist_fractions, uniform_parameters,
};

fn reflected(curve: &impl Curve, segments: usize) -> (Spine, Vec<Frame>) {
    let spine = Spine::sample(curve, segments).unwrap();
    let normal = curve.jet(curve.domain().0).normal().unwrap();
    let frames =
        rotation_minimizing_frames(&spine, normal, FrameMethod::DoubleReflection, DegenerateSegment::Refuse).unwrap();
    (spine, frames.stations)
}

fn closing(curve: &impl Curve, segments: usize) -> f64 {
    closing_angle(&reflected(curve, segments).1)
}

#[test]
fn closing_angles_are_golden() {
    let torus = TrigonometricCurve::torus_knot();
    for (segments, expected) in [(64, -2.88081009219216494), (128, -2.8760360071374965), (256, -2.87573233539939928)] {
        assert!((closing(&torus, segments) - expected).abs() < 2e-13, "{segments}");
    }
    let cinquefoil = TrigonometricCurve::cinquefoil();
    assert!((closing(&cinquefoil, 128) + 1.40770454955428289).abs() < 2e-13);
    // The exact angles, by quadrature and by extrapolation of double reflection.
    for (curve, exact) in [(&torus, -2.87571199786589409), (&cinquefoil, -1.40770198936073335)] {
        let (first, last) = curve.domain();
        let frames = exact_frames(curve, &[first, last], curve.jet(first).normal().unwrap()).unwrap();
        assert!((closing_angle(&frames) - exact).abs() < 1e-12);
        let extrapolated = (16.0 * closing(curve, 2048) - closing(curve, 1024)) / 15.0;
        assert!((extrapolated - exact).abs() < 3e-12, "{extrapolated}, exact {exact}");
    }
}

/// If the closing angle is near half a turn, the smallest rotation changes sign as samples get
/// finer.
#[test]
fn the_sign_of_the_smallest_twist_depends_on_the_samples() {
    let torus = TrigonometricCurve::torus_knot();
    for (segments, expected) in [(12, 0.451), (16, 2.374), (20, 2.953), (24, -3.105), (32, -2.952)] {
        assert!((closing(&torus, segments) - expected).abs() < 6e-4, "{segments}");
    }
}

#[test]
fn closed_frames_have_the_golden_angles() {
    let (spine, frames) = reflected(&TrigonometricCurve::torus_knot(), 64);
    assert!((spine.chords().iter().sum::<f64>() - 15.097598937443747).abs() < 1e-13);
    assert!((spine.turning_angles().iter().sum::<f64>() - 41.830757001105745).abs() < 1e-13);
    let by_arc = close_frames(&spine, &frames, TwistLaw::ArcLength, 0);
    assert!((by_arc.angles[16] + 0.712412146709796).abs() < 1e-13);
    let expected = DVec3::new(0.4950318467705067, -0.8663057318483883, 0.0667671300087874);
    assert!(by_arc.stations[16].r.distance(expected) < 1e-13);
    let by_turning = close_frames(&spine, &frames, TwistLaw::Curvature, 0);
    assert!((by_turning.angles[16] + 0.717915425071330).abs() < 1e-13);
    let one_turn = close_frames(&spine, &frames, TwistLaw::ArcLength, 1);
    assert!((one_turn.angles[16] - 0.841392994765900).abs() < 1e-13);
    for law in [TwistLaw::ArcLength, TwistLaw::Curvature] {
        for turns in -2..=2 {
            let closed = close_frames(&spine, &frames, law, turns).stations;
            assert!(closed[64].r.distance(closed[0].r) < 1e-14, "the frames close");
            // The knot is symmetric under a half turn about x.
            let half = if turns % 2 == 0 { -DVec3::X } else { DVec3::X };
            assert!(closed[32].r.distance(half) < 1e-13, "{turns} {law:?}: {}", closed[32].r);
        }
    }
}

#[test]
fn each_law_minimizes_its_own_functional() {
    let torus = TrigonometricCurve::torus_knot();
    let (spine, frames) = reflected(&torus, 2048);
    for (turns, least, least_squared) in [
        (0, 42.27556198249936, 116.9336177974233),
        (1, 42.31505991718741, 117.1509476694474),
        (-1, 43.16061655358788, 121.8521405318822),
    ] {
        let by_arc = close_frames(&spine, &frames, TwistLaw::ArcLength, turns).angles;
        let by_turning = close_frames(&spine, &frames, TwistLaw::Curvature, turns).angles;
        // Sums over chords converge with second order: the relative error is about h² κ²/24 = 2e-5.
        assert!((total_angular_speed(&spine, &by_turning) / least - 1.0).abs() < 2e-5);
        assert!((total_squared_angular_speed(&spine, &by_arc) / least_squared - 1.0).abs() < 2e-5);
        assert!(total_angular_speed(&spine, &by_turning) < total_angular_speed(&spine, &by_arc));
        assert!(total_squared_angular_speed(&spine, &by_arc) < total_squared_angular_speed(&spine, &by_turning));
        // Closed forms of the minima, from the total curvature and the total twist.
        let twist = -2.87571199786589409 + TAU * f64::from(turns);
        assert!((libm::hypot(total_curvature(&torus), twist) - least).abs() < 1e-12);
        let squared = total_squared_curvature(&torus) + twist * twist / length(&torus);
        assert!((squared - least_squared).abs() < 1e-12, "{squared}");
    }
}

#[test]
fn end_directions_are_met() {
    let helix = TrigonometricCurve::helix(1.0, 0.4, (0.0, 9.0));
    let (spine, frames) = reflected(&helix, 90);
    for turns in [0, 3] {
        let twisted = meet_end_direction(&spine, &frames, DVec3::Z, TwistLaw::Curvature, turns).unwrap();
        let last = twisted.stations[90];
        assert!((last.r - DVec3::Z.reject_from_normalized(last.t).normalize()).length() < 1e-14);
        assert!((twisted.angles[90].abs() - PI * f64::from(2 * turns)).abs() <= PI);
    }
    let along = meet_end_direction(&spine, &frames, frames[90].t, TwistLaw::ArcLength, 0);
    assert_eq!(along.unwrap_err(), TwistError::Direction { index: 0 });
}

#[test]
fn straight_spines_replace_the_curvature_law_by_arc_length() {
    let points: Vec<DVec3> = [0.0, 1.0, 4.0].map(|x| DVec3::X * x).to_vec();
    let spine = Spine::new(points, vec![DVec3::X; 3], false).unwrap();
    assert_eq!(twist_fractions(&spine, TwistLaw::Curvature), [0.0, 0.25, 1.0]);
    let nowhere = Spine::new(vec![DVec3::X; 3], vec![DVec3::X; 3], false).unwrap();
    assert_eq!(twist_fractions(&nowhere, TwistLaw::ArcLength), [0.0, 0.5, 1.0]);
}

fn constraints_at(stations: &[usize], directions: &[DVec3]) -> Vec<TwistConstraint> {
    stations
        .iter()
        .zip(directions)
        .map(|(&station, &direction)| TwistConstraint { station, direction, turns: 0 })
        .collect()
}

#[test]
fn six_constraints_are_met_and_the_frame_closes() {
    let (spine, frames) = reflected(&TrigonometricCurve::torus_knot(), 300);
    let stations: Vec<usize> = (0..6).map(|j| 50 * j + 7).collect();
    let constraints = constraints_at(&stations, &[DVec3::Z; 6]);
    let twisted = meet_constraints(&spine, &frames, &constraints, TwistLaw::ArcLength).unwrap();
    for &station in &stations {
        let frame = twisted.stations[station];
        let up = DVec3::Z.reject_from_normalized(frame.t).normalize();
        assert!(frame.r.distance(up) < 1e-13, "station {station}");
    }
    assert!(twisted.stations[300].r.distance(twisted.stations[0].r) < 1e-13);
    // The twist is linear in arc length between neighbors, also across the first station.
    let fractions = twist_fractions(&spine, TwistLaw::ArcLength);
    let rate = |i: usize| (twisted.angles[i + 1] - twisted.angles[i]) / (fractions[i + 1] - fractions[i]);
    assert!((rate(10) - rate(50)).abs() < 1e-9 && (rate(2) - rate(290)).abs() < 1e-9);
}

#[test]
fn constraints_unwrap_from_the_first() {
    let knot = TrigonometricCurve::torus_knot();
    let frames = exact_frames(&knot, &uniform_parameters(&knot, 6), -DVec3::X).unwrap();
    let spine = Spine::sample(&knot, 6).unwrap();
    let stations: Vec<usize> = (0..6).collect();
    let constraints = constraints_at(&stations, &[DVec3::Z; 6]);
    let twisted = meet_constraints(&spine, &frames, &constraints, TwistLaw::ArcLength).unwrap();
    // At u = 0, the z axis is a quarter turn about the tangent from the normal −x.
    assert!((twisted.angles[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    for pair in twisted.angles[..6].windows(2) {
        assert!((pair[1] - pair[0]).abs() <= PI);
    }
    for (frame, twisted) in frames.iter().zip(&twisted.stations) {
        let up = DVec3::Z.reject_from_normalized(frame.t).normalize();
        assert!(twisted.r.distance(up) < 1e-12);
    }
}

#[test]
fn open_spines_have_constant_twist_beyond_the_constraints() {
    let helix = TrigonometricCurve::helix(1.0, 0.4, (0.0, 9.0));
    let (spine, frames) = reflected(&helix, 90);
    let mut constraints = constraints_at(&[30, 60], &[DVec3::Z; 2]);
    constraints[1].turns = 2;
    let twisted = meet_constraints(&spine, &frames, &constraints, TwistLaw::ArcLength).unwrap();
    assert_eq!(twisted.angles[0], twisted.angles[30]);
    assert_eq!(twisted.angles[60], twisted.angles[90]);
    assert!(twisted.angles[60] - twisted.angles[30] > 3.0 * PI);
    let none = meet_constraints(&spine, &frames, &[], TwistLaw::ArcLength);
    assert_eq!(none.unwrap_err(), TwistError::Empty);
    let swapped = constraints_at(&[60, 30], &[DVec3::Z; 2]);
    let swapped = meet_constraints(&spine, &frames, &swapped, TwistLaw::ArcLength);
    assert_eq!(swapped.unwrap_err(), TwistError::Station { index: 1 });
    let beyond = meet_constraints(&spine, &frames, &constraints_at(&[91], &[DVec3::Z]), TwistLaw::ArcLength);
    assert_eq!(beyond.unwrap_err(), TwistError::Station { index: 0 });
    let nothing = meet_constraints(&spine, &frames, &constraints_at(&[1], &[DVec3::ZERO]), TwistLaw::ArcLength);
    assert_eq!(nothing.unwrap_err(), TwistError::Direction { index: 0 });
}

#[test]
fn zero_twist_does_not_change_frames() {
    let (spine, frames) = reflected(&TrigonometricCurve::torus_knot(), 20);
    assert_eq!(spread(&spine, &frames, 0.0, TwistLaw::Curvature).stations, frames);
}
