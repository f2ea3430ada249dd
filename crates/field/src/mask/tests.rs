use std::f64::consts::FRAC_PI_2;

use isochore_mesh::{Aabb, Capsule, NoProgress, Sphere, TriMesh, primitives};

use super::*;
use crate::{
    Bend, DeformOptions, Field, FieldBlock, Move, MovingField, Pose, Profile, RefineOptions, Stroke, Tool, Twist,
    advect_points, deform,
    finite_differences::{deviation, scattered_points},
    flux::{QUADRATURE_NOISE, worst_field_flux},
    rotation_from_vector,
};
use std::sync::Arc;

/// The box of what twists and bends carry here.
const BOUNDS: Aabb = Aabb { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };

fn pin(center: [f64; 3], radius: f64, support: f64) -> Pin {
    Pin::new(center.into(), radius, support).unwrap()
}

fn plane(point: [f64; 3], normal: [f64; 3]) -> MirrorPlane {
    MirrorPlane::new(point.into(), normal.into()).unwrap()
}

fn pinned(pins: Vec<Pin>) -> Arc<Mask> {
    Arc::new(Mask::new(pins, None, Vec::new()).unwrap())
}

fn mirrored(mirrors: Vec<MirrorPlane>) -> Arc<Mask> {
    Arc::new(Mask::new(Vec::new(), None, mirrors).unwrap())
}

/// A ball of radius 0.3 and support 0.3 that moves from one place to another.
fn ball(from: [f64; 3], to: [f64; 3], step: f64) -> Stroke {
    let tool = Tool::new(Arc::new(Sphere::new(0.3).unwrap()), 0.3, Profile::Quintic).unwrap();
    let keys = vec![Pose::at(from.into()), Pose::at(to.into())];
    Stroke::Move(Move::new(Arc::new(tool), keys, step).unwrap())
}

/// A rod that moves and turns.
fn rod(step: f64) -> Stroke {
    let tool = Tool::new(Arc::new(Capsule::new(0.15, 0.4).unwrap()), 0.3, Profile::Quintic).unwrap();
    let pose =
        |turn: [f64; 3], at: [f64; 3]| Pose { rotation: rotation_from_vector(turn.into()), translation: at.into() };
    let keys = vec![pose([0.2, 0.9, 0.2], [-0.3, 0.2, 0.1]), pose([0.6, 0.3, -0.5], [0.3, 0.1, 0.3])];
    Stroke::Move(Move::new(Arc::new(tool), keys, step).unwrap())
}

/// The field of the first leg of a masked stroke, halfway.
fn instant(stroke: &Stroke, mask: &Arc<Mask>) -> Box<dyn Field> {
    match stroke.masked(mask, BOUNDS, 0.1).unwrap() {
        Stroke::Field(fields) => fields.fields().next().unwrap().at(0.5),
        other => panic!("{other:?} is not masked"),
    }
}

fn bits(point: DVec3) -> [u64; 3] {
    point.to_array().map(f64::to_bits)
}

/// One for vertices of the unit sphere above this height, zero for the others.
fn cap_weights(mesh: &TriMesh, height: f64) -> Vec<f64> {
    mesh.positions.iter().map(|position| if position.z > height { 1.0 } else { 0.0 }).collect()
}

fn painted(fade: f64) -> Arc<Mask> {
    let sphere = primitives::icosphere(1.0, 3);
    let vertices = VertexMask::new(&sphere, &cap_weights(&sphere, 0.6), Some(fade)).unwrap();
    Arc::new(Mask::new(Vec::new(), Some(vertices), Vec::new()).unwrap())
}

#[test]
fn masked_and_mirrored_fields_are_divergence_free() {
    let pins = || vec![pin([0.3, 0.1, 0.2], 0.1, 0.4), pin([-0.2, 0.3, 0.0], 0.0, 0.5)];
    let tilted = || vec![plane([0.1, 0.05, 0.0], [1.0, 0.2, 0.1])];
    let two = vec![plane([0.1, 0.0, 0.0], [3.0, 0.0, 0.0]), plane([0.0, 0.1, 0.0], [0.0, 0.5, 0.0])];
    let masks = [
        ("pins", pinned(pins())),
        ("plane", mirrored(tilted())),
        ("two planes", mirrored(two)),
        ("pins and plane", Arc::new(Mask::new(pins(), None, tilted()).unwrap())),
        ("painted", painted(0.8)),
    ];
    let strokes = [
        ("rod", rod(0.1)),
        ("twist", Stroke::Twist(Twist::new(DVec3::new(0.1, 0.0, 0.2), DVec3::new(0.2, 0.1, 1.0), 1.0).unwrap())),
        ("bend", Stroke::Bend(Bend::new(DVec3::new(0.1, 0.0, 0.2), DVec3::new(0.2, 0.1, 1.0), 1.0).unwrap())),
    ];
    for (mask_name, mask) in &masks {
        for (stroke_name, stroke) in &strokes {
            let field = instant(stroke, mask);
            let seen = deviation(&*field, &scattered_points(150, 0.9), 1e-4);
            // Truncation: h²/6 = 2e-9 times third derivatives. Those of a quintic over 0.3 are of the order of 60/R³ = 2e3, of
            // products of two of them ten times that; the kernel average's over 0.4 less.
            assert!(
                seen.curl < 2e-4 && seen.divergence < 5e-4 && seen.gradient < 2e-4,
                "{stroke_name} with {mask_name}: {seen:?}"
            );
            let flux = worst_field_flux(&*field, |_| f64::INFINITY, 0.6);
            assert!(flux < QUADRATURE_NOISE, "{stroke_name} with {mask_name}: {flux:e}");
        }
    }
}

/// The same field with its velocity multiplied by the mask, as it should not be.
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
            out.core[lane] = crate::NO_CORE;
        }
    }
    fn bounds(&self) -> Aabb {
        self.0.bounds()
    }
}

#[test]
fn masking_the_velocity_breaks_the_volume_and_masking_the_potential_does_not() {
    let mask = pinned(vec![pin([0.35, 0.0, 0.85], 0.1, 0.4)]);
    let press = ball([0.0, 0.0, 1.7], [0.0, 0.0, 1.0], 0.05);
    let Stroke::Move(motion) = &press else { unreachable!() };
    let wrong: Vec<Arc<dyn MovingField>> =
        motion.fields().into_iter().map(|field| Arc::new(MaskedVelocity(field, mask.clone())) as _).collect();
    let flux = |field: &dyn Field| {
        // About the pin, where the mask changes.
        let shifted = Shifted(field, DVec3::new(0.35, 0.0, 0.85));
        worst_field_flux(&shifted, |_| f64::INFINITY, 0.3)
    };
    assert!(flux(&*instant(&press, &mask)) < QUADRATURE_NOISE);
    assert!(flux(&*wrong[0].at(0.5)) > 100.0 * QUADRATURE_NOISE);

    let wrong = Stroke::Field(crate::FieldStroke::new(wrong, 0.05).unwrap());
    let right = press.masked(&mask, BOUNDS, 0.05).unwrap();
    let refine = RefineOptions { volume: 1e-5, ..RefineOptions::default() };
    let options = DeformOptions { refine: Some(refine), lock: false };
    let [wrong, right] = [wrong, right].map(|stroke| {
        let receipt = deform(&primitives::icosphere(1.0, 4), &[stroke], &options, &NoProgress).unwrap().receipt;
        assert!(receipt.max_displacement > 0.2);
        receipt.volume_before_lock.unwrap() / receipt.volume_before.unwrap() - 1.0
    });
    // Twice the estimate that ends refinement, and what the time step leaves.
    assert!(right.abs() < 3e-5, "{right:e}");
    assert!(wrong.abs() > 1e-3, "{wrong:e}");
}

/// A field seen from another origin.
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
fn pinned_points_keep_their_bits() {
    let mask = pinned(vec![pin([0.1, 0.0, 0.9], 0.2, 0.1)]);
    let strokes = [
        ball([0.0, 0.0, 1.7], [0.0, 0.0, 0.9], 0.1),
        rod(0.1),
        Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap()),
        Stroke::Bend(Bend::new(DVec3::ZERO, DVec3::Y, 1.0).unwrap()),
    ];
    let strokes = strokes.map(|stroke| stroke.masked(&mask, BOUNDS, 0.1).unwrap());
    let mut points: Vec<DVec3> =
        scattered_points(100, 0.11).into_iter().map(|point| point + DVec3::new(0.1, 0.0, 0.9)).collect();
    points.push(DVec3::new(0.1, -0.0, 0.9));
    let free = DVec3::new(0.4, 0.0, 0.9);
    let carried = advect_points(&[&points[..], &[free]].concat(), &strokes, &NoProgress).unwrap();
    for (point, carried) in points.iter().zip(&carried) {
        assert_eq!(bits(*point), bits(*carried));
    }
    assert!(carried[points.len()].distance(free) > 0.1);
}

#[test]
fn what_no_mask_touches_flows_as_without() {
    let far = pinned(vec![pin([3.0, 0.0, 0.0], 0.1, 0.1)]);
    let stroke = rod(0.1);
    let Stroke::Move(motion) = &stroke else { unreachable!() };
    let plain = Stroke::Field(crate::FieldStroke::new(motion.fields(), 0.1).unwrap());
    let masked = stroke.masked(&far, BOUNDS, 0.1).unwrap();
    let points = scattered_points(200, 1.0);
    // The far pin is as narrow as a third of the support: finer steps, the same flow up to their error of order four.
    let [a, b] = [plain, masked].map(|stroke| advect_points(&points, &[stroke], &NoProgress).unwrap());
    assert!(a.iter().zip(&b).all(|(a, b)| a.distance(*b) < 1e-4));
}

#[test]
fn integrated_twists_and_bends_converge_to_the_exact_ones() {
    let axis = DVec3::new(1.0, 2.0, 2.0);
    let strokes = [
        Stroke::Twist(Twist::new(DVec3::new(0.1, 0.0, 0.0), axis, 1.5).unwrap()),
        Stroke::Bend(Bend::new(DVec3::new(0.1, 0.0, 0.0), axis, 0.8).unwrap()),
    ];
    let far = pinned(vec![pin([9.0, 0.0, 0.0], 0.1, 5.0)]);
    let points = scattered_points(100, 1.0);
    for stroke in strokes {
        let exact = advect_points(&points, std::slice::from_ref(&stroke), &NoProgress).unwrap();
        let error = |step: f64| {
            let masked = stroke.masked(&far, BOUNDS, step).unwrap();
            let carried = advect_points(&points, &[masked], &NoProgress).unwrap();
            carried.iter().zip(&exact).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
        };
        let [coarse, fine] = [0.2, 0.1].map(error);
        assert!(fine < 1e-4 && fine < coarse / 12.0, "{coarse:e} {fine:e}");
    }
}

#[test]
fn mirrored_flows_are_symmetric_and_stay_on_their_side() {
    let mask = mirrored(vec![plane([0.0; 3], [-2.0, 0.0, 0.0]), plane([0.0; 3], [0.0, 1e-3, 0.0])]);
    let strokes = [rod(0.1), ball([0.1, 0.2, 0.8], [0.3, -0.1, 0.2], 0.1)];
    let strokes = strokes.map(|stroke| stroke.masked(&mask, BOUNDS, 0.1).unwrap());
    let points = scattered_points(300, 0.8);
    let images: Vec<DVec3> = points.iter().map(|point| *point * DVec3::new(-1.0, 1.0, 1.0)).collect();
    let on_plane: Vec<DVec3> = points.iter().map(|point| *point * DVec3::new(0.0, 1.0, 1.0)).collect();
    let [a, b, c] = [&points, &images, &on_plane].map(|points| advect_points(points, &strokes, &NoProgress).unwrap());
    let mut largest: f64 = 0.0;
    for ((a, b), c) in a.iter().zip(b).zip(c) {
        // Planes across an axis reflect without rounding.
        assert_eq!(a.x, -b.x);
        assert_eq!((a.y, a.z), (b.y, b.z));
        assert_eq!(c.x, 0.0);
        largest = largest.max(c.distance(*a));
    }
    assert!(points.iter().zip(&a).any(|(point, a)| point.distance(*a) > 0.1));
    assert!(points.iter().zip(&a).all(|(point, a)| (point.x > 0.0) == (a.x > 0.0)));
}

#[test]
fn a_core_across_the_plane_moves_once_and_rigidly() {
    // Along the plane, turning about its normal, and off center: its image overlaps it in part.
    let tool = Tool::new(Arc::new(Sphere::new(0.3).unwrap()), 0.3, Profile::Quintic).unwrap();
    let along = |x: f64| {
        let end = Pose { rotation: rotation_from_vector(DVec3::X * 0.4), translation: DVec3::new(x, 0.5, 0.3) };
        Stroke::Move(Move::new(Arc::new(tool.clone()), vec![Pose::at(DVec3::new(x, 0.0, 0.0)), end], 0.1).unwrap())
    };
    let mask = mirrored(vec![plane([0.0; 3], [1.0, 0.0, 0.0])]);
    for x in [0.0, 0.1, 0.25, -0.29] {
        let Stroke::Move(motion) = along(x) else { unreachable!() };
        let plain = motion.fields()[0].at(0.0);
        let symmetric = instant_at(&along(x), &mask, 0.0);
        for point in scattered_points(200, 0.17).into_iter().map(|point| point + DVec3::X * x) {
            let expected = plain.velocity(point);
            // Rounding of a dozen operations on numbers near one.
            assert!(symmetric.velocity(point).distance(expected) < 1e-14, "{x} {point}");
        }
    }
    // Far from the plane nothing changes at all.
    let Stroke::Move(motion) = along(0.7) else { unreachable!() };
    let (plain, symmetric) = (motion.fields()[0].at(0.0), instant_at(&along(0.7), &mask, 0.0));
    for point in scattered_points(100, 0.6).into_iter().map(|point| point + DVec3::X * 0.7) {
        if point.x > 0.0 {
            assert_eq!(symmetric.velocity(point), plain.velocity(point));
        }
    }
}

fn instant_at(stroke: &Stroke, mask: &Arc<Mask>, time: f64) -> Box<dyn Field> {
    match stroke.masked(mask, BOUNDS, 0.1).unwrap() {
        Stroke::Field(fields) => fields.fields().next().unwrap().at(time),
        other => panic!("{other:?} is not masked"),
    }
}

#[test]
fn pins_hold_on_both_sides_of_a_mirror() {
    let mask = Mask::new(vec![pin([0.3, 0.0, 0.0], 0.1, 0.2)], None, vec![plane([0.0; 3], [1.0, 0.0, 0.0])]).unwrap();
    let field = instant(&ball([0.3, 0.0, -0.1], [0.3, 0.0, 0.1], 0.1), &Arc::new(mask));
    for x in [0.3, -0.3] {
        assert_eq!(field.velocity(DVec3::new(x, 0.05, 0.0)), DVec3::ZERO);
        assert!(field.velocity(DVec3::new(x, 0.45, 0.0)).length() > 0.01);
    }
}

#[test]
fn a_mask_is_zero_where_it_holds_and_one_far_away() {
    let sphere = primitives::icosphere(1.0, 4);
    let weights = cap_weights(&sphere, 0.6);
    let mask = VertexMask::new(&sphere, &weights, None).unwrap();
    let edge = sphere.edge_lengths().unwrap().mean;
    for (position, weight) in sphere.positions.iter().zip(&weights) {
        let factor = mask.factor(*position);
        if *weight == 1.0 {
            assert_eq!((factor.value, factor.gradient), (0.0, DVec3::ZERO));
        } else if libm::acos(position.z) - libm::acos(0.6) > 5.6 * edge {
            // Growth by 1.75 radii of two edges, and one radius more; arcs are a little longer than chords.
            assert_eq!(factor.value, 1.0);
        }
    }
    for corners in &sphere.triangles {
        if corners.iter().all(|&vertex| weights[vertex as usize] == 1.0) {
            let middle = corners.iter().map(|&vertex| sphere.positions[vertex as usize]).sum::<DVec3>() / 3.0;
            assert_eq!((mask.factor(middle).value, mask.factor(middle).gradient), (0.0, DVec3::ZERO));
        }
    }
    assert_eq!(mask.factor(DVec3::Z * (1.0 + 2.1 * edge)).value, 1.0);
    let half = VertexMask::new(&sphere, &vec![0.5; sphere.positions.len()], None).unwrap();
    // An average of equal weights, rounded.
    assert!((half.factor(sphere.positions[7]).value - 0.5).abs() < 1e-15);
}

#[test]
fn large_triangles_hold_between_their_vertices() {
    let cube = primitives::box_mesh(DVec3::ONE, [1, 1, 1]);
    let weights: Vec<f64> = cube.positions.iter().map(|position| if position.z > 0.0 { 1.0 } else { 0.0 }).collect();
    let mask = VertexMask::new(&cube, &weights, Some(0.2)).unwrap();
    for point in scattered_points(200, 1.0) {
        let top = DVec3::new(point.x, point.y, 1.0);
        assert_eq!((mask.factor(top).value, mask.factor(top).gradient), (0.0, DVec3::ZERO), "{top}");
        // The walls hold less and less towards the floor, and reach as far as the weights have grown and one radius more.
        let floor = DVec3::new(0.7 * point.x, 0.7 * point.y, -1.0);
        assert_eq!(mask.factor(floor).value, 1.0);
        let wall = mask.factor(DVec3::new(1.0, 0.7 * point.y, 0.5 * point.z)).value;
        assert!((wall - (0.5 - 0.25 * point.z)).abs() < 0.5 * 0.275, "{wall} {point}");
    }
}

#[test]
fn held_vertices_keep_their_bits_and_the_volume_stays() {
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
fn a_pin_smaller_than_the_triangles_is_not_missed() {
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

#[test]
fn motions_that_their_mirror_images_undo_are_refused() {
    let across = mirrored(vec![plane([0.0; 3], [0.0, 0.0, 1.0])]);
    let along = mirrored(vec![plane([0.0; 3], [1.0, 0.0, 0.0])]);
    let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap());
    let bend = Stroke::Bend(Bend::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap());
    let undone =
        |stroke: &Stroke, mask| stroke.masked(mask, BOUNDS, 0.1).err() == Some(crate::StrokeError::UndoneByMirror);
    assert!(undone(&twist, &across) && undone(&twist, &along) && undone(&bend, &along));
    let plain = advect_points(&[DVec3::ONE], std::slice::from_ref(&bend), &NoProgress).unwrap();
    let same = advect_points(&[DVec3::ONE], &[bend.masked(&across, BOUNDS, 0.01).unwrap()], &NoProgress).unwrap();
    // Order four: 0.01⁴ times derivatives of the order of the third power of the rate, three.
    assert!(plain[0].distance(same[0]) < 1e-6);
}

#[test]
fn masks_that_cannot_be_are_refused() {
    let slanted = vec![plane([0.0; 3], [1.0, 0.0, 0.0]), plane([0.0; 3], [1.0, 1.0, 0.0])];
    let error = Mask::new(Vec::new(), None, slanted).unwrap_err();
    assert_eq!(error, MaskError::NotPerpendicular { first: 0, second: 1 });
    assert_eq!(Pin::new(DVec3::ZERO, -1.0, 1.0), Err(MaskError::Radius(-1.0)));
    assert_eq!(Pin::new(DVec3::ZERO, 0.0, 0.0), Err(MaskError::Support(0.0)));
    assert!(Pin::new(DVec3::NAN, 0.0, 1.0).is_err());
    assert_eq!(MirrorPlane::new(DVec3::ZERO, DVec3::ZERO), Err(MaskError::ZeroNormal));
    assert!(MirrorPlane::new(DVec3::ZERO, DVec3::X * 1e-300).is_ok());
    let sphere = primitives::icosphere(1.0, 0);
    let refused = |weights: &[f64], fade| VertexMask::new(&sphere, weights, fade).unwrap_err();
    assert_eq!(refused(&[1.0; 11], None), MaskError::WeightCount { found: 11, expected: 12 });
    let mut weights = [0.0; 12];
    weights[7] = 1.5;
    assert_eq!(refused(&weights, None), MaskError::Weight { vertex: 7, weight: 1.5 });
    assert_eq!(refused(&[1.0; 12], Some(0.0)), MaskError::Fade(0.0));
    assert!(matches!(refused(&[1.0; 12], Some(1e-9)), MaskError::TooManySamples { .. }));
    let points = TriMesh::new(vec![DVec3::ZERO], Vec::new());
    assert_eq!(VertexMask::new(&points, &[1.0], None).unwrap_err(), MaskError::NoEdges);
    assert!(VertexMask::new(&points, &[1.0], Some(0.1)).is_ok());
}
