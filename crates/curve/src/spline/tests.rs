//! Tests of [`CubicSpline`]: continuity, order of accuracy, errors.

use std::f64::consts::TAU;

use super::*;
use crate::TrigonometricCurve;

fn helix_points(count: usize) -> (TrigonometricCurve, Vec<DVec3>) {
    let curve = TrigonometricCurve::helix(1.0, 0.4, (0.0, 5.0));
    let points = (0..count).map(|i| curve.position(5.0 * i as f64 / (count - 1) as f64)).collect();
    (curve, points)
}

#[test]
fn passes_through_its_points_with_continuous_second_derivative() {
    let (_, points) = helix_points(9);
    for spline in [
        CubicSpline::open(&points, Parametrization::Centripetal, EndCondition::Natural).unwrap(),
        CubicSpline::open(&points, Parametrization::ChordLength, EndCondition::NotAKnot).unwrap(),
        CubicSpline::closed(&points, Parametrization::Centripetal).unwrap(),
    ] {
        for (i, &point) in points.iter().enumerate() {
            let knot = spline.knots()[i];
            assert!((spline.position(knot) - point).length() < 1e-14);
            if i > 0 && (spline.is_closed() || i + 1 < points.len()) {
                let step = 1e-9;
                let (before, after) = (spline.jet(knot - step), spline.jet(knot + step));
                // The difference is the third derivative times 2e-9, and the third derivative
                // is below 10.
                assert!((before.first - after.first).length() < 1e-7);
                assert!((before.second - after.second).length() < 1e-7);
            }
        }
    }
}

#[test]
fn closed_spline_joins_its_ends_smoothly() {
    let (_, points) = helix_points(7);
    let spline = CubicSpline::closed(&points, Parametrization::ChordLength).unwrap();
    let (first, last) = (spline.jet(0.0), spline.jet(spline.domain().1));
    assert!((first.position - last.position).length() < 1e-14);
    assert!((first.first - last.first).length() < 1e-13);
    assert!((first.second - last.second).length() < 1e-12);
    assert!((spline.position(-0.3) - spline.position(spline.domain().1 - 0.3)).length() < 1e-14, "wraps");
}

#[test]
fn not_a_knot_and_periodic_splines_are_of_fourth_order() {
    let error = |count: usize| {
        let (curve, points) = helix_points(count);
        let spline = CubicSpline::open(&points, Parametrization::ChordLength, EndCondition::NotAKnot).unwrap();
        let scale = 5.0 / spline.domain().1;
        (0..500)
            .map(|i| f64::from(i) / 499.0 * spline.domain().1)
            .map(|u| (spline.position(u) - curve.position(u * scale)).length())
            .fold(0.0, f64::max)
    };
    let ratio = error(81) / error(41);
    assert!((0.055..0.075).contains(&ratio), "1/16 expected, got {ratio}");

    let knot = TrigonometricCurve::torus_knot();
    let radius_error = |count: usize| {
        let points: Vec<DVec3> = (0..count)
            .map(|i| libm::sincos(TAU * i as f64 / count as f64))
            .map(|(s, c)| DVec3::new(c, s, 0.0))
            .collect();
        let spline = CubicSpline::closed(&points, Parametrization::Centripetal).unwrap();
        (0..400)
            .map(|i| (spline.position(spline.domain().1 * f64::from(i) / 400.0).length() - 1.0).abs())
            .fold(0.0, f64::max)
    };
    assert!(knot.is_closed());
    let ratio = radius_error(32) / radius_error(16);
    assert!((0.05..0.07).contains(&ratio), "1/16 expected, got {ratio}");
}

#[test]
fn cubics_are_reproduced_by_not_a_knot() {
    let points: Vec<DVec3> = [0.0, 1.0, 2.0, 3.0, 4.0].map(|t: f64| DVec3::new(t, 0.0, 0.0)).to_vec();
    let line = CubicSpline::open(&points, Parametrization::ChordLength, EndCondition::NotAKnot).unwrap();
    assert!((line.position(1.7) - DVec3::new(1.7, 0.0, 0.0)).length() < 1e-15);
    let three = [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::new(2.0, 0.0, 0.0)];
    let parabola = CubicSpline::open(&three, Parametrization::ChordLength, EndCondition::NotAKnot).unwrap();
    assert!(parabola.jet(0.3).third.length() < 1e-15);
    assert!((parabola.jet(0.0).second - parabola.jet(2.0).second).length() < 1e-15);
    let two = CubicSpline::open(&three[..2], Parametrization::Centripetal, EndCondition::NotAKnot).unwrap();
    assert!((two.position(0.5 * two.domain().1) - DVec3::new(0.5, 0.5, 0.0)).length() < 1e-15);
}

#[test]
fn splines_at_the_same_parameters_depend_linearly_on_their_points() {
    let (_, start) = helix_points(6);
    let end: Vec<DVec3> = start.iter().map(|p| DVec3::new(p.y, 2.0 * p.z, p.x * p.x)).collect();
    let parameters = [0.0, 0.4, 1.0, 1.3, 2.0, 2.6];
    let through = |points: &[DVec3]| CubicSpline::open_at(points, &parameters, EndCondition::Natural).unwrap();
    let between: Vec<DVec3> = start.iter().zip(&end).map(|(a, b)| a.lerp(*b, 0.3)).collect();
    let (blend, expected) = (through(&start).blend(&through(&end), 0.3), through(&between));
    for i in 0..=50 {
        let parameter = 2.6 * f64::from(i) / 50.0;
        // A few roundings of numbers of size one.
        assert!((blend.position(parameter) - expected.position(parameter)).length() < 1e-14);
    }
    let centripetal = CubicSpline::open(&start, Parametrization::Centripetal, EndCondition::Natural).unwrap();
    assert_eq!(CubicSpline::open_at(&start, centripetal.knots(), EndCondition::Natural).unwrap().knots().len(), 6);
}

#[test]
fn control_points_reproduce_their_pieces() {
    let (_, points) = helix_points(5);
    let spline = CubicSpline::open(&points, Parametrization::Centripetal, EndCondition::Natural).unwrap();
    for (piece, [a, b, c, d]) in spline.control_points().enumerate() {
        let (start, end) = (spline.knots()[piece], spline.knots()[piece + 1]);
        for t in [0.0, 0.2, 0.7, 1.0] {
            // De Casteljau.
            let [e, f, g] = [a.lerp(b, t), b.lerp(c, t), c.lerp(d, t)];
            let point = e.lerp(f, t).lerp(f.lerp(g, t), t);
            assert!((point - spline.position(start + (end - start) * t)).length() < 1e-14, "{piece} {t}");
        }
    }
}

#[test]
fn errors_name_the_invalid_parameter() {
    let points = [DVec3::X, DVec3::X, DVec3::Y];
    let at = |parameters: &[f64]| CubicSpline::open_at(&points, parameters, EndCondition::Natural);
    assert!(at(&[0.0, 1.0, 2.0]).is_ok());
    assert_eq!(at(&[0.0, 1.0]).unwrap_err(), SplineError::Parameter { index: 2 });
    assert_eq!(at(&[0.0, 1.0, 1.0]).unwrap_err(), SplineError::Parameter { index: 2 });
    assert_eq!(at(&[0.0, f64::NAN, 1.0]).unwrap_err(), SplineError::Parameter { index: 1 });
}

#[test]
fn errors_name_the_invalid_point() {
    let error =
        |points: &[DVec3]| CubicSpline::open(points, Parametrization::default(), EndCondition::default()).unwrap_err();
    assert_eq!(error(&[DVec3::X]), SplineError::TooFewPoints { count: 1, needed: 2 });
    assert_eq!(error(&[]), SplineError::TooFewPoints { count: 0, needed: 2 });
    assert_eq!(error(&[DVec3::X, DVec3::NAN]), SplineError::NotFinite { index: 1 });
    assert_eq!(error(&[DVec3::X, DVec3::splat(1e200)]), SplineError::NotFinite { index: 1 });
    let repeated = [DVec3::X, DVec3::Y, DVec3::Y];
    assert_eq!(error(&repeated), SplineError::RepeatedPoint { index: 1, next: 2 });
    let ends = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::X];
    assert_eq!(
        CubicSpline::closed(&ends, Parametrization::default()).unwrap_err(),
        SplineError::RepeatedPoint { index: 3, next: 0 }
    );
}
