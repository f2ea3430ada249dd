use isochore_mesh::{Capsule, NoProgress, Sphere};

use super::*;
use crate::{
    fields::{
        Field, Pose, Profile, Tool,
        field::{
            finite_differences::{deviation, scattered_points},
            flux::{QUADRATURE_NOISE, worst_field_flux},
        },
        mask::tests::{mirrored, painted, pin, pinned, plane},
        rotation_from_vector,
    },
    flow::{Move, advect_points, advection::bits},
};

/// The box of the points that twists and bends advect in these tests.
pub(crate) const BOUNDS: Aabb = Aabb { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };

/// A ball of radius 0.3 and support 0.3 that moves between two positions.
pub(crate) fn ball(from: [f64; 3], to: [f64; 3], step: f64) -> Stroke {
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

/// The first field of a masked stroke, halfway through its time.
pub(crate) fn instant(stroke: &Stroke, mask: &Arc<Mask>) -> Box<dyn Field> {
    match stroke.masked(mask, BOUNDS, 0.1).unwrap() {
        Stroke::Field(fields) => fields.fields().next().unwrap().at(0.5),
        other => panic!("{other:?} is not masked"),
    }
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
            // Truncation: h²/6 = 2e-9 times third derivatives. Those of a quintic over 0.3 are of the order
            // of 60/R³ = 2e3, and those of a product of two ten times that. Those of the kernel average
            // over 0.4 are smaller.
            assert!(
                seen.curl < 2e-4 && seen.divergence < 5e-4 && seen.gradient < 2e-4,
                "{stroke_name} with {mask_name}: {seen:?}"
            );
            let flux = worst_field_flux(&*field, |_| f64::INFINITY, 0.6);
            assert!(flux < QUADRATURE_NOISE, "{stroke_name} with {mask_name}: {flux:e}");
        }
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
    let images = advect_points(&[&points[..], &[free]].concat(), &strokes, &NoProgress).unwrap();
    for (point, image) in points.iter().zip(&images) {
        assert_eq!(bits(*point), bits(*image));
    }
    assert!(images[points.len()].distance(free) > 0.1);
}

#[test]
fn points_beyond_the_mask_flow_as_without_it() {
    let far = pinned(vec![pin([3.0, 0.0, 0.0], 0.1, 0.1)]);
    let stroke = rod(0.1);
    let Stroke::Move(motion) = &stroke else { unreachable!() };
    let plain = Stroke::Field(FieldStroke::new(motion.fields(), 0.1).unwrap());
    let masked = stroke.masked(&far, BOUNDS, 0.1).unwrap();
    let points = scattered_points(200, 1.0);
    // The far pin is a third as wide as the support, so the steps are finer. The flow is the same up to
    // their error of order four.
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
            let images = advect_points(&points, &[masked], &NoProgress).unwrap();
            images.iter().zip(&exact).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
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
        // Reflection about a plane across an axis has no rounding.
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
    // The tool moves along the plane and turns about its normal, off center, so its image overlaps it
    // partly.
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
fn rejects_motions_that_their_mirror_images_undo() {
    let across = mirrored(vec![plane([0.0; 3], [0.0, 0.0, 1.0])]);
    let along = mirrored(vec![plane([0.0; 3], [1.0, 0.0, 0.0])]);
    let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap());
    let bend = Stroke::Bend(Bend::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap());
    let undone = |stroke: &Stroke, mask| stroke.masked(mask, BOUNDS, 0.1).err() == Some(MaskedError::UndoneByMirror);
    assert!(undone(&twist, &across) && undone(&twist, &along) && undone(&bend, &along));
    let plain = advect_points(&[DVec3::ONE], std::slice::from_ref(&bend), &NoProgress).unwrap();
    let same = advect_points(&[DVec3::ONE], &[bend.masked(&across, BOUNDS, 0.01).unwrap()], &NoProgress).unwrap();
    // Order four: 0.01⁴ times derivatives of the order of the third power of the rate, three.
    assert!(plain[0].distance(same[0]) < 1e-6);
}
