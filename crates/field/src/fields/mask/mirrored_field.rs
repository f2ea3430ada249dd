//! A field made symmetric about planes.
//!
//! The mirror image of a field has the potential Pᴹ(x) = −M P(Mx): a potential is a pseudovector. The plain sum P + Pᴹ would
//! carry at twice the speed where a tool and its image overlap, so the shares s and sᴹ of the full motion divide it:
//!
//! ```text
//! P_sym = (P + Pᴹ) / (1 + s sᴹ)
//! ```
//!
//! This is P where the image has no share and the mean of both where both are one. It is a potential, so its curl is
//! divergence-free; on the plane its tangential part vanishes, so nothing flows through.
//!
//! The mean of two cores that move alike is their motion only if both potentials are about one center; so the center of a
//! rigid body's gauge is drawn onto the plane while the support reaches through it. That adds a gradient to the potential,
//! which changes no velocity but that where the share fades.

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
        let gauge = rigid_gauge(&*self.field, time).map(|gauge| (gauge, drawn_center(&gauge, &self.planes)));
        Box::new(MirroredInstant { field, planes: Arc::clone(&self.planes), gauge })
    }

    /// A mirror image comes closer to a point as fast as the field comes closer to the point's mirror image.
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

/// The gauge of the potential at `time`, or `None` if the field is not that of one rigid body.
fn rigid_gauge(field: &dyn MovingField, time: f64) -> Option<RigidGauge> {
    let field: &dyn Any = field;
    field.downcast_ref::<MovingTool>()?.gauge_at(time)
}

/// The center of a gauge, moved onto every plane that the support reaches through.
fn drawn_center(gauge: &RigidGauge, planes: &[MirrorPlane]) -> DVec3 {
    planes.iter().fold(gauge.center, |center, plane| {
        // All of the way while the body itself, and none before the support, touches the plane.
        let beyond = gauge.extent_along(plane.normal()) - gauge.support;
        let (share, _) = Profile::Quintic.evaluate((plane.distance(gauge.middle).abs() - beyond) / gauge.support);
        center - share * plane.distance(center) * plane.normal()
    })
}

#[derive(Debug)]
struct MirroredInstant {
    field: Box<dyn Field>,
    planes: Arc<[MirrorPlane]>,
    /// The gauge of a rigid body, and where its center is drawn to.
    gauge: Option<(RigidGauge, DVec3)>,
}

impl MirroredInstant {
    /// The field made symmetric about `planes`.
    fn evaluate(&self, planes: &[MirrorPlane], points: &PointBlock, out: &mut FieldBlock) {
        let Some((plane, others)) = planes.split_last() else { return self.evaluate_drawn(points, out) };
        self.evaluate(others, points, out);
        let mut reflected = PointBlock::ZERO;
        for lane in 0..LANES {
            reflected.set(lane, plane.reflect_point(points.get(lane)));
        }
        let mut image = FieldBlock::ZERO;
        self.evaluate(others, &reflected, &mut image);
        combine(plane, out, &image);
    }

    /// The field itself, with the center of its gauge drawn onto the planes.
    fn evaluate_drawn(&self, points: &PointBlock, out: &mut FieldBlock) {
        // Near one image of the field all points are beyond the others.
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

/// Puts the symmetric field into `field`; `image` is the field at the reflected points.
fn combine(plane: &MirrorPlane, field: &mut FieldBlock, image: &FieldBlock) {
    let mut weight = ScalarBlock::ONE;
    for lane in 0..LANES {
        let (share, other) = (field.weight.value[lane], image.weight.value[lane]);
        let gradient = field.weight.gradient.get(lane);
        let other_gradient = plane.reflect_vector(image.weight.gradient.get(lane));
        let value = 1.0 / (1.0 + share * other);
        weight.value[lane] = value;
        weight.gradient.set(lane, -value * value * (other * gradient + share * other_gradient));

        let reflect = |vector: DVec3| plane.reflect_vector(vector);
        field.potential.set(lane, field.potential.get(lane) - reflect(image.potential.get(lane)));
        field.velocity.set(lane, field.velocity.get(lane) + reflect(image.velocity.get(lane)));
        field.weight.value[lane] = share + other;
        field.weight.gradient.set(lane, gradient + other_gradient);
        field.clearance[lane] = field.clearance[lane].min(image.clearance[lane]);
        // Closed forms on one side only would break the symmetry in the last digits.
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
