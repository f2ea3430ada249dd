//! Tests of [`Spine`]: errors, cusps, the default reference, reversal.

use super::*;
use crate::{Bezier, TrigonometricCurve};

#[test]
fn errors_name_the_invalid_sample() {
    let error = |points: &[DVec3], tangents: &[DVec3], closed| {
        Spine::new(points.to_vec(), tangents.to_vec(), closed).unwrap_err()
    };
    assert_eq!(error(&[DVec3::X], &[DVec3::X], false), SpineError::TooFewPoints { count: 1, needed: 2 });
    assert_eq!(error(&[DVec3::X; 2], &[DVec3::X], false), SpineError::TangentCount { points: 2, tangents: 1 });
    let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0, DVec3::X * 9.0];
    assert_eq!(error(&[DVec3::X, DVec3::NAN], &line[..2], false), SpineError::PointNotFinite { index: 1 });
    let infinite = [DVec3::X, DVec3::splat(f64::INFINITY)];
    assert_eq!(error(&line[..2], &infinite, false), SpineError::TangentNotFinite { index: 1 });
    assert_eq!(error(&line[..2], &[DVec3::X, DVec3::ZERO], false), SpineError::ZeroTangent { index: 1 });
    let repeated = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::X];
    assert_eq!(error(&repeated, &[DVec3::X; 4], true), SpineError::ClosingPointRepeated { index: 3 });
    let open: Vec<DVec3> = (0..9).map(|i| DVec3::X * f64::from(i)).collect();
    assert_eq!(error(&open, &[DVec3::X; 9], true), SpineError::NotClosed { gap: 8.0, longest: 1.0 });
}

#[test]
fn a_cusp_has_a_zero_tangent() {
    // (t³, t²): the tangent vanishes at the midpoint of [−1, 1].
    let cusp = Bezier::new(
        [(-1.0, 1.0), (1.0, -1.0 / 3.0), (-1.0, -1.0 / 3.0), (1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
    );
    assert_eq!(Spine::sample(&cusp, 4).unwrap_err(), SpineError::ZeroTangent { index: 2 });
}

#[test]
fn default_reference_is_the_frenet_normal_of_a_curved_spine() {
    // One-sided differences of fourth order: the error is h⁴/5 times the fifth derivative, with
    // h = 0.06.
    let helix = TrigonometricCurve::helix(1.0, 0.5, (0.0, 6.0));
    let reference = Spine::sample(&helix, 100).unwrap().default_reference();
    assert!((reference - helix.jet(0.0).normal().unwrap()).length() < 2e-5);
    let line = Spine::new(vec![DVec3::ZERO, DVec3::Z], vec![DVec3::Z; 2], false).unwrap();
    assert_eq!(line.default_reference(), DVec3::X);
}

#[test]
fn reversal_twice_is_the_identity() {
    for closed in [false, true] {
        let points: Vec<DVec3> = [DVec3::X, DVec3::Y, DVec3::Z].to_vec();
        let spine = Spine::new(points.clone(), points, closed).unwrap();
        assert_eq!(spine.reversed().reversed(), spine);
        assert_eq!(closed, spine.reversed().points()[0] == DVec3::X);
    }
}
