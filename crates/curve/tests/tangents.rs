//! Tangents estimated from few, uneven and invalid points.

use glam::DVec3;
use isochore_curve::{Curve, Spine, SpineError, TangentError, TangentRule, TrigonometricCurve};

fn helix() -> TrigonometricCurve {
    TrigonometricCurve::helix(1.0, 0.4, (0.0, 1.0))
}

/// Largest angle between estimated and true tangents of `count` points at steps `h`.
fn error(count: usize, h: f64, rule: TangentRule<'_>) -> f64 {
    let parameters: Vec<f64> = (0..count).map(|i| i as f64 * h).collect();
    let spine = Spine::from_points(parameters.iter().map(|&u| helix().position(u)).collect(), false, rule).unwrap();
    parameters
        .iter()
        .zip(spine.tangents())
        .map(|(&u, tangent)| tangent.cross(helix().jet(u).tangent()).length())
        .fold(0.0, f64::max)
}

#[test]
fn few_points_have_the_order_of_their_stencil() {
    // One segment gives first order (the chord), two second, three third, and four or more fourth.
    for (count, order) in [(2, 1), (3, 2), (4, 3), (5, 4), (8, 4)] {
        for rule in [TangentRule::Uniform, TangentRule::ArcLength] {
            // On a helix, chord lengths are as uniform as the parameter.
            let ratio = error(count, 0.02, rule) / error(count, 0.04, rule);
            let expected = 0.5f64.powi(order);
            assert!((ratio / expected - 1.0).abs() < 0.1, "{count} points, {rule:?}: {ratio}, expected {expected}");
        }
    }
    for count in [3, 6] {
        let ratio = error(count, 0.02, TangentRule::Circle) / error(count, 0.04, TangentRule::Circle);
        assert!((ratio / 0.25 - 1.0).abs() < 0.1, "circle tangents, {count} points: {ratio}");
    }
}

#[test]
fn circle_tangents_are_exact_on_uneven_points_of_a_circle() {
    let angles = [0.0, 0.4, 0.5, 1.3, 2.9, 3.0, 4.4];
    let points: Vec<DVec3> = angles.map(libm::sincos).map(|(s, c)| DVec3::new(3.0 * c, 3.0 * s, 1.0)).to_vec();
    for closed in [false, true] {
        let spine = Spine::from_points(points.clone(), closed, TangentRule::Circle).unwrap();
        for (angle, tangent) in angles.iter().zip(spine.tangents()) {
            let (s, c) = libm::sincos(*angle);
            assert!(tangent.distance(DVec3::new(-s, c, 0.0)) < 1e-15);
        }
    }
}

#[test]
fn closed_points_use_neighbors_across_the_seam() {
    let knot = TrigonometricCurve::torus_knot();
    for rule in [TangentRule::Uniform, TangentRule::ArcLength, TangentRule::Automatic] {
        let error = |count: usize| {
            let parameter = |i: usize| std::f64::consts::TAU * i as f64 / count as f64;
            let points = (0..count).map(|i| knot.position(parameter(i))).collect();
            let spine = Spine::from_points(points, true, rule).unwrap();
            (0..count).map(|i| spine.tangents()[i].cross(knot.jet(parameter(i)).tangent()).length()).fold(0.0, f64::max)
        };
        let ratio = error(1024) / error(512);
        assert!((ratio - 0.0625).abs() < 0.01, "{rule:?}: {ratio}");
    }
    // The smallest closed curve.
    let triangle = [DVec3::X, DVec3::Y, DVec3::Z];
    let spine = Spine::from_points(triangle.to_vec(), true, TangentRule::Uniform).unwrap();
    assert!(spine.tangents()[0].distance((DVec3::Y - DVec3::Z).normalize()) < 1e-15);
}

#[test]
fn errors_name_the_invalid_point_or_parameter() {
    let make = |points: &[DVec3], rule: TangentRule<'_>| match Spine::from_points(points.to_vec(), false, rule) {
        Err(SpineError::Tangent(error)) => error,
        other => panic!("{other:?}"),
    };
    let repeated = [DVec3::ZERO, DVec3::X, DVec3::X, DVec3::Y, DVec3::Z];
    for rule in [TangentRule::Automatic, TangentRule::ArcLength, TangentRule::Circle] {
        assert_eq!(make(&repeated, rule), TangentError::RepeatedPoint { index: 1, next: 2 });
    }
    // The points reverse on a line: the central difference is zero.
    let cusp = [DVec3::X, DVec3::ZERO, DVec3::X];
    assert_eq!(make(&cusp, TangentRule::Uniform), TangentError::Undetermined { index: 1 });
    assert_eq!(make(&cusp, TangentRule::Circle), TangentError::Undetermined { index: 1 });
    let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
    for (parameters, index) in
        [(&[0.0, 1.0][..], 2), (&[0.0, 1.0, 2.0, 3.0], 3), (&[0.0, 1.0, 1.0], 2), (&[0.0, f64::NAN, 1.0], 1)]
    {
        assert_eq!(make(&line, TangentRule::Parameters(parameters)), TangentError::Parameter { index });
    }
    let open: Vec<DVec3> = (0..9).map(|i| DVec3::X * f64::from(i)).collect();
    let closed = Spine::from_points(open, true, TangentRule::Automatic);
    assert_eq!(closed, Err(SpineError::NotClosed { gap: 8.0, longest: 1.0 }));
}
