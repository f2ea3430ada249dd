//! Vector identities used by the fields, checked by central differences at scattered points.

use glam::DVec3;

use crate::fields::{
    Profile,
    field::{curl_of_product, finite_differences::scattered_points},
    rigid_motion::RigidMotion,
};

/// Step of the central differences. The truncation error is its square times third derivatives of
/// about a thousand (those of the profile over a support of 0.6); the rounding error is 1e-16 over
/// the step.
const STEP: f64 = 1e-4;
const TOLERANCE: f64 = 2e-5;

const V: DVec3 = DVec3::new(0.3, -0.2, 1.0);
const OMEGA: DVec3 = DVec3::new(0.4, 0.7, -0.3);
/// A unit vector.
const AXIS: DVec3 = DVec3::new(1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0);

fn derivatives(field: &dyn Fn(DVec3) -> DVec3, point: DVec3) -> [DVec3; 3] {
    DVec3::AXES.map(|axis| (field(point + STEP * axis) - field(point - STEP * axis)) / (2.0 * STEP))
}

fn curl(field: &dyn Fn(DVec3) -> DVec3, point: DVec3) -> DVec3 {
    let [dx, dy, dz] = derivatives(field, point);
    DVec3::new(dy.z - dz.y, dz.x - dx.z, dx.y - dy.x)
}

fn divergence(field: &dyn Fn(DVec3) -> DVec3, point: DVec3) -> f64 {
    let [dx, dy, dz] = derivatives(field, point);
    dx.x + dy.y + dz.z
}

fn gradient(scalar: &dyn Fn(DVec3) -> f64, point: DVec3) -> DVec3 {
    DVec3::from_array(derivatives(&|point| DVec3::splat(scalar(point)), point).map(|slope| slope.x))
}

#[track_caller]
fn assert_everywhere(left: impl Fn(DVec3) -> DVec3, right: impl Fn(DVec3) -> DVec3) {
    for point in scattered_points(100, 1.0) {
        let (left, right) = (left(point), right(point));
        assert!(left.distance(right) < TOLERANCE, "at {point}: {left} against {right}");
    }
}

/// Weight g(d/R) and its gradient for a sphere of radius 0.4.
fn weight(point: DVec3) -> (f64, DVec3) {
    let (value, slope) = Profile::Quintic.evaluate((point.length() - 0.4) / 0.6);
    (value, slope / 0.6 * point.normalize_or_zero())
}

#[test]
fn potentials_of_rigid_motions() {
    let flat = |x: DVec3| DVec3::new(0.0, x.y, x.z).cross(DVec3::X);
    assert_everywhere(|x| curl(&flat, x), |_| -2.0 * DVec3::X);
    assert_everywhere(flat, |x| x.cross(DVec3::X));
    assert_everywhere(|x| curl(&|r| 0.5 * V.cross(r), x), |_| V);
    let turn = |r: DVec3| OMEGA.cross(r);
    assert_everywhere(|x| curl(&|r| OMEGA.cross(r).cross(r) / 3.0, x), turn);
    assert_everywhere(|x| curl(&|r| -0.5 * r.length_squared() * OMEGA, x), turn);
    let axis = OMEGA.normalize();
    assert_everywhere(|x| curl(&|r| -0.5 * axis.cross(r).length_squared() * OMEGA, x), turn);
}

#[test]
fn equations_12_4_to_12_6_rotate_about_the_axis() {
    let double = |x: DVec3| x.cross(OMEGA.cross(x));
    assert_everywhere(|x| x.cross(OMEGA).cross(x), double);
    assert_everywhere(|x| curl(&double, x), |x| -3.0 * OMEGA.cross(x));
    let height = |x: DVec3| OMEGA.dot(x);
    assert_everywhere(|x| curl(&|x| height(x) * double(x), x), |x| -4.0 * height(x) * OMEGA.cross(x));
    assert_everywhere(
        |x| curl(&|x| libm::sin(height(x)) * double(x), x),
        |x| -(3.0 * libm::sin(height(x)) + height(x) * libm::cos(height(x))) * OMEGA.cross(x),
    );
    assert_everywhere(|x| curl(&|x| x.length_squared() * double(x), x), |x| -5.0 * x.length_squared() * OMEGA.cross(x));
}

#[test]
fn twists_and_swirls_of_varying_rate() {
    let rate = |height: f64| libm::sin(2.0 * height);
    let distance = |x: DVec3| AXIS.cross(x).length_squared();
    assert_everywhere(
        |x| curl(&|x| -0.5 * rate(AXIS.dot(x)) * distance(x) * AXIS, x),
        |x| rate(AXIS.dot(x)) * AXIS.cross(x),
    );
    assert_everywhere(
        |x| curl(&|x| -libm::sin(x.length_squared()) * AXIS, x),
        |x| 2.0 * libm::cos(x.length_squared()) * AXIS.cross(x),
    );
}

#[test]
fn products_of_gradients() {
    let (u, w) = (V, OMEGA);
    assert_everywhere(|x| gradient(&|r| u.dot(r), x).cross(gradient(&|r| w.dot(r), x)), |_| u.cross(w));
    assert_everywhere(
        |x| gradient(&|r| w.dot(r), x).cross(gradient(&|r| w.cross(r).length_squared(), x)),
        |x| 2.0 * w.length_squared() * w.cross(x),
    );
    // For constant N, B and T = N×B, the product form with g equals the curl form with g².
    let n = AXIS.any_orthonormal_vector();
    let b = AXIS.cross(n);
    let product = |x: DVec3| {
        let [alpha, beta] = [n, b].map(|side| gradient(&|r| weight(r).0 * side.dot(r), x));
        alpha.cross(beta)
    };
    let squared = |r: DVec3| weight(r).0 * weight(r).0;
    assert_everywhere(product, |x| curl(&|r| 0.5 * squared(r) * (n.dot(r) * b - b.dot(r) * n), x));
    assert_everywhere(product, |x| curl(&|r| 0.5 * squared(r) * AXIS.cross(r), x));
}

#[test]
fn the_product_rule_gives_the_curl_and_preserves_the_normal_speed() {
    let motion = RigidMotion { center: DVec3::new(0.1, 0.0, -0.2), linear: V, angular: OMEGA };
    let potential = |x: DVec3| weight(x).0 * motion.potential(x).0;
    let velocity = |x: DVec3| {
        let ((value, gradient), (potential, curl)) = (weight(x), motion.potential(x));
        curl_of_product(value, gradient, potential, curl)
    };
    assert_everywhere(|x| curl(&potential, x), velocity);
    for point in scattered_points(100, 1.0) {
        assert!(divergence(&velocity, point).abs() < 2.0 * TOLERANCE, "{point}");
        let normal = point.normalize();
        let expected = weight(point).0 * normal.dot(motion.velocity(point));
        // Within a few roundings: the second term is orthogonal to the normal.
        assert!((normal.dot(velocity(point)) - expected).abs() < 1e-13, "{point}");
    }
}

#[test]
fn a_different_gauge_origin_adds_a_gradient() {
    let a = DVec3::new(0.3, -0.4, 0.5);
    let motion = RigidMotion { center: DVec3::ZERO, linear: V, angular: OMEGA };
    let k = -0.5 * V.cross(a) - OMEGA.cross(a).cross(a) / 6.0;
    // −⅓ (ω×a)×r + ½ (ω×a)×r − ⅓ (ω×r)×a
    let m = |r: DVec3| OMEGA.cross(a).cross(r) / 6.0 - OMEGA.cross(r).cross(a) / 3.0;
    let chi = |r: DVec3| k.dot(r) + 0.5 * r.dot(m(r));
    assert_everywhere(|x| motion.about(a).potential(x).0 - motion.potential(x).0, |x| gradient(&chi, x));
}
