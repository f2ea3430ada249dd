use std::sync::Arc;

use isochore_mesh::{
    Distance, DistanceField, DistanceFieldOptions, Ellipsoid, NoProgress, Padding, Sphere, primitives,
};

use super::*;
use crate::fields::{
    BodyTwist, MovingField, MovingTool, Pose, Profile, RigidField, Tool, ToolError,
    field::{
        finite_differences::{deviation, scattered_points},
        flux::{QUADRATURE_NOISE, worst_field_flux},
    },
};

/// Root mean square and maximum of the tangential potential on the surface of an ellipsoid, for a
/// motion of its center.
fn along_surface(radii: DVec3, gauge: Option<&Gauge>, linear: DVec3, angular: DVec3) -> [f64; 2] {
    let motion = RigidMotion { center: DVec3::ZERO, linear, angular };
    let cubic = gauge.map_or(Cubic::ZERO, |gauge| gauge.of(&motion));
    let (mut sum, mut area, mut largest) = (0.0, 0.0, 0.0_f64);
    let (rows, columns) = (400, 200);
    for row in 0..rows {
        for column in 0..columns {
            let theta = std::f64::consts::PI * (row as f64 + 0.5) / rows as f64;
            let phi = std::f64::consts::TAU * column as f64 / columns as f64;
            let unit =
                DVec3::new(libm::sin(theta) * libm::cos(phi), libm::sin(theta) * libm::sin(phi), libm::cos(theta));
            let point = radii * unit;
            let normal = unit / radii;
            let weight = libm::sin(theta) * normal.length() * radii.element_product();
            let potential = motion.potential(point).0 + cubic.gradient(point);
            let tangential = potential.reject_from(normal).length();
            sum += weight * tangential * tangential;
            area += weight;
            largest = largest.max(tangential);
        }
    }
    [(sum / area).sqrt(), largest]
}

fn fitted(shape: &dyn Distance) -> Gauge {
    Gauge::fitted(shape, shape.centroid(), 1.0)
}

/// Compares with the table of the prototype, whose values have three digits.
#[track_caller]
fn check(found: [f64; 2], expected: [f64; 2]) {
    for (found, expected) in found.into_iter().zip(expected) {
        // Half a unit of the last digit, plus the error of a maximum over the triangle centers of
        // the prototype.
        assert!((found - expected).abs() < 2.5e-3, "{found} against {expected}");
    }
}

#[test]
fn on_a_sphere_the_fit_keeps_translation_and_removes_the_flow_of_rotation() {
    let radii = DVec3::splat(0.4);
    let gauge = fitted(&Sphere::new(0.4).unwrap());
    check(along_surface(radii, None, DVec3::X, DVec3::ZERO), [0.163, 0.200]);
    check(along_surface(radii, Some(&gauge), DVec3::X, DVec3::ZERO), [0.163, 0.200]);
    check(along_surface(radii, None, DVec3::ZERO, DVec3::Y), [0.043, 0.053]);
    // The remainder is due to the ridge of the fit.
    assert!(along_surface(radii, Some(&gauge), DVec3::ZERO, DVec3::Y)[1] < 1e-6);
}

#[test]
fn the_fit_halves_the_flow_around_a_sideways_ellipsoid() {
    let radii = DVec3::new(0.8, 0.2, 0.2);
    let gauge = fitted(&Ellipsoid::new(radii).unwrap());
    check(along_surface(radii, None, DVec3::Y, DVec3::ZERO), [0.171, 0.398]);
    check(along_surface(radii, Some(&gauge), DVec3::Y, DVec3::ZERO), [0.116, 0.180]);
    // A rotation about the tip: a rotation about the center plus the velocity it gives the center.
    check(along_surface(radii, Some(&gauge), -0.8 * DVec3::Y, DVec3::Z), [0.098, 0.175]);
}

#[test]
fn the_fit_never_speeds_up_the_flow() {
    let radii = DVec3::new(0.5, 0.3, 0.2);
    let gauge = fitted(&Ellipsoid::new(radii).unwrap());
    for axis in DVec3::AXES {
        for (linear, angular) in [(axis, DVec3::ZERO), (DVec3::ZERO, axis)] {
            let [before, after] = [None, Some(&gauge)].map(|gauge| along_surface(radii, gauge, linear, angular));
            // The fit and this check sample different points of the surface.
            assert!(after[0] <= before[0] + 1e-6 && after[1] <= before[1] * 1.001, "{before:?} {after:?}");
        }
    }
}

#[test]
fn a_sampled_mesh_has_nearly_the_gauge_of_its_shape() {
    let mesh = primitives::icosphere(0.4, 4);
    let options = DistanceFieldOptions { resolution: 32, padding: Padding::Reach(0.3), ..Default::default() };
    let sampled = DistanceField::new(&mesh, &options, &NoProgress).unwrap();
    let gauge = fitted(&sampled);
    // The mesh of 5120 triangles deviates from the sphere by 1e-3 of the radius; its normals
    // deviate by that much over a few cells.
    assert!(along_surface(DVec3::splat(0.4), Some(&gauge), DVec3::ZERO, DVec3::Y)[1] < 2e-3);
}

fn tool(fraction: f64) -> Arc<Tool> {
    let shape = Ellipsoid::new(DVec3::new(0.5, 0.2, 0.2)).unwrap();
    Arc::new(Tool::new(Arc::new(shape), 0.3, Profile::Quintic).unwrap().with_free_form(fraction).unwrap())
}

const TWIST: BodyTwist = BodyTwist { linear: DVec3::new(0.3, -0.2, 1.0), angular: DVec3::new(0.4, 0.7, -0.3) };

#[test]
fn only_the_tangential_flow_changes() {
    let (plain, free) = (tool(0.0), tool(1.0));
    assert!(plain.gauge().is_none());
    let [plain_field, free_field] = [&plain, &free].map(|tool| RigidField::new(tool, TWIST));
    let mut changed = 0;
    for point in scattered_points(500, 0.8) {
        let (distance, normal) = plain.distance().sample(point);
        let [before, after] = [plain_field.velocity(point), free_field.velocity(point)];
        // On a level set of the distance, only the tangential part of the potential is free.
        assert!((after - before).dot(normal).abs() < 1e-14, "{point}");
        if distance <= 0.0 || distance >= 0.3 {
            assert_eq!(before, after);
        } else {
            changed += usize::from(before.distance(after) > 0.05);
        }
    }
    assert!(changed > 50, "{changed}");
}

#[test]
fn the_field_is_the_curl_of_its_potential_and_has_no_net_flux() {
    for fraction in [0.5, 1.0] {
        let tool = tool(fraction);
        let field = MovingTool::new(Arc::clone(&tool), Pose::IDENTITY, TWIST).at(0.0);
        let seen = deviation(&*field, &scattered_points(200, 0.8), 1e-4);
        // Truncation: h²/6 of derivatives of the quintic over a support of 0.3, of the order of
        // 60/R³ and 360/R⁴.
        assert!(seen.curl < 1e-4 && seen.divergence < 1e-3 && seen.gradient < 1e-4, "{seen:?}");
        assert!(worst_field_flux(&*field, |_| f64::INFINITY, 0.5) < QUADRATURE_NOISE);
        for point in scattered_points(100, 0.8) {
            // World and tool coordinates are equal in this test.
            let velocity = RigidField::new(&tool, TWIST).velocity(point);
            assert!(field.velocity(point).distance(velocity) < 1e-14, "{point}");
        }
    }
}

#[test]
fn rejects_fractions_out_of_range() {
    for fraction in [-0.1, 1.1, f64::NAN] {
        let tool = Tool::new(Arc::new(Sphere::new(0.4).unwrap()), 0.3, Profile::Quintic).unwrap();
        assert!(matches!(tool.with_free_form(fraction), Err(ToolError::FreeForm(_))));
    }
}

#[test]
fn the_gradient_is_the_derivative() {
    let cubic = Cubic(std::array::from_fn(|term| 0.3 + 0.1 * term as f64));
    let value = |r: DVec3| -> f64 {
        let term = |(powers, c): (&[i32; 3], &f64)| {
            c * (0..3).map(|axis| (0..powers[axis]).map(|_| r[axis]).product::<f64>()).product::<f64>()
        };
        polynomial::POWERS.iter().zip(&cubic.0).map(term).sum()
    };
    let (r, h) = (DVec3::new(0.3, -0.7, 0.5), 1e-5);
    let slope = DVec3::AXES.map(|axis| (value(r + h * axis) - value(r - h * axis)) / (2.0 * h));
    // Truncation: h²/6 of third derivatives near 10; rounding: 1e-16/h.
    assert!(cubic.gradient(r).distance(DVec3::from_array(slope)) < 1e-9);
}
