//! The S-shaped curve of Zheng's thesis, section 3.4. As its height tends to zero, the torsion at
//! the midpoint tends to −π times a delta function. Quadrature of the torsion then fails, but
//! frames remain accurate.
#![allow(clippy::excessive_precision, reason = "golden values keep all computed digits")]

use std::f64::consts::TAU;

use glam::DVec3;
use isochore_curve::{
    Bezier, Curve, DegenerateSegment, FrameMethod, Spine, exact_frames, orthogonal_reference, reflect_twice,
    rotation_minimizing_frames,
};

/// ∫ τ ds up to full turns, without quadrature of the torsion: rotation of the Frenet frame
/// relative to an exact frame.
fn total_torsion_by_frames(curve: &Bezier) -> f64 {
    let ends = [0.0, 1.0];
    let frames = exact_frames(curve, &ends, DVec3::Z).unwrap();
    let [start, end] = [0, 1].map(|i| frames[i].angle_to(curve.jet(ends[i]).normal().unwrap()));
    end - start
}

/// Torsion times speed at `position` steps of 1/64.
fn torsion_rate(curve: &Bezier, position: f64) -> f64 {
    let jet = curve.jet(position / 64.0);
    let binormal = jet.first.cross(jet.second);
    binormal.dot(jet.third) / binormal.length_squared() * jet.speed()
}

#[test]
fn frames_give_the_total_torsion_at_any_height() {
    for (height, exact) in [
        (1.0, -2.6400277700176),
        (0.1, -3.0991283131075),
        (0.01, -3.137366329922),
        (1e-4, -3.1415503924087),
        (1e-8, -3.1415926493637),
    ] {
        let difference = total_torsion_by_frames(&Bezier::s_curve(height)) - exact;
        // The reference values have 13 and 14 digits; the exact frame adds 1e-13.
        let wrapped = difference - TAU * (difference / TAU).round();
        assert!(wrapped.abs() < 6e-13, "height {height}: {wrapped:e}");
    }
}

#[test]
fn quadrature_of_torsion_fails_on_low_curves() {
    // Height, then the results of the midpoint rule and Simpson's rule with 64 parts.
    for (height, midpoint, midpoint_bound, simpson, simpson_bound) in [
        (1.0, -2.640150, 5e-7, -2.64003, 5e-6),
        (0.1, -3.0446, 5e-5, -2.9569, 5e-5),
        (0.01, -0.7266, 5e-5, -9.123, 5e-4),
        (1e-4, -0.0074, 5e-5, -883.9, 0.05),
        (1e-8, -1e-6, 5e-7, -8.8e6, 5e4),
    ] {
        let curve = Bezier::s_curve(height);
        let by_midpoint = (0..64).map(|i| torsion_rate(&curve, f64::from(i) + 0.5)).sum::<f64>() / 64.0;
        let by_simpson = (0..64)
            .step_by(2)
            .map(f64::from)
            .map(|i| torsion_rate(&curve, i) + 4.0 * torsion_rate(&curve, i + 1.0) + torsion_rate(&curve, i + 2.0))
            .sum::<f64>()
            / 192.0;
        assert!((by_midpoint - midpoint).abs() < midpoint_bound, "height {height}: midpoint {by_midpoint}");
        assert!((by_simpson - simpson).abs() < simpson_bound, "height {height}: Simpson {by_simpson}");
    }
    // On the planar curve, the torsion at the inflection is 0/0. Only Simpson's rule samples it.
    let plane = Bezier::s_curve(0.0);
    assert!(torsion_rate(&plane, 32.0).is_nan());
    assert!((0..64).all(|i| torsion_rate(&plane, f64::from(i) + 0.5) == 0.0));
}

#[test]
fn low_curves_have_the_golden_end_frames() {
    let curve = Bezier::s_curve(0.01);
    let exact = exact_frames(&curve, &[0.0, 1.0], DVec3::Z).unwrap()[1].r;
    // The reference values have 15 digits.
    assert!(exact.distance(DVec3::new(0.0, -0.024223287508502, 0.99970657312147)) < 1e-14, "{exact}");
    let spine = Spine::sample(&curve, 64).unwrap();
    let frames =
        rotation_minimizing_frames(&spine, DVec3::Z, FrameMethod::DoubleReflection, DegenerateSegment::Refuse).unwrap();
    let reflected = frames.stations[64].r;
    assert!(reflected.distance(DVec3::new(0.0, -0.024223273733433, 0.99970657345525)) < 1e-14, "{reflected}");
}

/// Second derivative at `at` of a function that is even about `at`, by differences of eighth order.
fn second_derivative(function: impl Fn(f64) -> f64, at: f64) -> f64 {
    // Truncation error step⁸ and rounding error ε/step² are both near 1e-11.
    let step = 2e-3;
    let weights = [8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];
    let pairs = (1..).zip(weights).map(|(i, weight)| {
        let offset = f64::from(i) * step;
        weight * (function(at - offset) + function(at + offset))
    });
    (pairs.sum::<f64>() - 205.0 / 72.0 * function(at)) / (step * step)
}

#[test]
fn the_midpoint_has_the_published_series() {
    for h in [0.5f64, 1.0, 2.0] {
        let curve = Bezier::s_curve(h);
        let middle = curve.jet(0.5);
        let (kappa, tau) = (0.8 * h, -2.4 / h);
        assert!((middle.curvature() / kappa - 1.0).abs() < 1e-14 && (middle.torsion() / tau - 1.0).abs() < 1e-13);
        // The curve is symmetric under a half turn about the x axis, so both are even about the
        // midpoint: κ₁ = τ₁ = 0.
        for offset in [0.01, 0.1, 0.3] {
            let (before, after) = (curve.jet(0.5 - offset), curve.jet(0.5 + offset));
            assert!((before.curvature() / after.curvature() - 1.0).abs() < 1e-12);
            assert!((before.torsion() / after.torsion() - 1.0).abs() < 1e-11);
        }
        // Second derivative of an even function with respect to arc length. The thesis prints the
        // opposite sign.
        let squared_speed = middle.first.length_squared();
        let kappa_second = second_derivative(|u| curve.jet(u).curvature(), 0.5) / squared_speed;
        let expected = 192.0 * (3.0 + 3.0 * h * h - h.powi(4)) / (125.0 * h);
        assert!((kappa_second - expected).abs() < 1e-9, "height {h}: {kappa_second}, expected {expected}");
        // With κ₁ = τ₁ = 0, the constant of theorem 4.4 is κ₀²τ₀³ − κ₀κ₂τ₀.
        let constant = 9216.0 * h * (3.0 - h * h) / 3125.0;
        assert!((kappa * kappa * tau * tau * tau - kappa * kappa_second * tau - constant).abs() < 1e-8);
    }
}

/// Theorem 4.4 for heights at which its constant K changes sign: a step lags by K length⁵/720.
#[test]
fn a_step_across_the_midpoint_has_the_published_error() {
    for h in [0.1f64, 0.5, 1.0, 2.0] {
        let curve = Bezier::s_curve(h);
        let constant = 9216.0 * h * (3.0 - h * h) / 3125.0;
        let ratio = |half: f64| {
            let parameters = [0.5 - half, 0.5 + half];
            let [start, end] = parameters.map(|u| curve.jet(u));
            let r = orthogonal_reference(DVec3::Z, start.tangent()).unwrap();
            let stepped = reflect_twice(end.position - start.position, start.tangent(), end.tangent(), r).unwrap();
            let exact = exact_frames(&curve, &parameters, r).unwrap()[1];
            let length = 2.0 * half * curve.jet(0.5).speed();
            -exact.angle_to(stepped) * 720.0 / (constant * length.powi(5))
        };
        // The ratio is one up to the squared step. Extrapolation removes this term and leaves the
        // fourth power.
        let extrapolated = (4.0 * ratio(0.01) - ratio(0.02)) / 3.0;
        assert!((extrapolated - 1.0).abs() < 3e-5, "height {h}: {extrapolated}");
    }
}
