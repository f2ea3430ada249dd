use isochore_curve::{ClosestPoint, Curve};

use super::*;
use crate::fields::{
    Ring, Strip, StripMotion, StripShape, StripSpine,
    field::finite_differences::scattered_points,
    ring::tests::TILTED,
    strip::tests::{ACROSS, START, TRAVEL, all_strips, end, round},
};

#[test]
fn the_core_of_a_ring_moves_exactly() {
    let ring = Ring::new(TILTED, 0.7).unwrap();
    let around = ring.shape().axis.any_orthonormal_vector();
    let start = TILTED.center + around * 1.1;
    let mut points = [start, TILTED.center + around * 3.0];
    let stroke = FieldStroke::new(vec![Arc::new(ring)], 0.125).unwrap();
    let steps = stroke.steps();
    Stroke::Field(stroke).advect_chunk(&mut points);
    // 0.7 in steps of an eighth of the tube's radius: 22.4.
    assert_eq!(steps, 23);
    // One rounding per step, of coordinates below two.
    assert!(points[0].distance(start + 0.7 * ring.shape().axis) < 23.0 * 4.5e-16);
    assert_eq!(points[1], TILTED.center + around * 3.0);
}

#[test]
fn a_straight_core_follows_its_motion() {
    let line = [DVec3::new(-2.0, 0.0, 0.0), DVec3::new(2.0, 0.0, 0.0)];
    let flow = |motion| {
        let strip = Strip::new(StripSpine::through(&line).unwrap(), round(), motion).unwrap();
        let mut points = [DVec3::new(-0.2, 0.1, 0.15), DVec3::new(0.0, 0.0, 0.6)];
        Stroke::Field(FieldStroke::new(vec![Arc::new(strip)], 0.125).unwrap()).advect_chunk(&mut points);
        points
    };
    let [along, outside] = flow(StripMotion::Along { distance: 0.5 });
    // The field is constant in a straight core, so Runge-Kutta steps are exact up to rounding.
    assert!(along.distance(DVec3::new(0.3, 0.1, 0.15)) < 1e-14);
    assert_eq!(outside, DVec3::new(0.0, 0.0, 0.6));
    let [across, _] = flow(StripMotion::Across { travel: DVec3::new(0.3, 0.2, 0.4) });
    assert!(across.distance(DVec3::new(-0.2, 0.3, 0.55)) < 1e-14, "{across}");
}

#[test]
fn points_on_the_spine_stay_on_it() {
    let spine = StripSpine::between(&START, &end()).unwrap();
    let start = spine.at(0.0);
    let shifted: Vec<DVec3> = end().iter().map(|point| *point + TRAVEL).collect();
    let finish = StripSpine::between(&START, &shifted).unwrap().at(1.0);
    let off = |step: f64| {
        let shape = StripShape::round(0.2, 0.25, Profile::Quintic).unwrap();
        let strip = Strip::new(spine.clone(), shape, ACROSS).unwrap();
        let stroke = Stroke::Field(FieldStroke::new(vec![Arc::new(strip)], step).unwrap());
        // Away from the ends, where the field fades.
        let mut points: Vec<DVec3> = (8..=13).map(|i| start.position(start.domain().1 * f64::from(i) / 20.0)).collect();
        stroke.advect_chunk(&mut points);
        points.iter().map(|point| ClosestPoint::new(&finish).closest(*point).distance).fold(0.0, f64::max)
    };
    let [coarse, fine] = [0.5, 0.25].map(off);
    // The velocity on the spine is smooth except for jumps of its third derivative at the knots, so the
    // order is between 2 and 4.
    assert!(fine < 1e-4 && fine < coarse / 3.5, "{coarse:e} {fine:e}");
}

#[test]
fn untouchable_points_do_not_move() {
    for strip in all_strips().into_iter().skip(5).step_by(3) {
        let stroke = Stroke::Field(FieldStroke::new(vec![Arc::new(strip)], 0.2).unwrap());
        let points = scattered_points(900, 1.8);
        let mut moved = points.clone();
        stroke.advect_chunk(&mut moved);
        let untouchable = points.iter().zip(&moved).filter(|(point, moved)| {
            let is_untouchable = !stroke.may_touch(**point, 0.0);
            assert!(!is_untouchable || point == moved);
            is_untouchable
        });
        assert!(untouchable.count() > 100);
        assert!(points.iter().zip(&moved).any(|(point, moved)| point != moved));
    }
}
