//! Properties specific to double reflection: symmetry, Möbius invariance, exactness on spheres, and
//! accuracy on dense samples.
#![allow(clippy::excessive_precision, reason = "golden values keep all computed digits")]

use glam::DVec3;
use isochore_curve::{
    Bezier, Curve, DegenerateSegment, Frame, FrameError, FrameMethod, FunctionCurve, Inversion, MoebiusSegment,
    PhCubic, Spine, Tilt, TrigonometricCurve, exact_frames, orthogonal_reference, reflect_twice, rotate_minimally,
    rotation_minimizing_frames, runge_kutta_frames, uniform_parameters,
};
use proptest::prelude::*;

const RIVALS: [FrameMethod; 2] = [FrameMethod::Projection, FrameMethod::Rotation];

fn propagate(spine: &Spine, reference: DVec3, method: FrameMethod) -> Vec<Frame> {
    rotation_minimizing_frames(spine, reference, method, DegenerateSegment::Refuse).unwrap().stations
}

fn knot_samples(segments: usize) -> Spine {
    let knot = TrigonometricCurve::torus_knot();
    Spine::from_jets(uniform_parameters(&knot, segments).iter().map(|&u| knot.jet(u)), false).unwrap()
}

#[test]
fn the_reversed_spine_undoes_the_motion() {
    let spine = knot_samples(64);
    let symmetric =
        [FrameMethod::DoubleReflection, FrameMethod::Projection, FrameMethod::Rotation, FrameMethod::TangentsOnly];
    for method in symmetric {
        let forth = propagate(&spine, -DVec3::X, method);
        let back = propagate(&spine.reversed(), forth[64].r, method);
        // 128 steps with random rounding: √128 · 2e-16, and a margin of three.
        assert!(back[64].r.distance(forth[0].r) < 8e-15, "{method:?}: {:e}", back[64].r.distance(forth[0].r));
    }
    // The same with tangents opposite to the direction of the reversed points.
    let mut points = spine.points().to_vec();
    let mut tangents = spine.tangents().to_vec();
    points.reverse();
    tangents.reverse();
    let forth = propagate(&spine, -DVec3::X, FrameMethod::DoubleReflection);
    let back = propagate(&Spine::new(points, tangents, false).unwrap(), forth[64].r, FrameMethod::DoubleReflection);
    assert!(back[64].r.distance(forth[0].r) < 8e-15);
    // Runge–Kutta is not symmetric.
    let knot = TrigonometricCurve::torus_knot();
    let mut parameters = uniform_parameters(&knot, 64);
    let forth = runge_kutta_frames(&knot, &parameters, -DVec3::X).unwrap();
    parameters.reverse();
    let back = runge_kutta_frames(&knot, &parameters, forth[64].r).unwrap();
    // Its error with 64 steps is 4e-2, of which a part does not cancel.
    assert!(back[64].r.distance(forth[0].r) > 1e-3);
}

#[test]
fn only_double_reflection_commutes_with_inversions() {
    let spine = knot_samples(64);
    for (center, squared_radius) in
        [(DVec3::new(0.1, 0.2, 1.5), 1.0), (DVec3::new(0.05, 0.0, 0.1), 0.5), (DVec3::new(2.0, -1.0, 0.3), 4.0)]
    {
        let inversion = Inversion { center, squared_radius };
        let image = inversion.spine(&spine).unwrap();
        let difference = |method| {
            let mapped: Vec<Frame> = propagate(&spine, -DVec3::X, method)
                .iter()
                .zip(spine.points())
                .map(|(frame, &point)| inversion.frame(point, frame))
                .collect();
            let direct = propagate(&image, mapped[0].r, method);
            mapped.iter().zip(&direct).map(|(a, b)| a.r.distance(b.r)).fold(0.0, f64::max)
        };
        // Rounding over 64 steps, amplified up to ten times near the center.
        assert!(difference(FrameMethod::DoubleReflection) < 2e-14, "{:e}", difference(FrameMethod::DoubleReflection));
        for rival in RIVALS {
            assert!(difference(rival) > 1e-2, "{rival:?}: {:e}", difference(rival));
        }
    }
}

/// Points and tangents of a wavy curve on the unit sphere.
fn spherical_samples(count: usize) -> Spine {
    let jets = (0..count).map(|i| {
        let u = 5.5 * i as f64 / (count - 1) as f64;
        let (height, slope) = (0.8 * libm::sin(2.3 * u), 0.8 * 2.3 * libm::cos(2.3 * u));
        let (radius, radius_slope) = ((1.0 - height * height).sqrt(), -height * slope / (1.0 - height * height).sqrt());
        let (sin, cos) = libm::sincos(u);
        let point = DVec3::new(radius * cos, radius * sin, height);
        let tangent = DVec3::new(radius_slope * cos - radius * sin, radius_slope * sin + radius * cos, slope);
        (point, tangent)
    });
    let (points, tangents) = jets.unzip();
    Spine::new(points, tangents, false).unwrap()
}

#[test]
fn eight_samples_of_a_spherical_curve_are_enough() {
    let spine = spherical_samples(8);
    // On a sphere, the normal makes a constant angle with every rotation-minimizing vector. Start
    // 45 degrees from the normal, because projection is exact for the normal itself.
    let start = Frame::new(spine.point(0), spine.tangent(0)).turned(std::f64::consts::FRAC_PI_4);
    let error = |method| {
        let last = propagate(&spine, start.r, method)[7];
        let exact = Frame::new(spine.point(7), spine.tangent(7)).turned(std::f64::consts::FRAC_PI_4);
        exact.angle_to(last.r).abs()
    };
    assert!(error(FrameMethod::DoubleReflection) < 5e-15, "{:e}", error(FrameMethod::DoubleReflection));
    for rival in RIVALS {
        assert!(error(rival) > 0.1, "{rival:?}: {:e}", error(rival));
    }
}

#[test]
fn planes_and_lines_are_exact() {
    let wave = FunctionCurve::new(
        |u| {
            let (sin, cos) = libm::sincos(u);
            isochore_curve::CurveJet {
                position: DVec3::new(u, sin, 0.0),
                first: DVec3::new(1.0, cos, 0.0),
                second: DVec3::new(0.0, -sin, 0.0),
                third: DVec3::new(0.0, -cos, 0.0),
            }
        },
        (0.0, 9.0),
        false,
    );
    let frames = propagate(&Spine::sample(&wave, 6).unwrap(), DVec3::Z, FrameMethod::DoubleReflection);
    assert!(frames.iter().all(|frame| frame.r.distance(DVec3::Z) < 1e-15), "the normal of the plane is constant");
    let line = Spine::new((0..5).map(|i| DVec3::ONE * f64::from(i * i)).collect(), vec![DVec3::ONE; 5], false).unwrap();
    let frames = propagate(&line, DVec3::X, FrameMethod::DoubleReflection);
    assert!(frames.iter().all(|frame| frame.r.distance(frames[0].r) < 1e-15));
}

#[test]
fn dense_samples_do_not_lose_accuracy() {
    let knot = TrigonometricCurve::torus_knot();
    for h in [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13] {
        let parameters: Vec<f64> = (0..=1000).map(|i| 0.3 + f64::from(i) * h).collect();
        let spine = Spine::from_jets(parameters.iter().map(|&u| knot.jet(u)), false).unwrap();
        let reference = knot.jet(0.3).normal().unwrap();
        let frames =
            rotation_minimizing_frames(&spine, reference, FrameMethod::DoubleReflection, DegenerateSegment::Refuse)
                .unwrap();
        assert!(frames.substituted.is_empty(), "all chords are nonzero");
        let exact = exact_frames(&knot, &[0.3, parameters[1000]], reference).unwrap();
        let last = frames.stations[1000];
        // A thousand steps with random rounding: √1000 · 2e-16 = 7e-15, and a margin of two.
        assert!(last.r.distance(exact[1].r) < 1.5e-14, "h = {h:e}: {:e}", last.r.distance(exact[1].r));
        assert!(last.r.dot(last.t).abs() < 1.5e-14);
        // The smallest rotation has no threshold either. It differs by its error of second order,
        // 2e-11.
        let rotated = propagate(&spine, reference, FrameMethod::Rotation)[1000];
        let bound = if h == 1e-5 { 2.5e-11 } else { 3e-14 };
        assert!(rotated.r.distance(exact[1].r) < bound, "h = {h:e}: {:e}", rotated.r.distance(exact[1].r));
    }
    // A threshold of 1e-8 on the turning of a step would skip all steps of 1e-9, which turn by
    // 6.83e-6 in total.
    let whole_turn = knot.jet(0.3).tangent().angle_between(knot.jet(0.3 + 1e-6).tangent());
    assert!((whole_turn - 6.83e-6).abs() < 5e-9, "{whole_turn:e}");
}

#[test]
fn s_curve_errors_shrink_with_its_height() {
    // Largest angle error with 64 segments, for the heights of Zheng's section 3.4. The torsion at
    // the midpoint is −2.4/height.
    for (height, expected, bound) in [
        (1.0, 4.750e-7, 5e-11),
        (0.1, 1.360e-7, 5e-11),
        (0.01, 1.378e-8, 5e-12),
        (1e-4, 1.378e-10, 1e-13),
        (1e-8, 1.3e-14, 1e-13),
        (0.0, 0.0, 1e-14),
    ] {
        let curve = Bezier::s_curve(height);
        let error = |segments: usize| {
            let spine = Spine::sample(&curve, segments).unwrap();
            let reference = orthogonal_reference(DVec3::Z, spine.tangent(0)).unwrap();
            let exact = exact_frames(&curve, &uniform_parameters(&curve, segments), reference).unwrap();
            let frames = propagate(&spine, reference, FrameMethod::DoubleReflection);
            frames.iter().zip(&exact).map(|(frame, exact)| exact.angle_to(frame.r).abs()).fold(0.0, f64::max)
        };
        assert!((error(64) - expected).abs() < bound, "height {height}: {:e}, expected {expected:e}", error(64));
        if height > 1e-3 {
            let ratio = error(128) / error(64);
            assert!((ratio - 0.0625).abs() < 2e-3, "fourth order at height {height}: {ratio}");
        }
    }
    let spine = Spine::sample(&Bezier::s_curve(0.01), 64).unwrap();
    let last = propagate(&spine, DVec3::Z, FrameMethod::DoubleReflection)[64];
    assert!(last.r.distance(DVec3::new(0.0, -0.024223273733433, 0.99970657345525)) < 1e-14, "{}", last.r);
}

/// The smallest rotation between tangents is double reflection along their sum.
#[test]
fn rotation_is_double_reflection_along_the_sum_of_the_tangents() {
    let spine = knot_samples(64);
    let mut r = DVec3::X.reject_from_normalized(spine.tangent(0)).normalize();
    for i in 0..64 {
        let (start, end) = (spine.tangent(i), spine.tangent(i + 1));
        let (rotated, reflected) = (rotate_minimally(start, end, r), reflect_twice(start + end, start, end, r));
        // About twelve roundings of numbers of size one.
        assert!(rotated.unwrap().distance(reflected.unwrap()) < 2e-15);
        r = rotated.unwrap();
    }
}

#[test]
fn degenerate_segments_are_rejected_or_rotated() {
    let frames = |spine: &Spine, degenerate| {
        rotation_minimizing_frames(spine, DVec3::Z, FrameMethod::DoubleReflection, degenerate)
    };
    // One tangent is reversed.
    let good = Spine::sample(&TrigonometricCurve::helix(1.0, 0.2, (0.0, 3.0)), 30).unwrap();
    let mut tangents = good.tangents().to_vec();
    tangents[12] = -tangents[12];
    let reversed = Spine::new(good.points().to_vec(), tangents, false).unwrap();
    let result = frames(&reversed, DegenerateSegment::Refuse);
    assert_eq!(result.unwrap_err(), FrameError::DegenerateSegment { segment: 11 });
    // The chord is normal to both equal tangents.
    let step = Spine::new(vec![DVec3::ZERO, DVec3::X], vec![DVec3::Y; 2], false).unwrap();
    assert_eq!(frames(&step, DegenerateSegment::Refuse).unwrap_err(), FrameError::DegenerateSegment { segment: 0 });
    let rotated = frames(&step, DegenerateSegment::Rotate).unwrap();
    assert_eq!((rotated.substituted, rotated.stations[1].r), (vec![0], DVec3::Z));
    // A cusp reverses the direction.
    let cusp = Spine::new(vec![DVec3::ZERO, DVec3::X], vec![DVec3::X, -DVec3::X], false).unwrap();
    assert_eq!(frames(&cusp, DegenerateSegment::Rotate).unwrap_err(), FrameError::OppositeTangents { segment: 0 });
}

#[test]
fn repeated_points_use_the_smallest_rotation() {
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::X, DVec3::new(1.0, 1.0, 0.0)];
    let spine = Spine::new(points, vec![DVec3::X, DVec3::X, DVec3::Y, DVec3::Y], false).unwrap();
    for method in [FrameMethod::DoubleReflection, FrameMethod::Projection] {
        let frames = rotation_minimizing_frames(&spine, DVec3::Y, method, DegenerateSegment::Refuse).unwrap();
        assert_eq!(frames.substituted, [1]);
        assert!(frames.stations[3].r.distance(-DVec3::X) < 1e-15, "the frame rotates in the plane of the corner");
    }
}

#[test]
fn rejects_references_along_the_tangent() {
    let spine = Spine::sample(&TrigonometricCurve::helix(1.0, 0.2, (0.0, 3.0)), 9).unwrap();
    for bad in [spine.tangent(0) * 3.0, DVec3::ZERO, DVec3::NAN, DVec3::splat(f64::INFINITY)] {
        let result = rotation_minimizing_frames(&spine, bad, FrameMethod::DoubleReflection, DegenerateSegment::Refuse);
        assert_eq!(result.unwrap_err(), FrameError::Reference, "{bad}");
    }
}

proptest! {
    /// For all samples, the result is an error or orthonormal right-handed frames.
    #[test]
    fn frames_are_orthonormal_or_rejected(
        coordinates in prop::collection::vec(-3.0..3.0f64, 30),
        reference in prop::array::uniform3(-1.0..1.0f64),
        closed: bool,
        method in prop::sample::select(vec![
            FrameMethod::DoubleReflection,
            FrameMethod::Projection,
            FrameMethod::Rotation,
            FrameMethod::TangentsOnly,
        ]),
    ) {
        let vectors: Vec<DVec3> = coordinates.chunks(3).map(DVec3::from_slice).collect();
        let Ok(spine) = Spine::new(vectors[..5].to_vec(), vectors[5..].to_vec(), closed) else { return Ok(()) };
        let reference = DVec3::from_array(reference);
        if let Ok(frames) = rotation_minimizing_frames(&spine, reference, method, DegenerateSegment::Rotate) {
            prop_assert_eq!(frames.stations.len(), spine.segments() + 1);
            for frame in frames.stations {
                // A reflection amplifies rounding up to 1/√(c₂/4) = 10 times per step. A nearly
                // parallel reference amplifies it up to 1e10 times, which the second
                // orthogonalization removes.
                prop_assert!((frame.r.length() - 1.0).abs() < 1e-12);
                prop_assert!(frame.r.dot(frame.t).abs() < 1e-10);
                prop_assert!((frame.r.cross(frame.s) - frame.t).length() < 1e-10);
            }
        }
    }

    /// For Hermite data of any size and shape, the result is an error or a finite curve with finite
    /// frames.
    #[test]
    fn rational_segments_are_finite_or_rejected(
        coordinates in prop::collection::vec(-1.0..1.0f64, 12),
        exponent in -45..45i32,
        flat in prop::sample::select(vec![1.0, 1e-3, 1e-8, 1e-15, 0.0]),
    ) {
        let vectors: Vec<DVec3> = coordinates.chunks(3).map(|c| DVec3::new(c[0], c[1], c[2] * flat)).collect();
        let scale = 10f64.powi(exponent);
        let (start, end) = (vectors[0] * scale, vectors[1] * scale);
        let parameters = [0.0, 0.3, 1.0];
        let is_good = |frames: &[Frame]| frames.iter().all(|f| f.r.is_finite() && f.t.is_finite() && f.s.is_finite());
        if let Ok(cubic) = PhCubic::hermite(start, end, vectors[2], vectors[3]) {
            prop_assert!(cubic.control_points().iter().all(|point| point.is_finite()));
            prop_assert!(cubic.rotation_to(1.0).is_finite() && cubic.length() > 0.0);
            if let Ok(frames) = cubic.exact_frames(&parameters, DVec3::Z) {
                prop_assert!(is_good(&frames), "{frames:?}");
            }
        }
        if let Ok(segment) = MoebiusSegment::hermite(start, end, vectors[2], vectors[3], Tilt::WhenNeeded) {
            prop_assert!(parameters.iter().all(|&u| segment.position(u).is_finite()));
            if let Ok(frames) = segment.frames(&parameters, DVec3::Z) {
                prop_assert!(is_good(&frames), "{frames:?}");
            }
        }
    }
}
