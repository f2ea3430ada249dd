//! Tests of [`ClosestPoint`]: comparison with samples, ends and seams.

use proptest::prelude::*;

use super::*;
use crate::{Bezier, CubicSpline, EndCondition, Parametrization, TrigonometricCurve};

/// Distance to the nearest of many samples: an upper bound, accurate up to the sampling error.
fn brute_force(curve: &impl Curve, query: DVec3, samples: usize) -> f64 {
    let (first, last) = curve.domain();
    (0..=samples)
        .map(|i| curve.position(first + (last - first) * i as f64 / samples as f64).distance(query))
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn points_beside_a_helix_have_one_branch_per_turn() {
    let helix = TrigonometricCurve::helix(1.0, 0.05, (0.0, 4.0 * std::f64::consts::TAU));
    let search = ClosestPoint::new(&helix);
    // A point outside the helix, beside its second turn.
    let query = helix.position(2.0 * std::f64::consts::TAU) * DVec3::new(1.5, 1.0, 1.0);
    let branches = search.branches(query, 10.0);
    assert_eq!(branches.len(), 5, "one minimum on each of the turns 0 to 4: {branches:?}");
    assert!((branches[0].distance - 0.5).abs() < 1e-14);
    for pair in branches.windows(2) {
        assert!(pair[0].distance <= pair[1].distance);
    }
}

#[test]
fn bounds_contain_the_curve_tightly() {
    let knot = TrigonometricCurve::torus_knot();
    let (low, high) = ClosestPoint::new(&knot).bounds();
    let samples = (0..1000).map(|i| knot.position(f64::from(i) * 0.001 * std::f64::consts::TAU));
    let (min, max) = samples.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    assert!(low.cmple(min).all() && high.cmpge(max).all());
    // Pieces are shorter than 0.15 and turn by at most 0.3: a quarter of the product is 0.011.
    assert!((min - low).max_element() < 0.012 && (high - max).max_element() < 0.012);
}

#[test]
fn ends_of_open_curves_are_branches() {
    let line = Bezier::new(vec![DVec3::ZERO, DVec3::X]);
    let search = ClosestPoint::new(&line);
    let before = search.closest(DVec3::new(-2.0, 1.0, 0.0));
    assert_eq!((before.parameter, before.position), (0.0, DVec3::ZERO));
    let after = search.closest(DVec3::new(2.0, 1.0, 0.0));
    assert_eq!((after.parameter, after.position), (1.0, DVec3::X));
    assert!((search.closest(DVec3::new(0.25, 3.0, 0.0)).parameter - 0.25).abs() < 1e-15);
}

#[test]
fn points_at_the_seam_of_a_closed_curve_are_found() {
    let knot = TrigonometricCurve::torus_knot();
    let search = ClosestPoint::new(&knot);
    for shift in [-1e-15, 0.0, 1e-15] {
        let query = knot.position(shift) + knot.jet(shift).normal().unwrap() * 0.05;
        // The query is 0.05 from the seam, within the radius of curvature.
        assert!((search.closest(query).distance - 0.05).abs() < 1e-14);
    }
}

#[test]
fn the_center_of_a_circle_has_a_closest_point() {
    let circle = TrigonometricCurve::helix(2.0, 0.0, (0.0, std::f64::consts::TAU));
    let found = ClosestPoint::new(&circle).closest(DVec3::ZERO);
    assert!((found.distance - 2.0).abs() < 1e-15);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_sample_is_nearer_than_the_closest_point(
        coordinates in prop::collection::vec(-1.0..1.0f64, 18),
        query in prop::array::uniform3(-1.5..1.5f64),
        closed: bool,
    ) {
        let points: Vec<DVec3> = coordinates.chunks(3).map(DVec3::from_slice).collect();
        let spline = if closed {
            CubicSpline::closed(&points, Parametrization::Centripetal)
        } else {
            CubicSpline::open(&points, Parametrization::Centripetal, EndCondition::Natural)
        }.unwrap();
        let query = DVec3::from_array(query);
        let search = ClosestPoint::new(&spline);
        let found = search.closest(query);
        let sampled = brute_force(&spline, query, 20_000);
        prop_assert!(found.distance <= sampled + 1e-15, "{}, sampled {sampled}", found.distance);
        // Samples are at most 1e-3 apart, and the distance has slope one.
        prop_assert!(found.distance >= sampled - 1e-3);
        prop_assert!((spline.position(found.parameter) - found.position).length() == 0.0);
        // The closest point is the first of the branches.
        let branches = search.branches(query, f64::INFINITY);
        prop_assert!((branches[0].distance - found.distance).abs() < 1e-14);
    }
}

#[test]
fn all_branches_are_found() {
    // The sign changes of the sampled slope are the minima. No two minima of these queries
    // merge.
    let knot = TrigonometricCurve::torus_knot();
    let search = ClosestPoint::new(&knot);
    for query in [DVec3::new(0.1, 0.2, 0.05), DVec3::new(0.6, 0.1, 0.0), DVec3::new(1.4, 0.3, -0.2)] {
        let samples = 100_000;
        let slope = |i: usize| {
            let jet = knot.jet(std::f64::consts::TAU * i as f64 / samples as f64);
            (jet.position - query).dot(jet.first)
        };
        let expected = (0..samples).filter(|&i| slope(i) < 0.0 && slope(i + 1) >= 0.0).count();
        let found = search.branches(query, f64::INFINITY);
        assert_eq!(found.len(), expected, "query {query}");
    }
}
