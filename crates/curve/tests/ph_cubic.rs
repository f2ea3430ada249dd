//! Pythagorean-hodograph cubics, compared with golden values, their definition, and the curves that
//! they approximate.
#![allow(clippy::excessive_precision, reason = "golden values keep all computed digits")]

use glam::DVec3;
use isochore_curve::{
    Bezier, Curve, FrameMethod, PhCubic, PhCubicError, PhSpline, PhSplineError, RationalRotation, Spine,
    TrigonometricCurve, exact_frames, length, rotation_minimizing_frames, total_torsion, uniform_parameters,
};
use proptest::prelude::*;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn example_a() -> PhCubic {
    PhCubic::hermite(v(0.0, 0.0, 0.0), v(1.0, 0.2, 0.1), v(1.0, 0.5, 0.0), v(1.0, -0.3, 0.4)).unwrap()
}

fn example_b() -> PhCubic {
    PhCubic::hermite(v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(1.0, 1.0, 0.2), v(1.0, -1.0, 0.3)).unwrap()
}

/// The cubic (21) of Bartoň et al. 2009.
fn barton() -> PhCubic {
    let points = [v(0.0, 1.0, 0.0), v(1.0, 1.0, 0.0), v(1.0, 0.0, 0.0), v(1.0, 0.0, 2.0)];
    // (3t(1−t)² + 3t²(1−t) + t³, (1−t)³ + 3t(1−t)², 2t³)
    let cubic = PhCubic::hermite(points[0], points[3], points[1] - points[0], points[3] - points[2]).unwrap();
    for (point, expected) in cubic.control_points().iter().zip(points) {
        assert!(point.distance(expected) < 1e-14);
    }
    cubic
}

#[test]
fn hermite_data_have_the_golden_cubics() {
    for (cubic, b1, b2, factor, rotation) in [
        (
            example_a(),
            v(0.488491972485425, 0.244245986242712, 0.0),
            v(0.811508027514575, 0.256547591745627, 0.0246032110058301),
            0.593230395677626,
            0.616951503493057,
        ),
        (
            example_b(),
            v(0.327260970793373, 0.327260970793373, 0.0654521941586747),
            v(0.682679845392093, 0.317320154607906, -0.0951960463823719),
            0.611571295600804,
            1.31759802272088,
        ),
    ] {
        // The reference values have 15 digits.
        assert!(cubic.control_points()[1].distance(b1) < 2e-15);
        assert!(cubic.control_points()[2].distance(b2) < 2e-15);
        assert!((cubic.rotation_factor() - factor).abs() < 5e-15);
        assert!((cubic.rotation_to(1.0) - rotation).abs() < 5e-15);
    }
    assert!((example_a().length() - 1.05130684829038).abs() < 1e-14);
    assert!((barton().rotation_factor() - std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-15);
    assert!((barton().rotation_to(1.0) - 2.22144146907918).abs() < 1e-14);
}

#[test]
fn closed_forms_match_the_curve() {
    for cubic in [example_a(), example_b(), barton()] {
        for i in 0..=10 {
            let at = f64::from(i) / 10.0;
            let jet = cubic.jet(at);
            assert!((cubic.speed(at) / jet.speed() - 1.0).abs() < 1e-14);
            assert!((cubic.curvature(at) / jet.curvature() - 1.0).abs() < 1e-13);
            assert!((cubic.torsion(at) / jet.torsion() - 1.0).abs() < 1e-12);
            assert!((cubic.rotation_rate(at) + jet.torsion() * jet.speed()).abs() < 1e-12);
        }
        assert!((cubic.length() - length(&cubic)).abs() < 1e-14);
        assert!((cubic.rotation_to(1.0) + total_torsion(&cubic)).abs() < 1e-13);
        let parameters = [0.0, 0.25, 0.5, 1.0];
        let reference = v(0.3, 0.4, 1.0);
        let exact = cubic.exact_frames(&parameters, reference).unwrap();
        let quadrature = exact_frames(&cubic, &parameters, reference).unwrap();
        for (a, b) in exact.iter().zip(&quadrature) {
            assert!(a.r.distance(b.r) < 2e-13);
        }
    }
    let end = barton().exact_frames(&[1.0], v(0.0, -1.0, 0.0)).unwrap()[0];
    assert!(end.r.distance(v(-0.7956932015674809, -0.6056998670788134, 0.0)) < 1e-14);
}

/// Example 2 of Wang et al. 2008: the printed data have no solution. The replacements have the
/// known errors.
#[test]
fn table_five_has_no_cubic_and_its_replacements_do() {
    let (x0, x1) = (v(1000.0, 0.0, 0.0), v(1000.0, 2000.0, 4000.0));
    for (sign0, sign1) in [(1.0, 1.0), (-1.0, -1.0)] {
        let error = PhCubic::hermite(x0, x1, v(1.0, 5.0, -1.0) * sign0, v(-3.0, 2.0, 5.0) * sign1).unwrap_err();
        let PhCubicError::NoRealRoot { discriminant } = error else { panic!("{error}") };
        // The reference value has nine digits.
        assert!((discriminant + 96474.8849).abs() < 6e-5, "{discriminant}");
        assert!(error.to_string().starts_with("no Pythagorean-hodograph cubic has these ends"));
    }
    for (t0, t1, rotation, errors) in [
        (v(1.0, 5.0, -1.0), v(3.0, -2.0, 5.0), -1.840809276205, [4.00467e-8, 3.380279e-4, 1.620193e-4]),
        (v(1.0, 5.0, 1.0), v(-3.0, -2.0, 5.0), 1.011109153882, [2.68644e-9, 8.03099e-5, 3.45333e-5]),
    ] {
        let cubic = PhCubic::hermite(x0, x1, t0, t1).unwrap();
        assert!((cubic.rotation_to(1.0) - rotation).abs() < 1e-12);
        let normal = cubic.frenet_frame(0.0).r;
        let exact = cubic.exact_frames(&[1.0], normal).unwrap()[0];
        let methods = [FrameMethod::DoubleReflection, FrameMethod::Rotation, FrameMethod::Projection];
        for (method, expected) in methods.into_iter().zip(errors) {
            let spine = Spine::sample(&cubic, 64).unwrap();
            let frames = rotation_minimizing_frames(&spine, normal, method, Default::default()).unwrap();
            let error = exact.angle_to(frames.stations[64].r).abs();
            assert!((error / expected - 1.0).abs() < 5e-6, "{method:?}: {error:e}, expected {expected:e}");
        }
    }
}

#[test]
fn double_reflection_on_the_replacement_is_of_fourth_order() {
    let cubic =
        PhCubic::hermite(v(1000.0, 0.0, 0.0), v(1000.0, 2000.0, 4000.0), v(1.0, 5.0, -1.0), v(3.0, -2.0, 5.0)).unwrap();
    let normal = cubic.frenet_frame(0.0).r;
    let exact = cubic.exact_frames(&[1.0], normal).unwrap()[0];
    let error = |segments: usize| {
        let spine = Spine::sample(&cubic, segments).unwrap();
        let frames =
            rotation_minimizing_frames(&spine, normal, FrameMethod::DoubleReflection, Default::default()).unwrap();
        exact.angle_to(frames.stations[segments].r).abs()
    };
    assert!((error(64) / error(32) - 0.0625).abs() < 1e-3);
}

#[test]
fn special_data_have_the_expected_results() {
    let make = |end, t0, t1| PhCubic::hermite(DVec3::ZERO, end, t0, t1);
    let line = make(v(3.0, 0.0, 0.0), DVec3::X, DVec3::X * 2.0).unwrap();
    assert!(line.is_straight() && line.rotation_to(1.0) == 0.0);
    assert_eq!(line.control_points()[1], DVec3::X);
    let frames = line.exact_frames(&[0.0, 1.0], DVec3::Y).unwrap();
    assert!(frames[1].r.distance(DVec3::Y) < 1e-15);
    assert_eq!(make(v(3.0, 0.0, 0.0), -DVec3::X, -DVec3::X), Err(PhCubicError::WrongDirection));
    assert_eq!(make(v(3.0, 1.0, 0.0), DVec3::X, DVec3::X), Err(PhCubicError::ParallelTangents));
    assert_eq!(make(DVec3::ZERO, DVec3::X, DVec3::Y), Err(PhCubicError::RepeatedPoint));
    assert_eq!(make(DVec3::X, DVec3::X, DVec3::ZERO), Err(PhCubicError::ZeroTangent));
    assert_eq!(make(DVec3::X, DVec3::NAN, DVec3::X), Err(PhCubicError::NotFinite));
    // A half turn: the general equation degenerates.
    let turn = make(v(0.0, 2.0, 0.5), DVec3::X, -DVec3::X).unwrap();
    assert!((turn.speed(0.5) - turn.jet(0.5).speed()).abs() < 1e-14);
    // Tangents at 120 degrees: the quadratic equation becomes linear.
    let linear = make(v(1.0, 1.0, 0.0), v(0.0, 1.0, 0.0), v(0.75f64.sqrt(), -0.5, 0.0)).unwrap();
    assert!((linear.speed(0.3) - linear.jet(0.3).speed()).abs() < 1e-13);
}

#[test]
fn short_arcs_keep_their_digits() {
    // The curve (u, u²/2, u³/6) near the origin, so that positions keep all digits.
    let h: f64 = 1e-6;
    let curve =
        Bezier::new(vec![DVec3::ZERO, v(1.0 / 3.0, 0.0, 0.0), v(2.0 / 3.0, 1.0 / 6.0, 0.0), v(1.0, 0.5, 1.0 / 6.0)]);
    let (a, b) = (curve.jet(0.0), curve.jet(h));
    let cubic = PhCubic::hermite(a.position, b.position, a.first, b.first).unwrap();
    // The first side is a third of the length, up to a relative error h². The tangents differ by h,
    // which has ten digits, and their product with the chord cancels again. The printed form would
    // have an error of 4e-2.
    assert!((cubic.sides()[0].length() / (h / 3.0) - 1.0).abs() < 5e-6, "{}", cubic.sides()[0].length() / (h / 3.0));
}

proptest! {
    /// Every solution satisfies the two conditions (17) on the control polygon, so the speed is the
    /// length of the derivative.
    #[test]
    fn solutions_are_pythagorean(
        end in prop::array::uniform3(-2.0..2.0f64),
        t0 in prop::array::uniform3(-1.0..1.0f64),
        t1 in prop::array::uniform3(-1.0..1.0f64),
    ) {
        let (end, t0, t1) = (DVec3::from_array(end), DVec3::from_array(t0), DVec3::from_array(t1));
        if let Ok(cubic) = PhCubic::hermite(DVec3::ZERO, end, t0, t1) {
            let scale = cubic.polygon_length();
            for i in 0..=8 {
                let at = f64::from(i) / 8.0;
                // Near the degenerate cases, the roots of the quadratic lose digits. The cubics
                // satisfy the conditions to half of the digits.
                prop_assert!((cubic.speed(at) - cubic.jet(at).speed()).abs() < 1e-7 * scale);
            }
            prop_assert!(cubic.jet(0.0).tangent().distance(t0.normalize()) < 1e-6);
            prop_assert!(cubic.jet(1.0).tangent().distance(t1.normalize()) < 1e-6);
        }
    }
}

#[test]
fn rational_rotations_have_the_golden_optimum() {
    // Bounds: half a unit of the last digit, and one unit for the squared error of B, which is
    // truncated.
    for (cubic, lambda, squared_error, angle_error, lambda_bound, squared_bound) in [
        (example_a(), -0.7923418062, 1.00076646e-8, 2.560029e-5, 5.1e-11, 5.1e-17),
        (example_b(), -0.2566571628, 1.683115960605e-5, 9.15362e-4, 5.1e-11, 1e-17),
        (barton(), 0.2174091424693, 8.834531147085e-4, 7.041642e-3, 2e-13, 6e-17),
    ] {
        let rotation = RationalRotation::symmetric(&cubic);
        assert!((rotation.lambda - lambda).abs() < lambda_bound, "{}, expected {lambda}", rotation.lambda);
        assert!((rotation.squared_error - squared_error).abs() < squared_bound, "{:e}", rotation.squared_error);
        let largest = (0..=2000)
            .map(|i| f64::from(i) / 2000.0)
            .map(|v| (rotation.angle(v) - rotation.initial_angle - cubic.rotation_to(v)).abs())
            .fold(0.0, f64::max);
        assert!((largest / angle_error - 1.0).abs() < 5e-7, "{largest:e}, expected {angle_error:e}");
        assert!(rotation.denominator.iter().all(|&b| b > 0.0), "no pole");
    }
}

#[test]
fn the_smallest_squared_error_does_not_depend_on_the_initial_angle() {
    for (cubic, zero, quarter) in [
        (example_a(), -0.8208088061, Some(-1.0039084764)),
        (example_b(), -0.4390550704, Some(-0.9726099684)),
        (barton(), -0.4030957792249, None),
    ] {
        let symmetric = RationalRotation::symmetric(&cubic);
        let from_zero = RationalRotation::with_initial_angle(&cubic, 0.0).unwrap();
        assert!((from_zero.lambda - zero).abs() < 5.1e-11, "{}", from_zero.lambda);
        // Rounding of a squared error of 1e-8, a sum of squared differences of numbers of size one.
        assert!((from_zero.squared_error / symmetric.squared_error - 1.0).abs() < 5e-12);
        let from_binormal = RationalRotation::with_initial_angle(&cubic, std::f64::consts::FRAC_PI_2);
        match quarter {
            Some(lambda) => assert!((from_binormal.unwrap().lambda - lambda).abs() < 5.1e-11),
            None => assert_eq!(from_binormal, None, "W has a pole"),
        }
    }
}

#[test]
fn halving_the_cubic_divides_the_angle_error_by_thirty_two() {
    let error = |cubic: &PhCubic| {
        let rotation = RationalRotation::symmetric(cubic);
        (0..=500)
            .map(|i| f64::from(i) / 500.0)
            .map(|v| (rotation.angle(v) - rotation.initial_angle - cubic.rotation_to(v)).abs())
            .fold(0.0, f64::max)
    };
    let part = (0..4).fold(example_b(), |cubic, _| cubic.split(0.5).0);
    let ratio = error(&part.split(0.5).0) / error(&part);
    assert!((0.028..0.034).contains(&ratio), "fifth order, 1/32: {ratio}");
}

#[test]
fn planar_cubics_do_not_rotate() {
    let planar = PhCubic::hermite(DVec3::ZERO, v(1.0, 0.2, 0.0), v(1.0, 1.0, 0.0), v(1.0, -0.5, 0.0)).unwrap();
    assert_eq!(planar.rotation_to(1.0), 0.0);
    assert_eq!(RationalRotation::symmetric(&planar).numerator, [0.0; 3]);
}

#[test]
fn splines_approximate_curves_within_the_tolerance() {
    let knot = TrigonometricCurve::torus_knot();
    for tolerance in [1e-2, 1e-5, 1e-8] {
        let spline = PhSpline::follow(&knot, tolerance).unwrap();
        assert!(spline.error() <= tolerance);
        // An independent check: all points of the knot are within the tolerance, plus the error
        // between the checks.
        let search = isochore_curve::ClosestPoint::new(&spline);
        let farthest = (0..3000)
            .map(|i| search.closest(knot.position(std::f64::consts::TAU * f64::from(i) / 3000.0)).distance)
            .fold(0.0, f64::max);
        assert!(farthest <= 1.1 * tolerance, "{farthest:e} for {tolerance:e}");
        assert!((spline.length() - length(&knot)).abs() < 15.4 * 50.0 * tolerance);
    }
}

#[test]
fn flat_cubics_have_stable_frames() {
    // Between a visible arc and a line, rounding destroys the Frenet frame but must not affect the
    // exact frame.
    for bend in [1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-13, 1e-15, 0.0] {
        let (t0, t1) = (v(1.0, bend, 0.3 * bend), v(1.0, -bend, 0.2 * bend));
        let cubic = PhCubic::hermite(v(3.0, 1.0, 2.0), v(4.0, 1.0, 2.0 + 0.25 * bend), t0, t1).unwrap();
        let frames = cubic.exact_frames(&[0.0, 0.3, 1.0], DVec3::Y).unwrap();
        let exact = exact_frames(&cubic, &[0.0, 0.3, 1.0], DVec3::Y).unwrap();
        for (frame, exact) in frames.iter().zip(&exact) {
            // The data are rounded at 2e-16 of coordinates up to 4. The bend amplifies this if the
            // Frenet frame is used.
            assert!(frame.r.distance(exact.r) < 2e-9, "bend {bend:e}: {:e}", frame.r.distance(exact.r));
        }
    }
}

#[test]
fn inflections_are_split() {
    // A planar curve with one inflection at its midpoint, which must be a joint.
    let spline = PhSpline::follow(&Bezier::s_curve(0.0), 1e-5).unwrap();
    assert!(spline.error() <= 1e-5);
    let line = PhSpline::follow(&Bezier::new(vec![DVec3::ZERO, DVec3::X]), 1e-9).unwrap();
    assert_eq!(line.segments().len(), 2);
}

#[test]
fn splines_converge_with_fourth_order_in_position_and_frame() {
    let helix = TrigonometricCurve::helix(1.0, 0.5, (0.0, 6.0));
    let spline = |segments| PhSpline::interpolate(&helix, segments).unwrap();
    let ratio = spline(128).error() / spline(64).error();
    assert!((ratio - 0.0625).abs() < 1e-3, "{ratio}");
    let reference = helix.jet(0.0).normal().unwrap();
    let exact = exact_frames(&helix, &[0.0, 6.0], reference).unwrap()[1];
    let frame_error = |segments| {
        let frames = spline(segments).exact_frames(reference, 1).unwrap();
        assert_eq!(frames.len(), segments + 1);
        exact.angle_to(frames[segments].1.r).abs()
    };
    let ratio = frame_error(128) / frame_error(64);
    assert!((ratio - 0.0625).abs() < 2e-3, "{ratio}");
}

/// Theorem 10 on a helix. The reference values have three digits.
#[test]
fn positions_on_a_helix_have_the_golden_errors() {
    let helix = TrigonometricCurve::helix(1.0, 0.5, (0.0, 4.0));
    for (segments, expected, unit) in [(16, 1.02e-5, 1e-7), (256, 1.55e-10, 1e-12)] {
        let error = PhSpline::interpolate(&helix, segments).unwrap().error();
        assert!((error - expected).abs() < 0.51 * unit, "{segments}: {error:e}");
    }
}

#[test]
fn rejects_curves_that_have_no_spline() {
    let knot = TrigonometricCurve::torus_knot();
    assert!(matches!(PhSpline::follow(&knot, 0.0), Err(PhSplineError::Tolerance { .. })));
    assert!(matches!(PhSpline::follow(&knot, f64::NAN), Err(PhSplineError::Tolerance { .. })));
    let cusp = Bezier::new(
        [(-1.0, 1.0), (1.0, -1.0 / 3.0), (-1.0, -1.0 / 3.0), (1.0, 1.0)].map(|(x, y)| v(x, y, 0.0)).to_vec(),
    );
    assert!(PhSpline::follow(&cusp, 1e-9).is_err());
    assert_eq!(uniform_parameters(&cusp, 2), [0.0, 0.5, 1.0]);
}
