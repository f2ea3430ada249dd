//! A field made symmetric about planes.
//!
//! A potential is a pseudovector, so the mirror image of a field has the potential Pᴹ(x) = −M
//! P(Mx). In the sum P + Pᴹ, the material within both a tool and its image would move at twice the
//! speed. The weights s and sᴹ of the full motion correct this:
//!
//! ```text
//! P_sym = (P + Pᴹ) / (1 + s sᴹ)
//! ```
//!
//! This equals P where sᴹ is zero, and the mean of both where both weights are one. The field is
//! the curl of P_sym, so it is divergence-free. On the plane, the tangential part of P_sym
//! vanishes, so nothing flows through.
//!
//! The mean of two cores with equal motion is that motion only if both potentials have the same
//! center. The center of a rigid body's gauge is therefore shifted onto the plane while the support
//! intersects it. The shift adds a gradient to the potential, which changes the velocity only where
//! the weight varies.

use std::{any::Any, sync::Arc};

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, PointBlock};

use crate::fields::{
    Field, FieldBlock, MirrorPlane, MovingField, MovingTool, NO_CORE, Profile, ScalarBlock, mask::images,
    rigid_motion::RigidGauge,
};

/// A field and its mirror images.
#[derive(Debug, Clone)]
pub(crate) struct MirroredField {
    field: Arc<dyn MovingField>,
    planes: Arc<[MirrorPlane]>,
}

impl MirroredField {
    /// `field` made symmetric about planes that are perpendicular to each other.
    pub(crate) fn new(field: Arc<dyn MovingField>, planes: &[MirrorPlane]) -> Self {
        Self { field, planes: planes.into() }
    }
}

impl MovingField for MirroredField {
    fn at(&self, time: f64) -> Box<dyn Field> {
        let field = self.field.at(time);
        let gauge = rigid_gauge(&*self.field, time).map(|gauge| (gauge, shifted_center(&gauge, &self.planes)));
        Box::new(MirroredInstant { field, planes: Arc::clone(&self.planes), gauge })
    }

    /// A mirror image approaches a point at the speed at which the field approaches the mirror
    /// image of the point.
    fn approach_speed(&self) -> f64 {
        self.field.approach_speed()
    }

    fn core_speed(&self) -> f64 {
        self.field.core_speed()
    }

    fn feature_size(&self) -> f64 {
        self.field.feature_size()
    }

    fn feature_size_near(&self, center: DVec3, radius: f64) -> f64 {
        let images = images(&self.planes, center).into_iter();
        images.map(|image| self.field.feature_size_near(image, radius)).fold(f64::INFINITY, f64::min)
    }
}

/// Gauge of the potential at `time`, or `None` if the field is not that of one rigid body.
fn rigid_gauge(field: &dyn MovingField, time: f64) -> Option<RigidGauge> {
    let field: &dyn Any = field;
    field.downcast_ref::<MovingTool>()?.gauge_at(time)
}

/// Center of a gauge, shifted onto every plane that the support intersects.
fn shifted_center(gauge: &RigidGauge, planes: &[MirrorPlane]) -> DVec3 {
    planes.iter().fold(gauge.center, |center, plane| {
        // Shifted fully while the body itself intersects the plane, and not at all until the
        // support does.
        let beyond = gauge.extent_along(plane.normal()) - gauge.support;
        let (fraction, _) = Profile::Quintic.evaluate((plane.distance(gauge.middle).abs() - beyond) / gauge.support);
        center - fraction * plane.distance(center) * plane.normal()
    })
}

/// A symmetric field at one instant.
#[derive(Debug)]
struct MirroredInstant {
    field: Box<dyn Field>,
    planes: Arc<[MirrorPlane]>,
    /// Gauge of a rigid body, and its shifted center.
    gauge: Option<(RigidGauge, DVec3)>,
}

impl MirroredInstant {
    /// Evaluates the field made symmetric about `planes`.
    fn evaluate(&self, planes: &[MirrorPlane], points: &PointBlock, out: &mut FieldBlock) {
        let Some((plane, others)) = planes.split_last() else { return self.evaluate_shifted(points, out) };
        self.evaluate(others, points, out);
        let mut reflected = PointBlock::ZERO;
        for lane in 0..LANES {
            reflected.set(lane, plane.reflect_point(points.get(lane)));
        }
        let mut image = FieldBlock::ZERO;
        self.evaluate(others, &reflected, &mut image);
        combine(plane, out, &image);
    }

    /// Evaluates the field itself, with the center of its gauge shifted onto the planes.
    fn evaluate_shifted(&self, points: &PointBlock, out: &mut FieldBlock) {
        // A block near one image of the field is often entirely beyond the others.
        let bounds = self.field.bounds();
        let clearance: [f64; LANES] = std::array::from_fn(|lane| bounds.distance(points.get(lane)));
        if clearance.iter().all(|&clearance| clearance > 0.0) {
            (0..LANES).for_each(|lane| out.set_outside(lane, clearance[lane]));
            return;
        }
        self.field.evaluate_into(points, out);
        let Some((gauge, center)) = self.gauge.filter(|(gauge, center)| gauge.center != *center) else { return };
        for lane in (0..LANES).filter(|&lane| out.clearance[lane] == 0.0) {
            let change = gauge.change(center, points.get(lane));
            let potential = out.potential.get(lane) + out.weight.value[lane] * change;
            let velocity = out.velocity.get(lane) + out.weight.gradient.get(lane).cross(change);
            out.potential.set(lane, potential);
            out.velocity.set(lane, velocity);
        }
    }
}

/// Replaces `field` by the symmetric field. `image` is the field at the reflected points.
fn combine(plane: &MirrorPlane, field: &mut FieldBlock, image: &FieldBlock) {
    let mut weight = ScalarBlock::ONE;
    for lane in 0..LANES {
        let (own, other) = (field.weight.value[lane], image.weight.value[lane]);
        let gradient = field.weight.gradient.get(lane);
        let other_gradient = plane.reflect_vector(image.weight.gradient.get(lane));
        let value = 1.0 / (1.0 + own * other);
        weight.value[lane] = value;
        weight.gradient.set(lane, -value * value * (other * gradient + own * other_gradient));

        let reflect = |vector: DVec3| plane.reflect_vector(vector);
        field.potential.set(lane, field.potential.get(lane) - reflect(image.potential.get(lane)));
        field.velocity.set(lane, field.velocity.get(lane) + reflect(image.velocity.get(lane)));
        // `scale` below turns the sum of the weights into (s + sᴹ)/(1 + s sᴹ).
        field.weight.value[lane] = own + other;
        field.weight.gradient.set(lane, gradient + other_gradient);
        field.clearance[lane] = field.clearance[lane].min(image.clearance[lane]);
        // Closed forms on only one side would break the symmetry in the last digits.
        field.core[lane] = NO_CORE;
    }
    field.scale(&weight);
}

impl Field for MirroredInstant {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        self.evaluate(&self.planes, points, out);
    }

    fn bounds(&self) -> Aabb {
        self.parts().into_iter().fold(Aabb::EMPTY, Aabb::union)
    }

    fn parts(&self) -> Vec<Aabb> {
        let mut parts = self.field.parts();
        if !parts.iter().all(|part| part.min.is_finite() && part.max.is_finite()) {
            return vec![self.field.bounds()];
        }
        for plane in &*self.planes {
            let image = |part: &Aabb| Aabb::of(part.corners().map(|corner| plane.reflect_point(corner)));
            parts.extend(parts.iter().map(image).collect::<Vec<_>>());
        }
        parts
    }
}
