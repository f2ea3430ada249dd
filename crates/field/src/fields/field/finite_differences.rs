//! Test suite for every field: velocity and weight gradient against central differences.

use glam::{DMat3, DVec3};
use isochore_mesh::PointBlock;

use crate::fields::{Field, FieldBlock};

/// Largest differences between the values of a field and central differences.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Deviation {
    /// Difference of the velocity from the curl of the potential.
    pub(crate) curl: f64,
    /// Absolute divergence of the velocity.
    pub(crate) divergence: f64,
    /// Difference of the gradient of the weight from its finite difference.
    pub(crate) gradient: f64,
}

/// Largest deviations of `field` from its definition at `points`, by central differences with the
/// given `step`.
///
/// The truncation error grows with the square of the step, the rounding error with its inverse.
pub(crate) fn deviation(field: &dyn Field, points: &[DVec3], step: f64) -> Deviation {
    points.iter().fold(Deviation::default(), |worst, &point| {
        let at = |point: DVec3| {
            let mut block = FieldBlock::ZERO;
            field.evaluate_into(&PointBlock::splat(point), &mut block);
            block
        };
        let center = at(point);
        let sides = DMat3::IDENTITY.to_cols_array_2d().map(|axis| {
            let shift = step * DVec3::from_array(axis);
            (at(point + shift), at(point - shift))
        });
        let derivative = |value: fn(&FieldBlock) -> DVec3| {
            sides.map(|(ahead, behind)| (value(&ahead) - value(&behind)) / (2.0 * step))
        };
        let [dx, dy, dz] = derivative(|block| block.potential.get(0));
        let curl = DVec3::new(dy.z - dz.y, dz.x - dx.z, dx.y - dy.x);
        let [dx, dy, dz] = derivative(|block| block.velocity.get(0));
        let weight_slopes = derivative(|block| DVec3::splat(block.weight.value[0])).map(|slope| slope.x);
        let gradient = DVec3::from_array(weight_slopes);
        Deviation {
            curl: worst.curl.max(curl.distance(center.velocity.get(0))),
            divergence: worst.divergence.max((dx.x + dy.y + dz.z).abs()),
            gradient: worst.gradient.max(gradient.distance(center.weight.gradient.get(0))),
        }
    })
}

/// Points of a low-discrepancy sequence in the cube of half side `size` around the origin.
pub(crate) fn scattered_points(count: u32, size: f64) -> Vec<DVec3> {
    // Reciprocal powers of the plastic number's generalization to three dimensions.
    const STEPS: DVec3 = DVec3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_970_2);
    (1..=count).map(|index| size * (2.0 * (f64::from(index) * STEPS).fract() - 1.0)).collect()
}

#[test]
fn detects_a_velocity_with_divergence() {
    #[derive(Debug)]
    struct Source;
    impl Field for Source {
        fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
            *out = FieldBlock { velocity: *points, ..FieldBlock::ZERO };
        }
        fn bounds(&self) -> isochore_mesh::Aabb {
            isochore_mesh::Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }
        }
    }
    let seen = deviation(&Source, &scattered_points(8, 1.0), 1e-4);
    assert!((seen.divergence - 3.0).abs() < 1e-9 && seen.curl > 0.5, "{seen:?}");
}
