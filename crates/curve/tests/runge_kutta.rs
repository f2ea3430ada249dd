//! Other methods on the torus knot of Wang et al. 2008: variants of Runge–Kutta, and projection
//! onto the next normal plane. They show that the published errors determine the differential
//! equation, the start and the error measure.

use std::f64::consts::TAU;

use glam::DVec3;
use isochore_curve::{
    Curve, DegenerateSegment, FrameMethod, Spine, TrigonometricCurve, exact_frames, orthogonal_reference,
    rotation_minimizing_frames, runge_kutta_frames, uniform_parameters,
};

/// Right-hand sides that agree only while r is normal to t.
#[derive(Debug, Clone, Copy)]
enum Equation {
    /// r′ = −(r · t′) t.
    Tangential,
    /// r′ = (t × t′) × r, equation (6).
    AngularVelocity,
}

fn knot() -> TrigonometricCurve {
    TrigonometricCurve::torus_knot()
}

fn normal() -> DVec3 {
    -DVec3::X
}

fn binormal() -> DVec3 {
    knot().jet(0.0).tangent().cross(normal())
}

/// Integrated reference vectors, one per parameter, projected into the normal plane after each step
/// if `projected`.
fn integrate(equation: Equation, projected: bool, parameters: &[f64], reference: DVec3) -> Vec<DVec3> {
    let rate = |parameter: f64, r: DVec3| {
        let jet = knot().jet(parameter);
        let (tangent, derivative) = (jet.tangent(), jet.tangent_derivative());
        match equation {
            Equation::Tangential => -tangent * r.dot(derivative),
            Equation::AngularVelocity => tangent.cross(derivative).cross(r),
        }
    };
    let mut vectors = vec![orthogonal_reference(reference, knot().jet(parameters[0]).tangent()).unwrap()];
    for (i, pair) in parameters.windows(2).enumerate() {
        let (start, end) = (pair[0], pair[1]);
        let (step, middle) = (end - start, 0.5 * (start + end));
        let k1 = rate(start, vectors[i]);
        let k2 = rate(middle, vectors[i] + k1 * (0.5 * step));
        let k3 = rate(middle, vectors[i] + k2 * (0.5 * step));
        let k4 = rate(end, vectors[i] + k3 * step);
        let r = vectors[i] + (k1 + 2.0 * k2 + 2.0 * k3 + k4) * (step / 6.0);
        vectors.push(if projected { orthogonal_reference(r, knot().jet(end).tangent()).unwrap() } else { r });
    }
    vectors
}

/// Largest distance of the integrated vectors from the exact ones, over 512 steps.
fn largest_error(equation: Equation, projected: bool, reference: DVec3) -> f64 {
    let parameters = uniform_parameters(&knot(), 512);
    let exact = exact_frames(&knot(), &parameters, reference).unwrap();
    integrate(equation, projected, &parameters, reference)
        .iter()
        .zip(&exact)
        .map(|(r, exact)| r.distance(exact.r))
        .fold(0.0, f64::max)
}

#[test]
fn the_table_uses_the_tangential_equation_without_projection() {
    // The published error of 512 steps is 9.10e-6. The reference values have four digits; the exact
    // frame adds 1e-13.
    for (equation, projected, expected) in [
        (Equation::Tangential, true, 2.593e-6),
        (Equation::AngularVelocity, false, 6.317e-6),
        (Equation::AngularVelocity, true, 6.154e-6),
    ] {
        let error = largest_error(equation, projected, normal());
        assert!((error - expected).abs() < 5.1e-10, "{equation:?}, projected {projected}: {error:e}");
    }
    // Starting from the binormal, the same equation has a different error. The reference value has
    // three digits.
    let error = largest_error(Equation::Tangential, false, binormal());
    assert!((error - 5.50e-6).abs() < 5e-9, "{error:e}");
}

#[test]
fn the_public_method_is_the_one_of_the_table() {
    let parameters = uniform_parameters(&knot(), 512);
    let bare = integrate(Equation::Tangential, false, &parameters, normal());
    let offered = runge_kutta_frames(&knot(), &parameters, normal()).unwrap();
    for (bare, frame) in bare.iter().zip(&offered) {
        let in_plane = orthogonal_reference(*bare, frame.t).unwrap();
        assert!(in_plane.distance(frame.r) < 1e-15, "the same steps; only the result is projected");
    }
}

/// Angle errors of `method` at all stations.
fn angle_errors(method: FrameMethod, segments: usize, reference: DVec3) -> Vec<f64> {
    let spine = Spine::sample(&knot(), segments).unwrap();
    let frames = rotation_minimizing_frames(&spine, reference, method, DegenerateSegment::Refuse).unwrap();
    let exact = exact_frames(&knot(), &uniform_parameters(&knot(), segments), reference).unwrap();
    frames.stations.iter().zip(&exact).map(|(frame, exact)| exact.angle_to(frame.r).abs()).collect()
}

#[test]
fn projection_is_published_at_the_end_point_and_from_the_normal() {
    let largest = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
    // Segments, error at the end and largest error, with four and five digits. Published: 9.03e-2
    // and 3.52e-4.
    for (segments, end, max, unit) in [(128, 9.030e-2, 9.054e-2, 1e-5), (2048, 3.5235e-4, 3.5356e-4, 1e-8)] {
        let errors = angle_errors(FrameMethod::Projection, segments, normal());
        assert!((errors[segments] - end).abs() < 0.51 * unit, "{segments}: {:e}", errors[segments]);
        assert!((largest(&errors) - max).abs() < 0.51 * unit, "{segments}: {:e}", largest(&errors));
    }
    // Published for 512 segments: 5.64e-3.
    for (reference, end) in [(normal(), 5.638e-3), (binormal(), 6.235e-3)] {
        let errors = angle_errors(FrameMethod::Projection, 512, reference);
        assert!((errors[512] - end).abs() < 5.1e-7, "{:e}", errors[512]);
    }
    // The error of double reflection is largest at the end, so its rows do not distinguish the two
    // measures.
    for segments in [128, 512, 2048] {
        let errors = angle_errors(FrameMethod::DoubleReflection, segments, normal());
        assert_eq!(errors[segments], largest(&errors));
    }
}

#[test]
fn runge_kutta_is_not_symmetric() {
    let mut there_and_back = uniform_parameters(&knot(), 64);
    let back: Vec<f64> = there_and_back[..64].iter().rev().copied().collect();
    there_and_back.extend(back);
    let returned = integrate(Equation::Tangential, true, &there_and_back, normal())[128];
    // The reference value has two digits.
    assert!((returned.distance(normal()) - 1.2e-3).abs() < 5e-5, "{:e}", returned.distance(normal()));
}

#[test]
fn projection_normal_to_the_next_plane_is_of_first_order() {
    let end_error = |segments: usize| {
        let projected = uniform_parameters(&knot(), segments)
            .iter()
            .fold(normal(), |r, &u| r.reject_from_normalized(knot().jet(u).tangent()).normalize());
        exact_frames(&knot(), &[0.0, TAU], normal()).unwrap()[1].angle_to(projected).abs()
    };
    // The reference value has two digits.
    assert!((end_error(2048) - 3.3e-2).abs() < 5e-4, "{:e}", end_error(2048));
    let ratio = end_error(16384) / end_error(8192);
    assert!((ratio - 0.5).abs() < 0.01, "{ratio}");
}
