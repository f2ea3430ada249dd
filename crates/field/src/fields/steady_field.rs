//! Fields that do not change over a stroke.

use crate::fields::{Field, MovingField};

/// A [`Field`] that does not change over a stroke.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_field::{Field, FieldBlock, FieldStroke, NO_CORE, SteadyField, Stroke, WeightedPotential};
/// use isochore_mesh::{Aabb, LANES, PointBlock};
///
/// /// The shear V = curl(0, −½ z², 0) = (z, 0, 0).
/// #[derive(Debug, Clone)]
/// struct Shear;
///
/// impl Field for Shear {
///     fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
///         for lane in 0..LANES {
///             let z = points.get(lane).z;
///             let (potential, curl) = (-0.5 * z * z * DVec3::Y, z * DVec3::X);
///             out.set_inside(lane, WeightedPotential { weight: 1.0, gradient: DVec3::ZERO, potential, curl }, NO_CORE);
///         }
///     }
///
///     fn bounds(&self) -> Aabb {
///         Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }
///     }
/// }
///
/// let steady = SteadyField { field: Shear, core_speed: 1.0, feature_size: 1.0 };
/// let stroke = Stroke::Field(FieldStroke::new(vec![std::sync::Arc::new(steady)], 0.25)?);
/// let mut points = [DVec3::Z];
/// stroke.advect(&mut points);
/// assert!(points[0].distance(DVec3::new(1.0, 0.0, 1.0)) < 1e-15);
/// # Ok::<(), isochore_field::FieldStrokeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyField<F> {
    /// The field at every time.
    pub field: F,
    /// Upper bound on the speed where the weight is one, model units per unit of time. The time
    /// step is chosen from it.
    pub core_speed: f64,
    /// Length over which the field varies, model units.
    pub feature_size: f64,
}

impl<F: Field + Clone + 'static> MovingField for SteadyField<F> {
    fn at(&self, _time: f64) -> Box<dyn Field> {
        Box::new(self.field.clone())
    }

    fn approach_speed(&self) -> f64 {
        0.0
    }

    fn core_speed(&self) -> f64 {
        self.core_speed
    }

    fn feature_size(&self) -> f64 {
        self.feature_size
    }
}
