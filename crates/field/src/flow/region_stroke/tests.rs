use isochore_mesh::{Capsule, Distance, HalfSpace, Sphere};

use super::*;
use crate::{
    fields::{
        Profile, Tool, ToolError,
        field::{
            finite_differences::{deviation, scattered_points},
            flux::{QUADRATURE_NOISE, worst_field_flux},
        },
    },
    flow::Stroke,
};

const WORLD: Aabb = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };

fn pose() -> Pose {
    Pose { rotation: rotation_from_vector(DVec3::new(0.3, -0.5, 0.2)), translation: DVec3::new(0.1, -0.1, 0.2) }
}

fn half_space() -> HalfSpace {
    HalfSpace::new(DVec3::new(0.1, 0.0, -0.1), DVec3::new(0.2, 0.1, 1.0)).unwrap()
}

fn inner() -> Vec<(&'static str, Arc<dyn Distance>, Pose)> {
    vec![
        ("sphere", Arc::new(Sphere::new(0.3).unwrap()), pose()),
        ("capsule", Arc::new(Capsule::new(0.2, 0.3).unwrap()), pose()),
        ("half-space", Arc::new(half_space()), Pose::IDENTITY),
    ]
}

fn motions() -> [RegionMotion; 2] {
    let (origin, axis) = (DVec3::new(-0.2, 0.1, 0.3), DVec3::new(1.0, 2.0, -0.5));
    [RegionMotion::Translation(DVec3::new(0.3, -0.2, 0.5)), RegionMotion::Rotation { origin, axis, angle: 1.1 }]
}

fn region(inner: &Arc<dyn Distance>, placement: Pose) -> Region {
    Region::new(Arc::clone(inner), placement, 0.4, Profile::Quartic).unwrap()
}

/// ∇(g α) × ∇(g β), by the product rule, with the region at rest.
fn product_form(inner: &dyn Distance, placement: Pose, motion: RegionMotion, point: DVec3) -> DVec3 {
    let (distance, gradient) = inner.sample(placement.rotation.conjugate() * (point - placement.translation));
    let (value, slope) = Profile::Quartic.evaluate(distance / 0.4);
    let blend = slope / 0.4 * (placement.rotation * gradient);
    let [(alpha, alpha_slope), (beta, beta_slope)] = match motion {
        RegionMotion::Translation(shift) => {
            // Two orthonormal vectors across the shift, whose cross product is its direction. The origin is
            // the center of the gauge.
            let (u, w) = shift.normalize().any_orthonormal_pair();
            let sign = u.cross(w).dot(shift).signum();
            let r = point - placement.transform(inner.centroid());
            let factor = sign * shift.length();
            [(factor * u.dot(r), factor * u), (w.dot(r), w)]
        }
        RegionMotion::Rotation { origin, axis, angle } => {
            let (r, a) = (point - origin, axis.normalize());
            let beta = (0.5 * a.cross(r).length_squared(), r - a * a.dot(r));
            [(angle * a.dot(r), angle * a), beta]
        }
    };
    (value * alpha_slope + alpha * blend).cross(value * beta_slope + beta * blend)
}

#[test]
fn the_curl_of_the_squared_profile_is_the_product_form() {
    for (name, inner, placement) in inner() {
        for motion in motions() {
            let stroke = region(&inner, placement).stroke(motion, 0.1, WORLD).unwrap();
            let field = stroke.fields()[0].at(0.0);
            let mut moving = 0;
            for point in scattered_points(300, 1.0) {
                let velocity = field.velocity(point);
                let expected = product_form(&*inner, placement, motion, point);
                // Rounding of numbers near one, in world and in tool coordinates, over a support of 0.4.
                assert!(velocity.distance(expected) < 1e-13, "{name} {motion:?} at {point}: {velocity} {expected}");
                moving += usize::from(velocity != DVec3::ZERO);
            }
            assert!(moving > 50, "{name}: {moving}");
        }
    }
}

/// Section 11.2.1 of the thesis: the product form with the linear profile 1 − d/R is equation 12.2 with its square.
#[test]
fn the_extended_spherical_field_is_equation_12_2() {
    use isochore_mesh::RoundedBox;
    let shape = RoundedBox::new(DVec3::new(0.3, 0.2, 0.4), 0.05).unwrap();
    let tool = Tool::new(Arc::new(shape), 0.35, Profile::Quad).unwrap();
    let shift = DVec3::new(0.0, 0.0, 0.8);
    let motion = Move::new(Arc::new(tool), vec![Pose::IDENTITY, Pose::at(shift)], 0.1).unwrap();
    let field = motion.fields()[0].at(0.0);
    for point in scattered_points(300, 0.8) {
        let (distance, gradient) = shape.sample(point);
        let u = (distance / 0.35).clamp(0.0, 1.0);
        let blend = if u > 0.0 && u < 1.0 { -gradient / 0.35 } else { DVec3::ZERO };
        let p = (1.0 - u) * DVec3::X + point.x * blend;
        let q = (1.0 - u) * DVec3::Y + point.y * blend;
        // Rounding of numbers near one.
        assert!(field.velocity(point).distance(0.8 * p.cross(q)) < 1e-14, "{point}");
    }
}

#[test]
fn every_region_is_a_divergence_free_field() {
    for (name, inner, placement) in inner() {
        for motion in motions() {
            let stroke = region(&inner, placement).stroke(motion, 0.1, WORLD).unwrap();
            let field = stroke.fields()[0].at(0.4);
            let seen = deviation(&*field, &scattered_points(200, 0.9), 1e-4);
            // h²/6 of third derivatives of the order of 100/R³ = 2e3; second derivatives jump at the end of
            // the layer.
            assert!(seen.curl < 1e-4 && seen.divergence < 1e-3 && seen.gradient < 1e-4, "{name} {seen:?}");
            // A fourth power at the end of the layer has no noticeable kink.
            let flux = worst_field_flux(&*field, |_| f64::INFINITY, 0.5);
            assert!(flux < QUADRATURE_NOISE, "{name}: {flux:e}");
        }
    }
}

#[test]
fn the_inside_moves_rigidly_and_the_outside_rests() {
    for (name, inner, placement) in inner() {
        let (origin, axis) = (DVec3::new(0.1, 0.0, -0.1), DVec3::new(1.0, 0.2, 0.0));
        // More than half a turn, in three parts.
        for angle in [0.7, -4.0] {
            let stroke = region(&inner, placement).stroke(RegionMotion::Rotation { origin, axis, angle }, 0.1, WORLD);
            let stroke = Stroke::Move(stroke.unwrap());
            let turn = rotation_from_vector(axis.normalize() * angle);
            for point in scattered_points(100, 1.0) {
                let distance = inner.sample(placement.rotation.conjugate() * (point - placement.translation)).0;
                let mut moved = [point];
                stroke.advect_chunk(&mut moved);
                if distance < -1e-9 {
                    // Rounding of some dozens of steps in closed form.
                    assert!(moved[0].distance(origin + turn * (point - origin)) < 1e-13, "{name} {point}");
                }
                if !stroke.may_touch(point, 0.0) {
                    assert_eq!(moved[0], point, "{name}");
                }
            }
        }
    }
}

#[test]
fn a_rotating_half_space_touches_only_the_balls_that_it_reaches() {
    let inner: Arc<dyn Distance> = Arc::new(HalfSpace::new(DVec3::ZERO, DVec3::Z).unwrap());
    let motion = RegionMotion::Rotation { origin: DVec3::ZERO, axis: DVec3::X, angle: 0.5 };
    let stroke = Stroke::Move(region(&inner, Pose::IDENTITY).stroke(motion, 0.1, WORLD).unwrap());
    // At the end the plane is at height y tan(0.5), and the layer ends 0.4/cos(0.5) above it.
    let edge = |y: f64| y * libm::tan(0.5) + 0.4 / libm::cos(0.5);
    for y in [0.5, 1.0, 3.0] {
        assert!(stroke.may_touch(DVec3::new(0.0, y, edge(y) - 0.01), 0.0), "{y}");
        assert!(!stroke.may_touch(DVec3::new(0.0, y, edge(y) + 0.1 * (1.0 + y)), 0.0), "{y}");
        assert!(stroke.may_touch(DVec3::new(0.0, y, edge(y) + 0.3), 0.5), "{y}");
    }
}

#[test]
fn rejects_invalid_motions() {
    let inner: Arc<dyn Distance> = Arc::new(Sphere::new(0.3).unwrap());
    let kinked = Region::new(Arc::clone(&inner), Pose::IDENTITY, 0.4, Profile::Thesis);
    assert_eq!(kinked.unwrap_err(), ToolError::NoSquare(Profile::Thesis));
    let rotation = |axis, angle| RegionMotion::Rotation { origin: DVec3::ZERO, axis, angle };
    let error = |motion| region(&inner, Pose::IDENTITY).stroke(motion, 0.1, WORLD).unwrap_err();
    assert_eq!(error(rotation(DVec3::ZERO, 1.0)), AxisError::Zero.into());
    assert_eq!(error(rotation(DVec3::X, f64::NAN)), AxisError::NotFinite("the rotation").into());
}
