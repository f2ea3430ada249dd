mod jointed;
mod strip;

use isochore_mesh::{Capsule, Sphere};

use super::*;
use crate::{
    fields::{
        Pose, Profile, Tool, WeightedPotential,
        field::{
            finite_differences::{deviation, scattered_points},
            flux::{QUADRATURE_NOISE, worst_field_flux},
        },
        rotation_from_vector,
    },
    flow::{Move, Stroke},
};

fn pose(turn: [f64; 3], translation: [f64; 3]) -> Pose {
    Pose { rotation: rotation_from_vector(turn.into()), translation: translation.into() }
}

/// A rod that moves along two screws, and the same motion as fields in the world.
fn rod(step: f64) -> (Move, FieldStroke) {
    let tool = Tool::new(Arc::new(Capsule::new(0.15, 0.6).unwrap()), 0.25, Profile::Quintic).unwrap();
    let keys = vec![
        pose([0.0; 3], [-0.9, 0.1, 0.0]),
        pose([0.0, 0.9, 0.2], [-0.1, 0.2, 0.1]),
        pose([0.4, 0.9, 0.2], [0.5, 0.0, 0.3]),
    ];
    let motion = Move::new(Arc::new(tool), keys, step).unwrap();
    let fields = FieldStroke::new(motion.fields(), step).unwrap();
    (motion, fields)
}

fn largest_distance(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
}

#[test]
fn world_and_tool_coordinates_converge_to_the_same_flow() {
    let points = scattered_points(200, 1.0);
    let difference = |step: f64| {
        let (motion, fields) = rod(step);
        let (mut a, mut b) = (points.clone(), points.clone());
        motion.advect_chunk(&mut a);
        fields.advect_chunk(&mut b);
        assert!(largest_distance(&a, &points) > 0.3);
        largest_distance(&a, &b)
    };
    let [coarse, fine] = [0.1, 0.05].map(difference);
    // Both are of order four, so half the step leaves a sixteenth of the error. The third derivatives of
    // a quintic jump, which costs a part of that.
    assert!(fine < coarse / 9.0 && fine < 1e-5, "{coarse:e} {fine:e}");
}

#[test]
fn the_core_moves_rigidly() {
    let (motion, fields) = rod(0.125);
    let mut points = [DVec3::new(-0.85, 0.15, 0.4)];
    let mut expected = points;
    fields.advect_chunk(&mut points);
    motion.advect_chunk(&mut expected);
    // Both move a core point in closed form, so only the rounding of some dozens of steps differs.
    assert!(points[0].distance(expected[0]) < 1e-14, "{points:?} {expected:?}");
}

#[test]
fn sleep_changes_no_bits() {
    let (_, fields) = rod(0.1);
    let mut restless = fields.clone();
    restless.legs.iter_mut().for_each(|leg| leg.approach_speed = f64::INFINITY);
    let points = scattered_points(500, 1.2);
    let (mut a, mut b) = (points.clone(), points.clone());
    let evaluations = fields.advect_chunk(&mut a);
    let all = restless.advect_chunk(&mut b);
    assert_eq!(a, b);
    assert!(evaluations < all / 2, "{evaluations} of {all}");
    let unmoved = a.iter().zip(&points).filter(|(a, b)| a == b).count();
    assert!(unmoved > 100 && unmoved < 450, "{unmoved}");
}

#[test]
fn untouchable_points_do_not_move() {
    let (_, fields) = rod(0.1);
    let points = scattered_points(500, 1.2);
    let mut moved = points.clone();
    fields.advect_chunk(&mut moved);
    let mut untouchable = 0;
    for (point, moved) in points.iter().zip(moved) {
        if !fields.may_touch(*point, 0.0) {
            assert_eq!(*point, moved);
            untouchable += 1;
        }
    }
    assert!(untouchable > 100, "{untouchable}");
}

#[test]
fn a_truncated_stroke_is_the_start_of_the_stroke() {
    let (motion, fields) = rod(0.02);
    let points = scattered_points(100, 1.0);
    for fraction in [0.0, 0.3, 0.5, 0.8] {
        let (mut a, mut b) = (points.clone(), points.clone());
        motion.truncated(fraction).advect_chunk(&mut a);
        fields.truncated(fraction).advect_chunk(&mut b);
        // Both differ from the exact flow by less than 1e-6 at this step.
        assert!(largest_distance(&a, &b) < 1e-6, "{fraction}");
    }
}

#[test]
fn a_moving_tool_is_a_divergence_free_field() {
    let (_, fields) = rod(0.1);
    let field = &*fields.legs[1].instants[1].field;
    let seen = deviation(field, &scattered_points(200, 0.8), 1e-4);
    // Truncation: h²/6 of derivatives of the quintic over a support of 0.25, of the order of 60/R³ and 360/R⁴.
    assert!(seen.curl < 1e-4 && seen.divergence < 1e-4 && seen.gradient < 1e-4, "{seen:?}");
    assert!(worst_field_flux(field, |_| f64::INFINITY, 0.5) < QUADRATURE_NOISE);
}

#[test]
fn rejects_invalid_strokes() {
    assert_eq!(FieldStroke::new(Vec::new(), 0.1).unwrap_err(), FieldStrokeError::NoField);
    let tool = Tool::new(Arc::new(Sphere::new(0.1).unwrap()), 0.1, Profile::Quintic).unwrap();
    let motion = Move::new(Arc::new(tool), vec![Pose::IDENTITY, Pose::at(DVec3::X)], 1.0).unwrap();
    assert_eq!(FieldStroke::new(motion.fields(), 0.0).unwrap_err(), FieldStrokeError::Step(0.0));
    assert!(matches!(
        FieldStroke::new(motion.fields(), 1e-9).unwrap_err(),
        FieldStrokeError::TooManySteps { field: 0, .. }
    ));
}

/// A ball that swells, shrinks and swings to and fro: the edge of its support has another speed at every instant.
#[derive(Debug)]
struct Pulse;

#[derive(Debug)]
struct PulseInstant {
    center: DVec3,
    radius: f64,
}

impl MovingField for Pulse {
    fn at(&self, time: f64) -> Box<dyn Field> {
        let phase = 6.0 * time;
        let center = DVec3::new(0.5 * libm::sin(phase), 0.3 * time * time, 0.0);
        Box::new(PulseInstant { center, radius: 0.3 + 0.2 * libm::sin(2.0 * phase) })
    }

    /// |d center/dt| + |d radius/dt|: at most 3 across, 0.6 along, and 2.4.
    fn approach_speed(&self) -> f64 {
        DVec3::new(3.0, 0.6, 0.0).length() + 2.4
    }

    fn core_speed(&self) -> f64 {
        1.0
    }

    fn feature_size(&self) -> f64 {
        0.3
    }
}

impl Field for PulseInstant {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        for lane in 0..LANES {
            let arm = points.get(lane) - self.center;
            let beyond = arm.length() - self.radius;
            if beyond >= 0.0 {
                out.set_outside(lane, beyond);
                continue;
            }
            let (weight, slope) = Profile::Quintic.evaluate(arm.length() / self.radius);
            let gradient = slope / self.radius * arm.normalize_or_zero();
            let potential = 0.5 * DVec3::Z.cross(arm);
            out.set_inside(lane, WeightedPotential { weight, gradient, potential, curl: DVec3::Z }, NO_CORE);
        }
    }

    fn bounds(&self) -> isochore_mesh::Aabb {
        isochore_mesh::Aabb::of([self.center]).expanded(self.radius)
    }
}

#[test]
fn sleep_is_valid_if_the_support_changes_with_time() {
    let fields = FieldStroke::new(vec![Arc::new(Pulse)], 0.02).unwrap();
    let mut restless = fields.clone();
    restless.legs.iter_mut().for_each(|leg| leg.approach_speed = f64::INFINITY);
    let points = scattered_points(2000, 1.3);
    let (mut slept, mut awake) = (points.clone(), points.clone());
    let evaluations = fields.advect_chunk(&mut slept);
    let all = restless.advect_chunk(&mut awake);
    assert_eq!(slept, awake);
    assert!(evaluations < all, "{evaluations} of {all}");
    let untouchable = points.iter().zip(&slept).filter(|(point, _)| !fields.may_touch(**point, 0.0));
    assert!(untouchable.clone().count() > 500);
    assert!(untouchable.into_iter().all(|(point, moved)| point == moved));
    assert!(slept.iter().zip(&points).filter(|(a, b)| a != b).count() > 100);
    // With a tenth of the true speed, points sleep while the support passes, so the test can fail.
    let mut careless = fields.clone();
    careless.legs.iter_mut().for_each(|leg| leg.approach_speed *= 0.1);
    let mut missed = points.clone();
    careless.advect_chunk(&mut missed);
    assert_ne!(missed, awake);
}
