//! Rational curves with rational frames, compared with the examples of Bartoň et al. 2009.

#![allow(clippy::excessive_precision, reason = "golden values keep all computed digits")]

use glam::DVec3;
use isochore_curve::{
    ClosestPoint, Curve, FrameMethod, MoebiusSegment, MoebiusSpline, PhCubic, PhCubicError, Spine, Tilt,
    TrigonometricCurve, exact_frames, rotation_minimizing_frames,
};

/// Example 2: the cubic (21).
fn cubic() -> PhCubic {
    PhCubic::hermite(DVec3::Y, DVec3::new(1.0, 0.0, 2.0), DVec3::X, DVec3::Z).unwrap()
}

struct Errors {
    average: f64,
    end: f64,
    largest: f64,
    position: f64,
}

/// Nodes and weights of the Gauss–Legendre rule on [0, 1], by Newton's method on the Legendre
/// polynomial.
fn gauss_rule(count: usize) -> Vec<(f64, f64)> {
    let degree = count as f64;
    (0..count)
        .map(|i| {
            let mut x = libm::cos((i as f64 + 0.75) / (degree + 0.5) * std::f64::consts::PI);
            let mut slope = 0.0;
            // Convergence is quadratic and starts at two digits; one step is a reserve.
            for _ in 0..6 {
                let (mut before, mut value) = (1.0, x);
                for n in 2..=count {
                    let n = n as f64;
                    (before, value) = (value, ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n);
                }
                slope = degree * (x * value - before) / (x * x - 1.0);
                x -= value / slope;
            }
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Errors (23), (25) of the spline with `segments` segments, by the Gauss–Legendre rule with
/// `nodes` nodes per segment. Frames are compared with those at the nearest points of the cubic.
/// The maxima over the nodes are slightly low.
fn errors(segments: usize, tilt: Tilt, nodes: usize) -> Errors {
    let curve = cubic();
    let reference = -DVec3::Y;
    let spline = MoebiusSpline::interpolate(&curve, segments, tilt).unwrap();
    let search = ClosestPoint::new(&curve);
    let rule = gauss_rule(nodes);
    let parameters: Vec<f64> = rule.iter().map(|node| node.0).collect();
    let joints = spline.frames(reference, 1).unwrap();
    let exact_end = curve.exact_frames(&[1.0], reference).unwrap()[0];
    let end = joints[segments].1.r.distance(exact_end.r);
    let mut errors = Errors { average: 0.0, end, largest: 0.0, position: 0.0 };
    for (segment, (_, joint)) in spline.segments().iter().zip(&joints) {
        let frames = segment.frames(&parameters, joint.r).unwrap();
        for (&(u, weight), frame) in rule.iter().zip(&frames) {
            let nearest = search.closest(segment.position(u));
            let exact = curve.exact_frames(&[nearest.parameter], reference).unwrap()[0];
            let delta = frame.r.distance(exact.r);
            errors.average += weight * delta / segments as f64;
            errors.largest = errors.largest.max(delta);
            errors.position = errors.position.max(nearest.distance);
        }
    }
    errors
}

/// Asserts that `found` agrees with all digits of `golden`, up to half a unit of the last digit and
/// the rounding of a distance between unit vectors.
fn assert_digits(found: f64, golden: &str) {
    let (mantissa, exponent) = golden.split_once('e').unwrap();
    let decimals = mantissa.split_once('.').unwrap().1.len() as i32;
    let unit = 10f64.powi(exponent.parse::<i32>().unwrap() - decimals);
    let expected: f64 = golden.parse().unwrap();
    assert!((found - expected).abs() <= 0.5 * unit + 3e-15, "{found:e}, expected {golden}");
}

#[test]
fn example_two_has_the_golden_errors() {
    // Segments, nodes of the average, average and end error, and the maxima over twelve nodes per
    // segment. The integrand has kinks, so the number of nodes matters: with 64 segments, the
    // average over twelve nodes is 0.7 percent high.
    for (segments, nodes, average, end, largest, position) in [
        (2, 96, "3.199771076571e-2", "2.66898801971e-2", "5.54e-2", "3.55e-2"),
        (4, 96, "6.8625e-3", "2.00833640738e-3", "2.92e-2", "3.96e-3"),
        (8, 96, "6.2838e-4", "1.31975216087e-4", "3.89e-3", "4.74e-4"),
        (16, 96, "1.014671e-4", "8.35411958e-6", "1.55e-3", "5.84e-5"),
        (32, 96, "1.30973e-5", "5.23814537e-7", "3.23e-4", "7.28e-6"),
        (64, 12, "1.867e-6", "3.27648e-8", "8.96e-5", "9.09e-7"),
    ] {
        let fine = errors(segments, Tilt::Never, nodes);
        assert_digits(fine.end, end);
        assert_digits(fine.average, average);
        let coarse = errors(segments, Tilt::Never, 12);
        assert_digits(coarse.largest, largest);
        assert_digits(coarse.position, position);
    }
}

#[test]
fn order_is_three_between_joints_and_four_at_joints() {
    for tilt in [Tilt::Never, Tilt::WhenNeeded] {
        let (coarse, fine) = (errors(32, tilt, 100), errors(64, tilt, 100));
        assert!(fine.average / coarse.average < 0.15, "third order or better: {}", fine.average / coarse.average);
        assert!((fine.end / coarse.end - 0.0625).abs() < 1e-3, "fourth order: {}", fine.end / coarse.end);
    }
}

#[test]
fn the_tilt_restores_the_orders_near_stationary_curvature() {
    let plain = errors(128, Tilt::Never, 12);
    let tilted = errors(128, Tilt::WhenNeeded, 12);
    assert_digits(plain.largest, "2.13e-5");
    assert_digits(plain.position, "1.14e-7");
    assert_digits(tilted.largest, "2.97e-7");
    assert_digits(tilted.position, "1.78e-9");
    let coarse = errors(64, Tilt::WhenNeeded, 12);
    assert!((tilted.position / coarse.position - 0.0625).abs() < 0.01, "fourth order in position");
    assert!((tilted.largest / coarse.largest - 0.125).abs() < 0.03, "third order in the frame");
}

#[test]
fn frames_at_joints_match_double_reflection() {
    for tilt in [Tilt::Never, Tilt::WhenNeeded] {
        for segments in [8, 32] {
            let curve = cubic();
            let spine = Spine::sample(&curve, segments).unwrap();
            let reflected =
                rotation_minimizing_frames(&spine, -DVec3::Y, FrameMethod::DoubleReflection, Default::default())
                    .unwrap();
            let spline = MoebiusSpline::interpolate(&curve, segments, tilt).unwrap();
            for (joint, (_, frame)) in spline.frames(-DVec3::Y, 1).unwrap().iter().enumerate() {
                // The sphere of a short segment follows from differences, which loses a few digits.
                let distance = frame.r.distance(reflected.stations[joint].r);
                assert!(distance < 1e-12, "{segments} {joint}: {distance:e}");
            }
        }
    }
}

#[test]
fn plain_centers_fail_on_every_circular_helix() {
    let helix = TrigonometricCurve::helix(1.0, 0.5, (0.0, std::f64::consts::PI));
    for segments in [2, 8, 50] {
        assert!(MoebiusSpline::interpolate(&helix, segments, Tilt::Never).is_err());
    }
    let end_error = |segments| {
        let normal = helix.jet(0.0).normal().unwrap();
        let spline = MoebiusSpline::interpolate(&helix, segments, Tilt::WhenNeeded).unwrap();
        let last = spline.frames(normal, 1).unwrap()[segments].1;
        let exact = exact_frames(&helix, &[0.0, std::f64::consts::PI], normal).unwrap()[1];
        last.r.distance(exact.r)
    };
    for (segments, expected) in [(2, "1.963838e-3"), (4, "1.196984e-4"), (8, "7.438659e-6")] {
        assert_digits(end_error(segments), expected);
    }
}

#[test]
fn the_tilt_succeeds_from_7_to_160_segments() {
    let example = TrigonometricCurve::barton_example();
    let helix = TrigonometricCurve::helix(1.0, 0.5, (0.0, 3.0 * std::f64::consts::PI));
    for segments in 7..=160 {
        for curve in [&example, &helix] {
            MoebiusSpline::interpolate(curve, segments, Tilt::WhenNeeded).unwrap();
        }
    }
    let fails: Vec<usize> =
        (7..=160).filter(|&k| MoebiusSpline::interpolate(&example, k, Tilt::Never).is_err()).collect();
    assert_eq!(fails, [37, 151], "without the tilt, two numbers of segments have no solution");
}

#[test]
fn example_one_has_the_golden_errors() {
    let curve = TrigonometricCurve::barton_example();
    let (first, last) = curve.domain();
    let normal = DVec3::new(-1.0, -1.0, 0.0).normalize();
    let spline = MoebiusSpline::interpolate(&curve, 8, Tilt::Never).unwrap();
    let joints = spline.frames(normal, 1).unwrap();
    let exact = |parameter| exact_frames(&curve, &[first, parameter], normal).unwrap()[1].r;
    assert_digits(joints[8].1.r.distance(exact(last)), "1.3165332233e-2");
    // The average over twelve nodes per segment is 2e-4 high.
    let search = ClosestPoint::new(&curve);
    let rule = gauss_rule(12);
    let parameters: Vec<f64> = rule.iter().map(|node| node.0).collect();
    let mut average = 0.0;
    for (segment, (_, joint)) in spline.segments().iter().zip(&joints) {
        for (frame, &(u, weight)) in segment.frames(&parameters, joint.r).unwrap().iter().zip(&rule) {
            let nearest = search.closest(segment.position(u)).parameter;
            average += weight * frame.r.distance(exact(nearest)) / 8.0;
        }
    }
    assert_digits(average, "1.2429e-1");
    for segments in 2..=6 {
        assert!(MoebiusSpline::interpolate(&curve, segments, Tilt::Never).is_err());
    }
}

#[test]
fn segments_are_rational_of_degree_six_on_their_sphere() {
    let curve = cubic();
    for tilt in [Tilt::Never, Tilt::WhenNeeded] {
        for segment in MoebiusSpline::interpolate(&curve, 4, tilt).unwrap().segments() {
            let control = segment.control_points();
            for i in 0..=10 {
                let u = f64::from(i) / 10.0;
                let mut points = control.to_vec();
                while points.len() > 1 {
                    points = points.windows(2).map(|pair| pair[0].lerp(pair[1], u)).collect();
                }
                let point = points[0].truncate() / points[0].w;
                assert!(point.distance(segment.position(u)) < 1e-14);
                // The derivatives match differences of positions.
                let step = 1e-5;
                let (before, at, after) = (segment.jet(u - step), segment.jet(u), segment.jet(u + step));
                assert!(((after.position - before.position) / (2.0 * step)).distance(at.first) < 1e-8);
                assert!(((after.first - before.first) / (2.0 * step)).distance(at.second) < 1e-7);
                assert!(((after.second - before.second) / (2.0 * step)).distance(at.third) < 1e-6);
                assert!(segment.tangent(u).distance(at.tangent()) < 1e-14);
            }
        }
    }
}

#[test]
fn frames_are_rotation_minimizing_along_the_segment() {
    let segment = MoebiusSpline::interpolate(&cubic(), 2, Tilt::WhenNeeded).unwrap().segments()[0];
    let parameters: Vec<f64> = (0..=10).map(|i| f64::from(i) / 10.0).collect();
    let frames = segment.frames(&parameters, DVec3::Y).unwrap();
    let exact = exact_frames(&segment, &parameters, DVec3::Y).unwrap();
    for (frame, exact) in frames.iter().zip(&exact) {
        assert!(frame.r.distance(exact.r) < 1e-12);
    }
}

#[test]
fn planes_lines_and_circles_have_solutions() {
    let make = |end, t0, t1| MoebiusSegment::hermite(DVec3::ZERO, end, t0, t1, Tilt::WhenNeeded);
    let line = make(DVec3::X, DVec3::X, DVec3::X).unwrap();
    assert!(line.position(0.5).distance(DVec3::X * 0.5) < 1e-15);
    // A quarter circle: the reflected tangents agree.
    let arc = make(DVec3::new(1.0, 1.0, 0.0), DVec3::X, DVec3::Y).unwrap();
    assert!(arc.position(0.5).z.abs() < 1e-15);
    assert!(arc.tangent(1.0).distance(DVec3::Y) < 1e-14);
    // A planar S: the published centers have no solution.
    let (end, tangent) = (DVec3::new(2.0, 0.5, 0.0), DVec3::X);
    let plain = MoebiusSegment::hermite(DVec3::ZERO, end, tangent, tangent, Tilt::Never);
    assert_eq!(plain, Err(PhCubicError::ParallelTangents));
    let bent = make(end, tangent, tangent).unwrap();
    assert!(bent.position(1.0).distance(end) < 1e-14 && bent.tangent(1.0).distance(tangent) < 1e-13);
    assert!(make(DVec3::ZERO, DVec3::X, DVec3::X).is_err() && make(DVec3::X, DVec3::NAN, DVec3::X).is_err());
}
