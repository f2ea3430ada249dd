//! Tests of all shapes: distances against brute force, gradients against finite differences, blocks
//! against single points.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, dvec3};
use proptest::prelude::*;

use super::*;
use crate::{Distance, DistanceBlock, LANES, PointBlock};

fn shapes() -> Vec<Box<dyn Distance>> {
    vec![
        Box::new(Sphere::new(0.4).unwrap()),
        Box::new(Capsule::new(0.15, 0.8).unwrap()),
        Box::new(RoundedBox::new(dvec3(0.5, 0.4, 0.3), 0.0).unwrap()),
        Box::new(RoundedBox::new(dvec3(0.5, 0.4, 0.3), 0.1).unwrap()),
        Box::new(RoundedBox::new(dvec3(0.5, 0.4, 0.3), 0.3).unwrap()),
        Box::new(Torus::new(0.5, 0.2).unwrap()),
        Box::new(Ellipsoid::new(dvec3(0.5, 0.3, 0.4)).unwrap()),
        Box::new(Ellipsoid::new(dvec3(0.3, 0.3, 0.9)).unwrap()),
        Box::new(Ellipsoid::new(DVec3::splat(0.35)).unwrap()),
    ]
}

fn point() -> impl Strategy<Value = DVec3> {
    (-1.2..1.2, -1.2..1.2, -1.2..1.2_f64).prop_map(|(x, y, z)| dvec3(x, y, z))
}

proptest! {
    #[test]
    fn gradient_is_the_difference_quotient(p in point()) {
        // Central differences. The truncation error is 1e-5² times a third derivative of at most
        // about 1/d² near medial surfaces; the rounding error is 1e-16/1e-5. If a step straddles a
        // medial surface, the one-sided quotients disagree. If the curvature jumps, as from a face
        // to a rounded edge, the error of the quotient is at most half of that disagreement.
        const STEP: f64 = 1e-5;
        for shape in shapes() {
            let (value, gradient) = shape.sample(p);
            prop_assert!((gradient.length() - 1.0).abs() < 1e-12, "{shape:?}: {gradient}");
            for axis in 0..3 {
                let step = DVec3::AXES[axis] * STEP;
                let (forward, backward) = (shape.sample(p + step).0 - value, value - shape.sample(p - step).0);
                let disagreement = (forward - backward).abs() / STEP;
                if disagreement < 1e-3 {
                    let (quotient, tolerance) = (0.5 * (forward + backward) / STEP, 1e-5 + 0.5 * disagreement);
                    prop_assert!(
                        (gradient[axis] - quotient).abs() < tolerance,
                        "{shape:?} axis {axis}: {gradient} {quotient}"
                    );
                }
            }
        }
    }

    #[test]
    fn descent_along_the_gradient_lands_on_the_surface(p in point()) {
        // For exact distances the nearest surface point is p − d ∇d, from either side. 1e-9 allows
        // for points next to a medial surface, for which the direction is ill-conditioned.
        for shape in shapes() {
            let (value, gradient) = shape.sample(p);
            let foot = p - value * gradient;
            prop_assert!(shape.sample(foot).0.abs() < 1e-9, "{shape:?} at {p}");
        }
    }

    #[test]
    fn lanes_are_independent(points in prop::collection::vec(point(), LANES)) {
        for shape in shapes() {
            let mut block = DistanceBlock::FAR;
            shape.sample_into(&PointBlock::gather(&points), &mut block);
            for (lane, &p) in points.iter().enumerate() {
                let (value, gradient) = shape.sample(p);
                prop_assert_eq!(value.to_bits(), block.value[lane].to_bits());
                prop_assert_eq!(gradient, block.gradient.get(lane));
            }
        }
    }

    #[test]
    fn ellipsoid_distance_is_minimal(p in point(), ratio in 1.0..50.0_f64) {
        // No point of a dense set on the surface is nearer than the distance, and one is almost as
        // near: with a spacing of s on the surface, it is at most s² (1/2d + curvature) farther
        // away.
        let radii = dvec3(0.5, 0.5 / ratio, 0.4);
        let shape = Ellipsoid::new(radii).unwrap();
        let distance = shape.sample(p).0.abs();
        let mut nearest = f64::INFINITY;
        for i in 0..200 {
            for j in 0..400 {
                let (polar, azimuth) = (f64::from(i) / 199.0 * PI, f64::from(j) / 400.0 * TAU);
                let unit = dvec3(libm::sin(polar) * libm::cos(azimuth), libm::sin(polar) * libm::sin(azimuth), libm::cos(polar));
                nearest = nearest.min((unit * radii - p).length());
            }
        }
        prop_assert!(nearest > distance - 1e-12);
        prop_assert!(nearest < distance + 0.02, "{nearest} {distance}");
    }
}

#[test]
fn values_at_known_points() {
    let close = |shape: &dyn Distance, p: DVec3, expected: f64| {
        let (value, _) = shape.sample(p);
        assert!((value - expected).abs() < 1e-15, "{shape:?} at {p}: {value}, not {expected}");
    };
    close(&Sphere::new(0.4).unwrap(), dvec3(0.0, 0.0, 1.0), 0.6);
    close(&Capsule::new(0.15, 0.8).unwrap(), dvec3(0.5, 0.0, 0.3), 0.35);
    close(&Capsule::new(0.15, 0.8).unwrap(), dvec3(0.3, 0.0, 1.2), 0.35);
    let rounded = RoundedBox::new(dvec3(0.5, 0.4, 0.3), 0.1).unwrap();
    close(&rounded, dvec3(0.5, 0.0, 0.0), 0.0);
    close(&rounded, DVec3::ZERO, -0.3);
    close(&rounded, dvec3(0.7, 0.7, 0.0), 0.4); // 3-4-5 triangle from the inner corner (0.4, 0.3)
    close(&Torus::new(0.5, 0.2).unwrap(), dvec3(0.8, 0.0, 0.4), 0.3);
    close(&Ellipsoid::new(dvec3(0.5, 0.3, 0.4)).unwrap(), dvec3(2.0, 0.0, 0.0), 1.5);
    close(&Ellipsoid::new(dvec3(0.5, 0.3, 0.4)).unwrap(), DVec3::ZERO, -0.3);
}

#[test]
fn gradient_is_zero_where_it_is_undefined() {
    let cases: Vec<(Box<dyn Distance>, Vec<DVec3>)> = vec![
        (Box::new(Sphere::new(0.4).unwrap()), vec![DVec3::ZERO]),
        (Box::new(Capsule::new(0.15, 0.8).unwrap()), vec![DVec3::ZERO, dvec3(0.0, 0.0, 0.5)]),
        (
            Box::new(RoundedBox::new(dvec3(0.5, 0.375, 0.25), 0.0).unwrap()),
            vec![DVec3::ZERO, dvec3(0.125, 0.125, 0.0), dvec3(0.375, 0.25, 0.0), dvec3(0.0, 0.25, 0.125)],
        ),
        (Box::new(RoundedBox::new(DVec3::splat(0.3), 0.3).unwrap()), vec![DVec3::ZERO]),
        (Box::new(Torus::new(0.5, 0.2).unwrap()), vec![DVec3::ZERO, DVec3::Z, DVec3::X * 0.5]),
        (Box::new(Ellipsoid::new(dvec3(0.5, 0.3, 0.4)).unwrap()), vec![DVec3::ZERO, dvec3(0.1, 0.0, 0.05)]),
        (Box::new(Ellipsoid::new(DVec3::splat(0.3)).unwrap()), vec![DVec3::ZERO]),
        (Box::new(Ellipsoid::new(dvec3(0.3, 0.3, 0.9)).unwrap()), vec![DVec3::ZERO, DVec3::Z * 0.5]),
    ];
    for (shape, points) in cases {
        for p in points {
            let (value, gradient) = shape.sample(p);
            assert!(value.is_finite());
            assert_eq!(gradient, DVec3::ZERO, "{shape:?} at {p}");
        }
    }
}

#[test]
fn ellipsoid_beyond_the_rim_of_its_medial_surface_has_a_gradient() {
    // In the plane y = 0 the medial surface is the ellipse with radii (a² − b²)/a and (c² − b²)/c.
    let shape = Ellipsoid::new(dvec3(0.5, 0.3, 0.4)).unwrap();
    let (value, gradient) = shape.sample(dvec3(0.321, 0.0, 0.0));
    assert!((value + 0.179).abs() < 1e-15);
    assert!((gradient.x - 1.0).abs() < 1e-15 && gradient.y == 0.0 && gradient.z == 0.0);
    assert_eq!(shape.sample(dvec3(0.319, 0.0, 0.0)).1, DVec3::ZERO);
}

#[test]
fn thin_ellipsoids_keep_their_precision() {
    let shape = Ellipsoid::new(dvec3(1.0, 1e-6, 1.0)).unwrap();
    // Above the center of a blade, the distance is the height minus the thickness. Measuring the
    // root from anywhere but the pole would lose far more than that.
    for height in [1e-9, 1e-6, 1e-3, 1.0] {
        let (value, gradient) = shape.sample(dvec3(0.0, height, 0.0));
        assert!((value - (height - 1e-6)).abs() < 1e-15 * height.max(1e-6), "{value}");
        assert_eq!(gradient, DVec3::Y);
    }
}

#[test]
fn extreme_points_have_finite_gradients() {
    for shape in shapes() {
        for scale in [1e-320, 1e-200, 1e-20, 1e20, 1e150, 1e300] {
            for p in [DVec3::ONE, DVec3::X, dvec3(0.0, -1.0, 1.0)] {
                let (value, gradient) = shape.sample(p * scale);
                assert!(!value.is_nan() && gradient.is_finite(), "{shape:?} at {}: {value} {gradient}", p * scale);
            }
        }
    }
}

#[test]
fn rejects_bad_lengths() {
    assert_eq!(Sphere::new(-1.0), Err(ShapeError::NotPositive { shape: "sphere", length: "radius", value: -1.0 }));
    assert!(matches!(Capsule::new(1.0, f64::NAN), Err(ShapeError::NotPositive { length: "half length", .. })));
    assert!(matches!(Torus::new(f64::INFINITY, 1.0), Err(ShapeError::NotPositive { length: "major radius", .. })));
    assert_eq!(Torus::new(1.0, 1.0), Err(ShapeError::TorusCrossesItself { major: 1.0, minor: 1.0 }));
    assert_eq!(RoundedBox::new(dvec3(1.0, 2.0, 3.0), 1.5), Err(ShapeError::Rounding { rounding: 1.5, limit: 1.0 }));
    assert!(matches!(RoundedBox::new(DVec3::ONE, f64::NAN), Err(ShapeError::Rounding { .. })));
    assert!(matches!(Ellipsoid::new(dvec3(1.0, 0.0, 1.0)), Err(ShapeError::NotPositive { length: "radii", .. })));
    assert!(matches!(Ellipsoid::new(dvec3(1.0, 1e-7, 1.0)), Err(ShapeError::TooAnisotropic { .. })));
}
