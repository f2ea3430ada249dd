//! A field whose potential is multiplied by a mask: V′ = curl(m P) = m V + ∇m × P.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, PointBlock};

use crate::fields::{Field, FieldBlock, Mask, MovingField, Pose, ScalarBlock};

/// Largest number of instants at which the speed of the masked field is sampled. Larger: every
/// stroke takes longer. Smaller: the moment when a tool passes a pin can be missed.
const MAX_INSTANTS: usize = 32;

/// A field with a mask.
#[derive(Debug, Clone)]
pub(crate) struct MaskedField {
    field: Arc<dyn MovingField>,
    mask: Arc<Mask>,
    core_speed: f64,
}

impl MaskedField {
    /// `field` with its potential multiplied by `mask`. `bounds` is the box of the points to
    /// advect.
    pub(crate) fn new(field: Arc<dyn MovingField>, mask: Arc<Mask>, bounds: Aabb) -> Self {
        let mut masked = Self { field, mask, core_speed: 0.0 };
        masked.core_speed = masked.field.core_speed().max(masked.speed_at_probes(bounds));
        masked
    }

    /// Largest speed found where the mask varies, in and around a box. Between held and moving
    /// material the flow passes through a gap, and its speed grows as the gap narrows.
    fn speed_at_probes(&self, bounds: Aabb) -> f64 {
        let around = bounds.expanded(bounds.size().length());
        let mut probes = self.mask.probes();
        probes.retain(|&probe| around.distance(probe) == 0.0);
        let steps = self.field.core_speed() / self.field.feature_size();
        // Clamped as a float, because the ratio may be infinite or NaN.
        let instants = steps.ceil().clamp(1.0, MAX_INSTANTS as f64) as usize;
        let speeds = (0..=instants).map(|instant| {
            let field = self.at(instant as f64 / instants as f64);
            let near = probes.iter().filter(|&&probe| field.bounds().distance(probe) == 0.0);
            near.map(|&probe| field.velocity(probe).length()).fold(0.0, f64::max)
        });
        speeds.fold(0.0, f64::max)
    }
}

impl MovingField for MaskedField {
    fn at(&self, time: f64) -> Box<dyn Field> {
        Box::new(MaskedInstant { field: self.field.at(time), mask: Arc::clone(&self.mask) })
    }

    fn approach_speed(&self) -> f64 {
        self.field.approach_speed()
    }

    fn core_speed(&self) -> f64 {
        self.core_speed
    }

    fn feature_size(&self) -> f64 {
        self.field.feature_size().min(self.mask.feature_size())
    }

    fn feature_size_near(&self, center: DVec3, radius: f64) -> f64 {
        self.field.feature_size_near(center, radius).min(self.mask.feature_size_near(center, radius))
    }
}

/// A masked field at one instant.
#[derive(Debug)]
struct MaskedInstant {
    field: Box<dyn Field>,
    mask: Arc<Mask>,
}

impl Field for MaskedInstant {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        self.field.evaluate_into(points, out);
        let mut factor = ScalarBlock::ONE;
        self.mask.evaluate_into(points, out.clearance.map(|clearance| clearance == 0.0), &mut factor);
        out.scale(&factor);
    }

    fn bounds(&self) -> Aabb {
        self.field.bounds()
    }

    fn parts(&self) -> Vec<Aabb> {
        self.field.parts()
    }

    fn core_pose(&self, core: u32) -> Pose {
        self.field.core_pose(core)
    }
}
