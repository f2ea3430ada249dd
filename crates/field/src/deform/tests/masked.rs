use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, NoProgress, PointBlock, primitives};

use super::*;
use crate::{
    fields::{
        Field, FieldBlock, Mask, MovingField, NO_CORE, ScalarBlock, VertexMask,
        field::flux::{QUADRATURE_NOISE, worst_field_flux},
        mask::tests::{pin, pinned},
    },
    flow::{
        FieldStroke, Twist,
        advection::bits,
        stroke::tests::{BOUNDS, ball, instant},
    },
};

/// A field whose velocity is multiplied by the mask, which is wrong.
#[derive(Debug)]
struct MaskedVelocity(Arc<dyn MovingField>, Arc<Mask>);

#[derive(Debug)]
struct MaskedVelocityInstant(Box<dyn Field>, Arc<Mask>);

impl MovingField for MaskedVelocity {
    fn at(&self, time: f64) -> Box<dyn Field> {
        Box::new(MaskedVelocityInstant(self.0.at(time), self.1.clone()))
    }
    fn approach_speed(&self) -> f64 {
        self.0.approach_speed()
    }
    fn core_speed(&self) -> f64 {
        self.0.core_speed()
    }
    fn feature_size(&self) -> f64 {
        self.0.feature_size()
    }
}

impl Field for MaskedVelocityInstant {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        self.0.evaluate_into(points, out);
        let mut mask = ScalarBlock::ONE;
        self.1.evaluate_into(points, [true; LANES], &mut mask);
        for lane in 0..LANES {
            out.velocity.set(lane, mask.value[lane] * out.velocity.get(lane));
            out.core[lane] = NO_CORE;
        }
    }
    fn bounds(&self) -> Aabb {
        self.0.bounds()
    }
}

#[test]
fn masking_the_potential_keeps_the_volume_and_masking_the_velocity_does_not() {
    let mask = pinned(vec![pin([0.35, 0.0, 0.85], 0.1, 0.4)]);
    let press = ball([0.0, 0.0, 1.7], [0.0, 0.0, 1.0], 0.05);
    let Stroke::Move(motion) = &press else { unreachable!() };
    let wrong: Vec<Arc<dyn MovingField>> =
        motion.fields().into_iter().map(|field| Arc::new(MaskedVelocity(field, mask.clone())) as _).collect();
    let flux = |field: &dyn Field| {
        // Around the pin, where the mask changes.
        let shifted = Shifted(field, DVec3::new(0.35, 0.0, 0.85));
        worst_field_flux(&shifted, |_| f64::INFINITY, 0.3)
    };
    assert!(flux(&*instant(&press, &mask)) < QUADRATURE_NOISE);
    assert!(flux(&*wrong[0].at(0.5)) > 100.0 * QUADRATURE_NOISE);

    let wrong = Stroke::Field(FieldStroke::new(wrong, 0.05).unwrap());
    let right = press.masked(&mask, BOUNDS, 0.05).unwrap();
    let refine = RefineOptions { volume: Some(1e-5), ..RefineOptions::default() };
    let options = DeformOptions { refine: Some(refine), lock: false };
    let [wrong, right] = [wrong, right].map(|stroke| {
        let receipt = deform(&primitives::icosphere(1.0, 4), &[stroke], &options, &NoProgress).unwrap().receipt;
        assert!(receipt.max_displacement > 0.2);
        receipt.volume_before_lock.unwrap() / receipt.volume_before.unwrap() - 1.0
    });
    // Twice the estimate that ends refinement, and the error of the time step.
    assert!(right.abs() < 3e-5, "{right:e}");
    assert!(wrong.abs() > 1e-3, "{wrong:e}");
}

/// A field relative to another origin.
#[derive(Debug)]
struct Shifted<'a>(&'a dyn Field, DVec3);

impl Field for Shifted<'_> {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        let mut moved = PointBlock::ZERO;
        (0..LANES).for_each(|lane| moved.set(lane, points.get(lane) + self.1));
        self.0.evaluate_into(&moved, out);
    }
    fn bounds(&self) -> Aabb {
        let Aabb { min, max } = self.0.bounds();
        Aabb { min: min - self.1, max: max - self.1 }
    }
}

#[test]
fn held_vertices_keep_their_bits_and_the_volume_is_kept() {
    let sphere = primitives::icosphere(1.0, 4);
    let weights: Vec<f64> = sphere.positions.iter().map(|position| if position.x > 0.1 { 1.0 } else { 0.0 }).collect();
    let vertices = VertexMask::new(&sphere, &weights, Some(0.5)).unwrap();
    let mask = Arc::new(Mask::new(Vec::new(), Some(vertices), Vec::new()).unwrap());
    let press = ball([0.0, 0.0, 1.6], [0.0, 0.0, 1.0], 0.125).masked(&mask, BOUNDS, 0.125).unwrap();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = DeformOptions::default();
        pool.install(|| deform(&sphere, std::slice::from_ref(&press), &options, &NoProgress).unwrap())
    };
    let deformed = on(1);
    for (index, weight) in weights.iter().enumerate() {
        if *weight == 1.0 {
            assert_eq!(bits(deformed.mesh.positions[index]), bits(sphere.positions[index]));
        }
    }
    let receipt = &deformed.receipt;
    assert!(receipt.max_displacement > 0.2);
    // Twice the estimate that ends refinement.
    let drift = receipt.volume_before_lock.unwrap() / receipt.volume_before.unwrap() - 1.0;
    assert!(drift.abs() < 2e-4, "{drift:e}");
    assert_eq!(deformed.mesh, on(2).mesh);
    assert_eq!(deformed.mesh, on(8).mesh);
}

#[test]
fn refinement_finds_a_pin_smaller_than_the_triangles() {
    let cube = primitives::box_mesh(DVec3::ONE, [1, 1, 1]);
    let mask = pinned(vec![pin([0.3, -0.1, 1.0], 0.05, 0.2)]);
    let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, 0.25 * FRAC_PI_2).unwrap());
    let masked = twist.masked(&mask, BOUNDS, 0.125).unwrap();
    let options = DeformOptions { refine: Some(RefineOptions::default()), lock: false };
    let deformed = deform(&cube, &[masked], &options, &NoProgress).unwrap();
    let held = deformed.rest.positions.iter().zip(&deformed.mesh.positions);
    let held: Vec<_> = held.filter(|(rest, _)| rest.distance(DVec3::new(0.3, -0.1, 1.0)) < 0.05).collect();
    assert!(!held.is_empty());
    assert!(held.into_iter().all(|(rest, image)| bits(*rest) == bits(*image)));
}
