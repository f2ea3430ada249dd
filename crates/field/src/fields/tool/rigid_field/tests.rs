use std::sync::Arc;

use isochore_mesh::{
    Capsule, Distance, DistanceField, DistanceFieldOptions, Ellipsoid, NoProgress, Padding, RoundedBox, Sphere, Torus,
    primitives,
};

use rayon::prelude::*;

use super::*;
use crate::fields::{
    Profile,
    field::flux::{QUADRATURE_NOISE, worst_flux},
};

const TWIST: BodyTwist = BodyTwist { linear: DVec3::new(0.3, -0.2, 1.0), angular: DVec3::new(0.4, 0.7, -0.3) };

fn tool(distance: impl Distance + 'static, support: f64, profile: Profile) -> Tool {
    Tool::new(Arc::new(distance), support, profile).unwrap()
}

fn shapes() -> Vec<(&'static str, Arc<dyn Distance>)> {
    vec![
        ("sphere", Arc::new(Sphere::new(0.4).unwrap())),
        ("capsule", Arc::new(Capsule::new(0.15, 0.5).unwrap())),
        ("box", Arc::new(RoundedBox::new(DVec3::new(0.3, 0.2, 0.4), 0.0).unwrap())),
        ("torus", Arc::new(Torus::new(0.5, 0.12).unwrap())),
        ("ellipsoid", Arc::new(Ellipsoid::new(DVec3::new(0.5, 0.3, 0.2)).unwrap())),
    ]
}

/// Worst relative flux of a field. The second derivative of the profile may jump at the edge of the
/// support and its first derivative on the surface; elsewhere the quadrature adapts without a hint.
fn flux(field: &RigidField<'_>, size: f64) -> f64 {
    let (on_surface, at_edge) = match field.tool().profile() {
        Profile::Thesis | Profile::Quad => (true, true),
        Profile::Quartic => (false, true),
        _ => (false, false),
    };
    let kink = |point| {
        let to = |is_kink: bool, level: f64| {
            if is_kink { (field.tool().distance().sample(point).0 - level).abs() } else { f64::INFINITY }
        };
        to(on_surface, 0.0).min(to(at_edge, field.tool().support()))
    };
    let velocity = |points: &PointBlock| {
        let mut block = VelocityBlock::REST;
        field.evaluate_into(points, &mut block);
        let absolute = |lane: usize| block.relative.get(lane) + field.twist.velocity(points.get(lane));
        let is_outside = block.is_outside;
        PointBlock::gather(
            &(0..LANES).map(|lane| if is_outside[lane] { DVec3::ZERO } else { absolute(lane) }).collect::<Vec<_>>(),
        )
    };
    worst_flux(velocity, kink, size)
}

#[test]
fn golden_velocities() {
    let tool = tool(Sphere::new(0.4).unwrap(), 0.3, Profile::Quintic);
    let field = RigidField::new(&tool, TWIST);
    let golden = [
        ([0.5, 0.0, 0.1], [0.457640085936731, 0.160606895405157, -0.440876585800859]),
        ([0.2, 0.3, 0.4], [-0.067501303823566, 1.024766582035208, -0.163332230369085]),
        ([-0.3, 0.4, -0.2], [0.319837477829036, -0.721804359632260, -0.866104635653828]),
        ([0.1, 0.1, 0.1], [0.400000000000000, -0.270000000000000, 0.970000000000000]),
    ];
    for (point, velocity) in golden {
        // The golden digits end at 1e-15; the rest is a few roundings of numbers near one.
        assert!(field.velocity(point.into()).distance(velocity.into()) < 3e-15, "{point:?}");
    }
}

#[test]
fn every_tool_and_profile_has_zero_net_flux() {
    let profiles = || Profile::ALL.into_iter().chain([Profile::Quad, Profile::QuarticSquared]);
    let cases: Vec<_> =
        shapes().into_iter().flat_map(|shape| profiles().map(move |profile| (shape.clone(), profile))).collect();
    cases.into_par_iter().for_each(|((name, shape), profile)| {
        let tool = Tool::new(shape, 0.25, profile).unwrap();
        let flux = flux(&RigidField::new(&tool, TWIST), 0.5);
        assert!(flux < QUADRATURE_NOISE, "{name}, {profile}: {flux:.1e}");
    });
}

/// Mistake to detect: distance and gradient sampled on a grid and interpolated separately. The
/// gradient is then not that of any function.
#[derive(Debug)]
struct SeparateGradient {
    shape: Sphere,
    cell: f64,
}

impl SeparateGradient {
    /// Gradient of a sphere's distance at the nodes around `point`, interpolated trilinearly.
    fn gradient(&self, point: DVec3) -> DVec3 {
        let scaled = point / self.cell;
        let (low, fraction) = (scaled.floor(), scaled - scaled.floor());
        let corners = isochore_mesh::Aabb { min: DVec3::ZERO, max: DVec3::ONE }.corners();
        let weighted = corners.into_iter().map(|corner| {
            let weights = corner * fraction + (1.0 - corner) * (1.0 - fraction);
            weights.element_product() * ((low + corner) * self.cell).normalize_or_zero()
        });
        weighted.sum()
    }
}

impl Distance for SeparateGradient {
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        self.shape.sample_into(points, out);
        for lane in 0..LANES {
            out.gradient.set(lane, self.gradient(points.get(lane)));
        }
    }

    fn bounds(&self) -> isochore_mesh::Aabb {
        self.shape.bounds()
    }

    fn centroid(&self) -> DVec3 {
        self.shape.centroid()
    }
}

#[test]
fn the_flux_reveals_a_separate_gradient() {
    let shape = Sphere::new(0.4).unwrap();
    let exact = tool(shape, 0.3, Profile::Quintic);
    let separate = tool(SeparateGradient { shape, cell: 0.05 }, 0.3, Profile::Quintic);
    assert!(flux(&RigidField::new(&exact, TWIST), 0.5) < QUADRATURE_NOISE);
    assert!(flux(&RigidField::new(&separate, TWIST), 0.5) > 10.0 * QUADRATURE_NOISE);
}

#[test]
fn a_tool_sampled_from_a_mesh_has_zero_net_flux() {
    let mesh = primitives::box_mesh(DVec3::new(0.3, 0.2, 0.4), [3, 2, 4]);
    let options = DistanceFieldOptions { resolution: 32, padding: Padding::Reach(0.25), ..Default::default() };
    let sampled = DistanceField::new(&mesh, &options, &NoProgress).unwrap();
    for profile in [Profile::Quintic, Profile::Contact] {
        let tool = Tool::new(Arc::new(sampled.clone()), 0.25, profile).unwrap();
        let flux = flux(&RigidField::new(&tool, TWIST), 0.5);
        assert!(flux < QUADRATURE_NOISE, "{profile}: {flux:.1e}");
    }
}

/// Compares V with the curl, by central differences, of the vector potential g(d/R) A.
#[test]
fn the_field_is_the_curl_of_its_potential() {
    let h = 1e-4;
    for (name, shape) in shapes() {
        let tool = Tool::new(shape, 0.25, Profile::Septic).unwrap();
        let field = RigidField::new(&tool, TWIST);
        let center = tool.center();
        let velocity = TWIST.velocity(center);
        let potential = |point: DVec3| {
            let r = point - center;
            let (g, _) = tool.profile().evaluate(tool.distance().sample(point).0 / tool.support());
            g * (0.5 * velocity.cross(r) + TWIST.angular.cross(r).cross(r) / 3.0)
        };
        for index in 0..40 {
            let t = f64::from(index);
            let point = DVec3::new(0.6 * libm::sin(t), 0.5 * libm::cos(1.7 * t), 0.7 * libm::sin(2.3 * t + 1.0));
            let slope = |axis: DVec3| (potential(point + h * axis) - potential(point - h * axis)) / (2.0 * h);
            let (dx, dy, dz) = (slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
            let curl = DVec3::new(dy.z - dz.y, dz.x - dx.z, dx.y - dy.x);
            // Truncation: h²/6 of a third derivative of the order of g‴/R³ = 1e3. The second
            // derivative of the distance from the box jumps at its edges.
            assert!(curl.distance(field.velocity(point)) < 2e-4, "{name} at {point}");
        }
    }
}

#[test]
fn the_normal_speed_on_the_surface_is_that_of_the_tool() {
    let tool = tool(Ellipsoid::new(DVec3::new(0.5, 0.3, 0.2)).unwrap(), 0.3, Profile::Contact);
    let field = RigidField::new(&tool, TWIST);
    for index in 0..50 {
        let (theta, phi) = (0.06 * f64::from(index), 0.7 * f64::from(index));
        let unit = DVec3::new(libm::sin(theta) * libm::cos(phi), libm::sin(theta) * libm::sin(phi), libm::cos(theta));
        let point = unit * DVec3::new(0.5, 0.3, 0.2);
        let (_, normal) = tool.distance().sample(point);
        let speed = field.velocity(point).dot(normal);
        // g = 1 up to 2 d/R, where d is the rounding error of the distance.
        assert!((speed - TWIST.velocity(point).dot(normal)).abs() < 1e-12);
    }
}

#[test]
fn the_gauge_center_only_changes_the_flow_outside_the_core() {
    let tool = tool(Capsule::new(0.2, 0.4).unwrap(), 0.25, Profile::Quintic);
    let mut shifted = tool.clone();
    shifted.shift_center(DVec3::new(0.3, -0.2, 0.5));
    let (field, other) = (RigidField::new(&tool, TWIST), RigidField::new(&shifted, TWIST));
    let inside = DVec3::new(0.05, 0.1, 0.3);
    assert!(field.velocity(inside).distance(other.velocity(inside)) < 1e-13);
    let beside = DVec3::new(0.35, 0.1, 0.3);
    assert!(field.velocity(beside).distance(other.velocity(beside)) > 1e-3);
}

#[test]
fn the_field_is_zero_outside_and_rigid_in_the_core() {
    let tool = tool(Sphere::new(0.4).unwrap(), 0.3, Profile::Quartic);
    let field = RigidField::new(&tool, TWIST);
    let mut block = VelocityBlock::REST;
    field.evaluate_into(&PointBlock::gather(&[DVec3::new(0.8, 0.0, 0.0), DVec3::new(0.1, -0.2, 0.2)]), &mut block);
    assert!(block.is_outside[0]);
    assert!(!block.is_outside[1]);
    assert_eq!(block.relative.get(1), DVec3::ZERO);
}
