use std::f64::consts::{PI, TAU};

use glam::DVec2;
use isochore_curve::{CubicSpline, EndCondition, Parametrization, TrigonometricCurve};
use isochore_mesh::{Ellipsoid, LANES, PointBlock, Sphere};

use super::*;
use crate::fields::{
    FieldBlock, Profile,
    field::{
        finite_differences::{deviation, scattered_points},
        flux::{QUADRATURE_NOISE, worst_field_flux, worst_flux},
    },
};

const ALONG: StripMotion = StripMotion::Along { distance: 1.0 };
pub(crate) const TRAVEL: DVec3 = DVec3::new(0.3, -0.5, 0.8);
pub(crate) const ACROSS: StripMotion = StripMotion::Across { travel: TRAVEL };

/// The helix (cos, sin, 0.35 ·) of length 4, used with radius 0.25 and support 0.3.
fn helix() -> TrigonometricCurve {
    TrigonometricCurve::helix(1.0, 0.35, (0.0, 4.0 / helix_speed()))
}

fn helix_speed() -> f64 {
    (1.0_f64 + 0.35 * 0.35).sqrt()
}

pub(crate) fn round() -> StripShape {
    StripShape::round(0.25, 0.3, Profile::Quintic).unwrap()
}

fn helix_strip(motion: StripMotion) -> Strip {
    Strip::new(StripSpine::along(Arc::new(helix())), round(), motion).unwrap()
}

pub(crate) const START: [DVec3; 5] = [
    DVec3::new(-1.6, 0.0, 0.0),
    DVec3::new(-0.8, -0.1, 0.1),
    DVec3::new(0.0, 0.05, 0.05),
    DVec3::new(0.7, 0.1, -0.1),
    DVec3::new(1.7, -0.1, 0.05),
];

/// The same points, bent and displaced.
pub(crate) fn end() -> Vec<DVec3> {
    START.iter().map(|point| *point + DVec3::new(-0.1 * point.x, 0.2 * point.x * point.x - 0.1, 0.2)).collect()
}

fn square() -> StripShape {
    let corners = [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [-0.2, 0.1]].map(DVec2::from_array);
    StripShape::polygon(&corners, Some(DVec3::Z), 0.25, Profile::Quintic).unwrap()
}

fn ellipsoid() -> StripShape {
    let shape = Ellipsoid::new(DVec3::new(0.3, 0.15, 0.12)).unwrap();
    StripShape::tool(Arc::new(Tool::new(Arc::new(shape), 0.2, Profile::Quintic).unwrap())).unwrap()
}

/// Every kind of cross-section, along and across, on constant and deforming spines.
pub(crate) fn all_strips() -> Vec<Strip> {
    let shapes = || {
        let varying = StripShape::varying(&[0.15, 0.25, 0.1], 0.25, Profile::Quintic).unwrap();
        let septic = StripShape::round(0.2, 0.25, Profile::Septic).unwrap();
        [septic, varying, square(), ellipsoid()]
    };
    let mut strips = Vec::new();
    for motion in [ALONG, ACROSS] {
        strips.push(helix_strip(motion));
        for spine in [StripSpine::through(&START).unwrap(), StripSpine::between(&START, &end()).unwrap()] {
            strips.extend(shapes().map(|shape| Strip::new(spine.clone(), shape, motion).unwrap()));
        }
    }
    strips
}

/// Points near the spines above, chosen to avoid the normal planes at knots.
fn near_points(count: u32) -> Vec<DVec3> {
    scattered_points(count, 1.0).into_iter().map(|point| point * DVec3::new(1.8, 0.7, 0.6)).collect()
}

#[test]
fn golden_velocity_along_a_helix() {
    let field = helix_strip(ALONG).at(0.0);
    let point = DVec3::new(0.173729986128, 0.681309876668, 0.240683880873);
    let expected = DVec3::new(0.795430087475, -0.284760874097, -0.295702938751);
    // The data have twelve digits; the velocity changes by up to seven times the change of the
    // point.
    assert!(field.velocity(point).distance(expected) < 4e-12, "{}", field.velocity(point));
}

/// Points within 0.24 of the helix with the factor 1 − κξ and the Frenet frame.
fn core_points() -> impl Iterator<Item = (DVec3, f64, DVec3, DVec3)> {
    let curve = helix();
    (0..60).map(move |index| {
        let length = 0.7 + 2.6 * f64::from(index) / 59.0;
        let jet = curve.jet(length / helix_speed());
        let (normal, tangent) = (jet.normal().unwrap(), jet.tangent());
        let (sin, cos) = libm::sincos(2.4 * f64::from(index));
        let radius = 0.24 * f64::from(index % 5) / 4.0;
        let toward = radius * cos;
        let point = jet.position + toward * normal + radius * sin * tangent.cross(normal);
        (point, 1.0 - jet.curvature() * toward, tangent, normal)
    })
}

#[test]
fn the_core_along_streams_at_unit_speed() {
    let field = helix_strip(StripMotion::Along { distance: 0.7 }).at(0.3);
    for (point, _, tangent, _) in core_points() {
        // The nearest parameter has a few rounding errors, and the tangent varies with it.
        assert!(field.velocity(point).distance(0.7 * tangent) < 1e-14, "{point}");
    }
}

#[test]
fn the_core_across_moves_with_the_spine() {
    let field = helix_strip(ACROSS).at(0.0);
    let (mut slowest, mut fastest) = (f64::INFINITY, 0.0_f64);
    for (point, stretch, tangent, _) in core_points() {
        let across = TRAVEL - tangent * tangent.dot(TRAVEL);
        assert!(field.velocity(point).distance(across / stretch) < 1e-14, "{point}");
        slowest = slowest.min(1.0 / stretch);
        fastest = fastest.max(1.0 / stretch);
    }
    // The core has radius 0.24, the spine the curvature 0.89.
    assert!(slowest < 0.85 && fastest > 1.2, "{slowest} {fastest}");
}

#[test]
fn every_strip_is_the_curl_of_its_potential() {
    for (index, strip) in all_strips().iter().enumerate() {
        let field = strip.at(0.6);
        let points: Vec<DVec3> = near_points(250)
            .into_iter()
            .map(|point| point + if index % 9 == 0 { DVec3::Y } else { 0.6 * strip.travel() })
            .collect();
        let inside = points.iter().filter(|point| field.velocity(**point) != DVec3::ZERO).count();
        assert!(inside > 5, "{index}: {inside}");
        let seen = deviation(&*field, &points, 1e-5);
        // Truncation: h²/6 of derivatives of the profile of the order of 60/R³ and 360/R⁴, 1e-6. A
        // step h across a knot of the spine, where third derivatives jump, adds h times the jump
        // over the squared support.
        assert!(seen.curl < 1e-4 && seen.divergence < 3e-3 && seen.gradient < 1e-4, "{index}: {seen:?}");
    }
}

#[test]
fn the_net_flux_is_zero() {
    // Skips constant splines, which equal the deforming ones at another time.
    for (index, strip) in all_strips().iter().enumerate().filter(|(index, _)| !(1..5).contains(&(index % 9))) {
        let flux = worst_field_flux(&*strip.at(0.4), |_| f64::INFINITY, 0.7);
        assert!(flux < QUADRATURE_NOISE, "{index}: {flux:e}");
    }
}

/// Largest change of the velocity across the end plane of the spine, over 2e-7.
fn jump_at_the_end(strip: &Strip) -> f64 {
    let field = strip.at(0.0);
    let end = *START.last().unwrap();
    let jet = CubicSpline::open(&START, Parametrization::Centripetal, EndCondition::Natural).unwrap();
    let tangent = jet.jet(jet.domain().1).tangent();
    let side = tangent.any_orthonormal_vector();
    let h = 1e-7;
    (0..20)
        .map(|index| {
            let (sin, cos) = libm::sincos(0.3 * f64::from(index));
            let point = end + 0.3 * (cos * side + sin * tangent.cross(side));
            field.velocity(point + h * tangent).distance(field.velocity(point - h * tangent))
        })
        .fold(0.0, f64::max)
}

#[test]
fn the_ends_are_continuous() {
    for shape in [StripShape::round(0.2, 0.25, Profile::Quintic).unwrap(), square()] {
        let at_end =
            |motion| jump_at_the_end(&Strip::new(StripSpine::through(&START).unwrap(), shape.clone(), motion).unwrap());
        // Along: Lipschitz, with a slope near 10 over 2e-7. Across: the field fades to zero at the
        // ends, and so does its first derivative.
        assert!(at_end(ALONG) < 5e-6, "{:e}", at_end(ALONG));
        assert!(at_end(ACROSS) < 1e-12, "{:e}", at_end(ACROSS));
    }
}

#[test]
fn two_half_rings_move_material_like_a_ring() {
    // Two arcs overlap by their fading ends, where the two weights add up to one.
    let fade = 0.55;
    let half = |middle: f64| {
        let reach = 0.5 * (PI + fade);
        let arc = TrigonometricCurve::helix(1.0, 0.0, (middle - reach, middle + reach));
        let strip = Strip::new(StripSpine::along(Arc::new(arc)), round(), StripMotion::Across { travel: DVec3::Z });
        strip.unwrap().at(0.0)
    };
    let halves = [half(0.0), half(PI)];
    let velocity = |point: DVec3| halves[0].velocity(point) + halves[1].velocity(point);
    for index in 0..200 {
        let (sin, cos) = libm::sincos(TAU * f64::from(index) / 200.0);
        let radius = 1.0 + 0.17 * libm::cos(0.9 * f64::from(index));
        let point = DVec3::new(radius * cos, radius * sin, 0.17 * libm::sin(0.9 * f64::from(index)));
        // The core moves at 1/(1 − κξ) = 1/ρ; the closed form at 1. The arc length is interpolated.
        assert!(velocity(point).distance(DVec3::Z / radius) < 1e-9, "{index}");
    }
    let sum = |points: &PointBlock| {
        let mut total = PointBlock::ZERO;
        for half in &halves {
            let mut block = FieldBlock::ZERO;
            half.evaluate_into(points, &mut block);
            (0..LANES).for_each(|lane| total.set(lane, total.get(lane) + block.velocity.get(lane)));
        }
        total
    };
    assert!(worst_flux(sum, |_| f64::INFINITY, 1.0) < QUADRATURE_NOISE);
}

#[test]
fn the_field_is_zero_within_the_clearance_now_and_soon() {
    for (index, strip) in all_strips().iter().enumerate() {
        let (now, later) = (strip.at(0.3), strip.at(0.5));
        let approach = 0.2 * strip.approach_speed();
        let mut sleeping = 0;
        for point in scattered_points(400, 3.0) {
            let mut block = FieldBlock::ZERO;
            now.evaluate_into(&PointBlock::splat(point), &mut block);
            let clearance = block.clearance[0].max(now.bounds().distance(point));
            if clearance <= 0.0 {
                assert_eq!(now.bounds().distance(point), 0.0);
                continue;
            }
            assert_eq!(block.velocity.get(0), DVec3::ZERO);
            for direction in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z] {
                assert_eq!(now.velocity(point + 0.999 * clearance * direction), DVec3::ZERO, "{index}: {point}");
            }
            if clearance > approach {
                sleeping += 1;
                assert_eq!(later.velocity(point), DVec3::ZERO, "{index}: {point}");
            }
        }
        assert!(sleeping > 150, "{index}: {sleeping}");
    }
}

#[test]
fn a_point_does_not_depend_on_its_neighbors() {
    for strip in all_strips() {
        let field = strip.at(0.5);
        let points = near_points(LANES as u32);
        let mut block = FieldBlock::ZERO;
        field.evaluate_into(&PointBlock::gather(&points), &mut block);
        for (lane, &point) in points.iter().enumerate() {
            let mut alone = FieldBlock::ZERO;
            field.evaluate_into(&PointBlock::splat(point), &mut alone);
            assert_eq!(block.velocity.get(lane), alone.velocity.get(LANES - 1));
            assert_eq!(block.potential.get(lane), alone.potential.get(0));
            assert_eq!(block.clearance[lane], alone.clearance[0]);
        }
    }
}

#[test]
fn a_polygon_of_many_corners_is_a_round_strip() {
    let corners: Vec<DVec2> =
        (0..48).map(|i| libm::sincos(TAU * f64::from(i) / 48.0)).map(|(s, c)| 0.2 * DVec2::new(c, s)).collect();
    let spine = || StripSpine::through(&START).unwrap();
    let polygon = StripShape::polygon(&corners, None, 0.25, Profile::Quintic).unwrap();
    let round = StripShape::round(0.2, 0.25, Profile::Quintic).unwrap();
    for motion in [ALONG, ACROSS] {
        let [polygon, round] =
            [polygon.clone(), round.clone()].map(|shape| Strip::new(spine(), shape, motion).unwrap().at(0.0));
        for point in near_points(200) {
            let difference = polygon.velocity(point).distance(round.velocity(point));
            // A 48-gon is 0.2 · (π/48)²/2 = 4e-4 inside its circle, and the spline deviates by as
            // much; velocities change by up to 45 per unit. Across, the ends fade over one more
            // cell, 0.03 of 0.45, with a slope of 1.9.
            assert!(difference < if motion == ALONG { 0.05 } else { 0.13 }, "{point}: {difference}");
        }
    }
}

#[test]
fn a_section_does_not_rotate_about_the_spine() {
    let spine = SpineInstant::new(
        SpineCurve::Other(Arc::new(helix())),
        Some(StartFrame { reference: DVec3::NEG_X, tangent: helix().jet(0.0).tangent() }),
    );
    let jet = helix().jet(0.0);
    let end = helix().position(4.0 / helix_speed()) + 0.1 * DVec3::Z;
    for point in [helix().position(2.0 / helix_speed()) + 0.1 * DVec3::Z, end] {
        let station = spine.station(point);
        let normal = spine.normal(&station);
        // Relative to the Frenet frame, the rotation-minimizing frame rotates back by torsion times
        // length.
        let frenet = helix().jet(station.parameter).normal().unwrap();
        let angle = libm::atan2(normal.vector.cross(frenet).dot(station.tangent), normal.vector.dot(frenet));
        let length = station.parameter * helix_speed();
        // Double reflection over steps of 0.25: K h⁴/720 for a length of 4, with κ² τ³ = 0.02, plus
        // as much from the h⁴ of the spline.
        assert!((angle - jet.torsion() * length).abs() < 1e-4, "{angle}");
        // A rotation-minimizing frame does not rotate about the tangent. The derivative of the
        // interpolant is of third order in the steps of 0.25.
        let turn = normal.derivative.dot(station.tangent.cross(normal.vector));
        assert!(turn.abs() < 5e-3, "{turn}");
    }
}

#[test]
fn rejects_invalid_strips() {
    let spine = || StripSpine::through(&START).unwrap();
    let error = |spine: StripSpine, shape: StripShape, motion| Strip::new(spine, shape, motion).unwrap_err();
    let wide = StripShape::round(0.9, 0.5, Profile::Quintic).unwrap();
    let refused = error(StripSpine::along(Arc::new(helix())), wide, ALONG);
    assert!(
        matches!(refused, StripError::Reach { extent, curvature_radius, .. }
        if extent == 1.4 && (curvature_radius - 1.1225).abs() < 1e-9),
        "{refused}"
    );
    assert!(refused.to_string().contains("reaches 1.400000 from the spine"), "{refused}");
    let folded: Vec<DVec3> = START.iter().map(|point| DVec3::new(0.2 * point.x, point.x * point.x, 0.0)).collect();
    let refused = error(StripSpine::between(&START, &folded).unwrap(), round(), ALONG);
    assert!(matches!(refused, StripError::Reach { time, .. } if time > 0.0), "{refused}");
    assert!(refused.to_string().contains("% of the time"), "{refused}");
    let short = StripSpine::through(&[DVec3::ZERO, DVec3::X]).unwrap();
    let refused = error(short, round(), ACROSS);
    assert!(matches!(refused, StripError::TooShort { taper: 0.55, .. }), "{refused}");
    let far = StripMotion::Along { distance: f64::INFINITY };
    assert_eq!(error(spine(), round(), far), StripError::NotFinite("the distance"));
    assert_eq!(StripShape::round(0.2, 0.3, Profile::Thesis).unwrap_err(), StripError::Profile(Profile::Thesis));
    assert_eq!(StripShape::round(0.2, -0.3, Profile::Septic).unwrap_err(), StripError::Support(-0.3));
    assert_eq!(StripSpine::between(&START, &START[1..]).unwrap_err(), StripError::PointCounts { start: 5, end: 4 });
    assert!(matches!(StripSpine::through(&[DVec3::X, DVec3::X]).unwrap_err(), StripError::Spine { .. }));
    let circle = TrigonometricCurve::new(
        TrigonometricCurve::helix(1.0, 0.0, (0.0, TAU)).terms().to_vec(),
        DVec3::ZERO,
        (0.0, TAU),
        true,
    );
    let closed = StripSpine::along(Arc::new(circle));
    assert_eq!(error(closed.clone(), square(), ALONG), StripError::Closed);
    // A closed spine does not fade.
    let hoop = Strip::new(closed, round(), StripMotion::Across { travel: DVec3::Z }).unwrap().at(0.0);
    assert!(hoop.velocity(DVec3::X).distance(DVec3::Z) < 1e-14);
    let tangent =
        StripShape::polygon(&[DVec2::ZERO, DVec2::X, DVec2::Y], Some(DVec3::X), 0.1, Profile::Quintic).unwrap();
    let line = StripSpine::through(&[-DVec3::X, DVec3::X]).unwrap();
    assert_eq!(error(line, tangent, ALONG), StripError::Reference);
    let ball = Tool::new(Arc::new(Sphere::new(0.5).unwrap()), 0.7, Profile::Quintic).unwrap();
    let refused = error(StripSpine::along(Arc::new(helix())), StripShape::tool(Arc::new(ball)).unwrap(), ALONG);
    // The support of the sphere is about one unit from the helix, and part of it exceeds the reach.
    assert!(matches!(refused, StripError::Reach { extent, .. } if extent > 1.1), "{refused}");
}
