use super::*;
use crate::fields::field::{
    finite_differences::{deviation, scattered_points},
    flux::{QUADRATURE_NOISE, worst_field_flux},
};

const GOLDEN: RingShape =
    RingShape { center: DVec3::ZERO, axis: DVec3::Z, major: 1.0, minor: 0.25, support: 0.3, profile: Profile::Quintic };

pub(crate) const TILTED: RingShape =
    RingShape { center: DVec3::new(0.1, -0.2, 0.05), axis: DVec3::new(1.0, 2.0, -2.0), ..GOLDEN };

fn at(shape: RingShape, time: f64) -> Box<dyn Field> {
    Ring::new(shape, 0.7).unwrap().at(time)
}

#[test]
fn the_core_moves_at_unit_speed_everywhere() {
    let field = Ring::new(GOLDEN, 1.0).unwrap().at(0.0);
    assert!(field.velocity(DVec3::new(1.1, 0.2, 0.05)).distance(DVec3::Z) < 1e-15);
    for i in 0..100 {
        let (sin, cos) = libm::sincos(0.0628 * f64::from(i));
        let (across, height) = libm::sincos(0.61 * f64::from(i));
        let radius = 1.0 + 0.24 * across;
        let point = DVec3::new(radius * cos, radius * sin, 0.24 * height);
        // Within a few roundings.
        assert!(field.velocity(point).distance(DVec3::Z) < 4e-15, "{point}");
    }
}

#[test]
fn the_field_is_the_curl_of_its_potential() {
    for field in [at(GOLDEN, 0.0), at(TILTED, 0.6)] {
        let seen = deviation(&*field, &scattered_points(400, 1.5), 1e-4);
        // Truncation: h²/6 of derivatives of the quintic over a support of 0.3, of the order of 60/R³ and 360/R⁴.
        assert!(seen.curl < 1e-4 && seen.divergence < 1e-4 && seen.gradient < 1e-4, "{seen:?}");
    }
    let seen =
        deviation(&*at(RingShape { profile: Profile::Contact, ..TILTED }, 0.3), &scattered_points(400, 1.5), 1e-4);
    // The second derivative of the profile jumps inside the tube. Differences across the jump are
    // of first order in h.
    assert!(seen.curl < 1e-3 && seen.divergence < 1e-2, "{seen:?}");
}

#[test]
fn the_net_flux_is_zero() {
    for field in [at(GOLDEN, 0.0), at(TILTED, 0.5)] {
        assert!(worst_field_flux(&*field, |_| f64::INFINITY, 1.0) < QUADRATURE_NOISE);
    }
}

#[test]
fn bounds_and_clearance_contain_the_support() {
    let field = at(TILTED, 0.4);
    let mut outside = 0;
    for point in scattered_points(2000, 2.5) {
        let mut block = FieldBlock::ZERO;
        field.evaluate_into(&PointBlock::splat(point), &mut block);
        let clearance = block.clearance[0];
        assert!(clearance > 0.0 || field.bounds().distance(point) == 0.0);
        if clearance > 0.0 {
            outside += 1;
            // Every point nearer than the clearance has zero velocity.
            for direction in [DVec3::X, DVec3::Y, DVec3::Z, TILTED.axis.normalize()] {
                assert_eq!(field.velocity(point + 0.999 * clearance * direction), DVec3::ZERO);
            }
        }
    }
    assert!(outside > 1000, "{outside}");
}

#[test]
fn rejects_invalid_rings() {
    let error = |shape: RingShape| Ring::new(shape, 1.0).unwrap_err();
    assert_eq!(
        error(RingShape { support: 0.75, ..GOLDEN }),
        RingError::ReachesAxis { major: 1.0, minor: 0.25, support: 0.75 }
    );
    assert_eq!(error(RingShape { axis: DVec3::ZERO, ..GOLDEN }), RingError::ZeroAxis);
    assert_eq!(error(RingShape { minor: 0.0, ..GOLDEN }), RingError::NotPositive { what: "minor radius", value: 0.0 });
    assert_eq!(error(RingShape { profile: Profile::Thesis, ..GOLDEN }), RingError::Profile(Profile::Thesis));
    assert_eq!(error(RingShape { center: DVec3::NAN, ..GOLDEN }), RingError::NotFinite("the center"));
    assert_eq!(Ring::new(GOLDEN, f64::INFINITY).unwrap_err(), RingError::NotFinite("the distance"));
}
