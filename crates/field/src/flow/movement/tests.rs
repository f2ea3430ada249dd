use isochore_mesh::{
    Capsule, Distance, DistanceField, DistanceFieldOptions, NoProgress, Padding, RoundedBox, Sphere, primitives,
};

use super::*;
use super::{advected_points::State, segment::BATCH};
use crate::{
    fields::{BodyTwist, Profile, RigidField, VelocityBlock, rotation_from_vector},
    flow::rk4::Rk4Block,
};

fn tool(distance: impl Distance + 'static, support: f64, profile: Profile) -> Arc<Tool> {
    Arc::new(Tool::new(Arc::new(distance), support, profile).unwrap())
}

fn sphere(profile: Profile) -> Arc<Tool> {
    tool(Sphere::new(0.4).unwrap(), 0.3, profile)
}

fn advected(stroke: &Move, point: DVec3) -> DVec3 {
    let mut points = [point];
    stroke.advect_chunk(&mut points);
    points[0]
}

/// The golden press: the center moves down from (0, 0, 1.8) by one.
fn press(profile: Profile, step: f64) -> Move {
    Move::new(sphere(profile), vec![Pose::at(DVec3::Z * 1.8), Pose::at(DVec3::Z * 0.8)], step).unwrap()
}

const STARTS: [[f64; 3]; 5] = [[0.0, 0.0, 1.0], [0.1, 0.0, 1.0], [0.3, 0.2, 0.9], [0.6, 0.0, 0.75], [0.0, 0.55, 0.7]];

/// `steps` per unit of length; the golden values are the limit of many small steps.
fn check_press(profile: Profile, steps: usize, tolerance: f64, golden: [[f64; 3]; 5]) {
    let stroke = press(profile, 1.0 / (steps as f64 * 0.3));
    assert!((stroke.steps() as i64 - steps as i64).abs() <= 1);
    for (start, golden) in STARTS.into_iter().zip(golden) {
        let error = advected(&stroke, start.into()).distance(golden.into());
        assert!(error < tolerance, "{profile} from {start:?}: {error:.1e}");
    }
}

#[test]
fn golden_press_septic() {
    check_press(
        Profile::Septic,
        4000,
        1e-9,
        [
            [0.0, 0.0, 0.340450495665769],
            [0.438733019317737, 0.0, 0.636027733463904],
            [0.300000000000002, 0.200000000000002, 1.409507155432517],
            [0.618819267867424, 0.0, 0.910686665781336],
            [0.0, 0.588892723637586, 0.957576162356393],
        ],
    );
}

#[test]
fn golden_press_quintic() {
    check_press(
        Profile::Quintic,
        4000,
        1e-9,
        [
            [0.0, 0.0, 0.349215658260209],
            [0.418975665696633, 0.0, 0.611014832438002],
            [0.301106710973589, 0.200737807315726, 1.365740581482758],
            [0.621606404278274, 0.0, 0.935150404314259],
            [0.0, 0.593962096982274, 0.958722117843676],
        ],
    );
}

#[test]
fn golden_press_of_the_true_von_funck_profile() {
    check_press(
        Profile::QuarticSquared,
        4000,
        1e-9,
        [
            [0.0, 0.0, 0.348392911884106],
            [0.425996474563533, 0.0, 0.624909439071520],
            [0.300004189992417, 0.200002793328277, 1.389370088162428],
            [0.618969049968295, 0.0, 0.905361745221205],
            [0.0, 0.589903666736769, 0.946204083701045],
        ],
    );
}

/// The slope of this profile jumps on the surface, which reduces the order of the integrator: eight
/// digits take 20,000 steps.
#[test]
fn golden_press_quad() {
    check_press(
        Profile::Quad,
        20_000,
        1e-8,
        [
            [0.0, 0.0, 0.398516426106019],
            [0.400301871378273, 0.0, 0.886360897415470],
            [0.342795336749010, 0.228530224499339, 1.171648183909237],
            [0.620874318134147, 0.0, 0.849741180049785],
            [0.0, 0.590404407068156, 0.824857279144636],
        ],
    );
}

/// A rod whose velocity and angular velocity are constant in the world. No constant body twist has this
/// motion, so the test integrates the field of each instant in the world.
#[test]
fn golden_rod() {
    let rod = tool(Capsule::new(0.15, 0.8).unwrap(), 0.25, Profile::Septic);
    let (velocity, angular) = (DVec3::new(0.2, 0.1, -0.3), DVec3::new(0.0, 1.2, 0.5));
    let at = |time: f64, world: DVec3| {
        let rotation = rotation_from_vector(angular * time);
        let center = DVec3::new(0.5, 0.0, 0.0) + velocity * time;
        let back = rotation.conjugate();
        let twist = BodyTwist { linear: back * velocity, angular: back * angular };
        rotation * RigidField::new(&rod, twist).velocity(back * (world - center))
    };
    let golden = [
        ([0.7, 0.1, 0.3], [1.400194732623605, 0.493861282604447, -0.040874994146885]),
        ([0.5, 0.3, 0.5], [0.419026679680990, 0.255357738508956, 0.482514574517241]),
        ([0.3, -0.25, -0.4], [0.214099994821595, -0.218298740353516, -0.292032723107810]),
        ([0.5, 0.05, 0.2], [0.859357699895921, 0.196594009421809, -0.211825622612342]),
    ];
    let steps = 4000;
    let h = 1.0 / f64::from(steps);
    for (start, end) in golden {
        let mut point = DVec3::from(start);
        for step in 0..steps {
            let time = f64::from(step) * h;
            let k1 = at(time, point);
            let k2 = at(time + 0.5 * h, point + 0.5 * h * k1);
            let k3 = at(time + 0.5 * h, point + 0.5 * h * k2);
            let k4 = at(time + h, point + h * k3);
            point += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        }
        let error = point.distance(end.into());
        assert!(error < 1e-9, "{start:?}: {error:.1e}");
    }
}

#[test]
fn the_core_moves_rigidly() {
    let keys = vec![
        Pose { rotation: rotation_from_vector(DVec3::new(0.2, 0.1, 0.0)), translation: DVec3::new(0.5, 0.0, 0.0) },
        Pose { rotation: rotation_from_vector(DVec3::new(0.0, 1.9, 0.8)), translation: DVec3::new(1.1, -0.7, 0.4) },
    ];
    for profile in [Profile::Quintic, Profile::Septic, Profile::Quartic] {
        let rod = tool(Capsule::new(0.15, 0.8).unwrap(), 0.25, profile);
        let stroke = Move::new(rod, keys.clone(), 0.125).unwrap();
        for local in [DVec3::new(0.0, 0.05, 0.2), DVec3::new(0.1, 0.0, -0.8), DVec3::new(0.03, 0.04, 0.93)] {
            let arrived = advected(&stroke, keys[0].transform(local));
            assert!(arrived.distance(keys[1].transform(local)) < 1e-12, "{profile} at {local}");
        }
    }
}

#[test]
fn runge_kutta_converges_with_order_four() {
    let reference = advected(&press(Profile::Septic, 1.0 / 512.0), DVec3::new(0.6, 0.0, 0.75));
    let error = |step: f64| advected(&press(Profile::Septic, step), DVec3::new(0.6, 0.0, 0.75)).distance(reference);
    let order = libm::log2(error(1.0 / 16.0) / error(1.0 / 32.0));
    // The asymptotic range begins near R/16. The reference has a 16 times finer step than the finest, so
    // its error is 1e-5 of that one.
    assert!((3.7..4.5).contains(&order), "{order}");
}

#[test]
fn press_and_lift_return() {
    let (up, down) = (Pose::at(DVec3::Z * 1.75), Pose::at(DVec3::Z * 1.25));
    let stroke = Move::new(sphere(Profile::Quintic), vec![up, down, up], 0.125).unwrap();
    for index in 0..400 {
        let t = f64::from(index);
        let height = 1.0 - 2.0 * (t + 0.5) / 400.0;
        let ring = (1.0 - height * height).sqrt();
        let point = DVec3::new(ring * libm::cos(2.4 * t), ring * libm::sin(2.4 * t), height);
        assert!(advected(&stroke, point).distance(point) < 1e-4 * 0.3, "{point}");
    }
}

#[test]
fn sleep_changes_no_bits() {
    let half_extents = DVec3::new(0.5, 0.1, 0.2);
    check_sleep_around(tool(RoundedBox::new(half_extents, 0.05).unwrap(), 0.2, Profile::Quintic));
    let mesh = primitives::box_mesh(half_extents, [1, 1, 1]);
    let options = DistanceFieldOptions { resolution: 32, padding: Padding::Reach(0.2), ..Default::default() };
    let sampled = DistanceField::new(&mesh, &options, &NoProgress).unwrap();
    check_sleep_around(tool(sampled, 0.2, Profile::Quintic));
}

/// Points around a tool that turns and travels, advected with sleep, and with a test of every point at
/// every step.
fn check_sleep_around(bar: Arc<Tool>) {
    let keys = vec![
        Pose { rotation: rotation_from_vector(DVec3::new(0.3, 0.0, 0.0)), translation: DVec3::new(-1.0, 0.2, 0.0) },
        Pose { rotation: rotation_from_vector(DVec3::new(0.3, 1.5, 0.9)), translation: DVec3::new(0.6, 0.0, 0.3) },
    ];
    let stroke = Move::new(bar, keys, 0.2).unwrap();
    let points: Vec<DVec3> = (0..3000)
        .map(|index| {
            let t = f64::from(index);
            1.5 * DVec3::new(libm::sin(1.1 * t), libm::sin(1.7 * t + 1.0), libm::sin(2.9 * t + 2.0))
        })
        .collect();
    let mut sleeping = points.clone();
    let evaluations = stroke.advect_chunk(&mut sleeping);

    let mut wakeful = points.clone();
    for segment in &stroke.segments {
        let field = RigidField::new(&stroke.tool, segment.twist);
        let mut advected = AdvectedPoints::new(&mut wakeful);
        let mut blocks = [Rk4Block::new(VelocityBlock::REST); BATCH];
        for step in 0..segment.steps() {
            for index in 0..advected.world.len() {
                if advected.state[index] == State::Resting {
                    advected.local[index] = segment.placements[step].to_local(advected.world[index]);
                }
                // The same step, without sleep.
                segment.step_blocks(&field, step, &[index as u32], &mut advected, &mut blocks);
            }
        }
        advected.finish(&segment.placements[segment.steps()]);
    }
    assert_eq!(sleeping, wakeful);
    let moved = points.iter().zip(&sleeping).filter(|(a, b)| a != b).count();
    assert!(moved > 50 && moved < 2500, "{moved}");
    assert!(evaluations < 4 * 3000 * stroke.steps() as u64 / 3, "{evaluations}");
}

#[test]
fn the_head_on_gap_is_the_closed_form() {
    // Straight ahead of a sphere the quadratic profile gives u/(2−u) = u₀/(2−u₀) exp(−2D/R).
    let stroke = Move::new(sphere(Profile::Quad), vec![Pose::IDENTITY, Pose::at(DVec3::Z * 0.9)], 1e-3).unwrap();
    let gap = advected(&stroke, DVec3::Z * 0.7).z - 0.9 - 0.4;
    assert!((gap / 0.3 - 0.004945246).abs() < 1e-8, "{}", gap / 0.3);
}

#[test]
fn touches_a_ball_on_the_path_only() {
    let stroke = press(Profile::Quintic, 0.125);
    assert!(!stroke.may_touch(DVec3::new(0.0, 0.0, -1.0), 0.5));
    assert!(!stroke.may_touch(DVec3::new(2.0, 0.0, 1.2), 1.0));
    assert!(stroke.may_touch(DVec3::new(2.0, 0.0, 1.2), 1.4));
    assert!(stroke.may_touch(DVec3::new(0.0, 0.0, 0.0), 0.2));
}

#[test]
fn a_truncated_stroke_ends_on_its_path() {
    let stroke = press(Profile::Quintic, 0.125);
    let inside = DVec3::new(0.1, 0.0, 1.7);
    assert!(advected(&stroke.truncated(0.5), inside).distance(inside - DVec3::Z * 0.5) < 1e-14);
    assert_eq!(advected(&stroke.truncated(0.0), inside), inside);
}

#[test]
fn a_pause_moves_nothing() {
    let pose =
        Pose { rotation: rotation_from_vector(DVec3::new(0.3, 0.7, -0.2)), translation: DVec3::new(0.1, 0.2, 0.3) };
    let stroke = Move::new(sphere(Profile::Quintic), vec![pose, pose], 0.125).unwrap();
    for point in [DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.7, 0.3, 0.2), DVec3::new(3.0, 0.0, 0.0)] {
        assert_eq!(advected(&stroke, point), point);
    }
}

#[test]
fn rejects_invalid_paths() {
    let turn = Pose { rotation: rotation_from_vector(DVec3::Z * std::f64::consts::PI), translation: DVec3::ZERO };
    let error = |keys: Vec<Pose>, step: f64| Move::new(sphere(Profile::Quintic), keys, step).unwrap_err();
    assert_eq!(error(vec![Pose::IDENTITY], 0.125), MoveError::TooFewKeys(1));
    assert_eq!(error(vec![Pose::IDENTITY, turn], 0.125), MoveError::HalfTurn { key: 0 });
    assert_eq!(error(vec![Pose::IDENTITY; 2], -1.0), MoveError::Step(-1.0));
    assert!(matches!(
        error(vec![Pose::IDENTITY, Pose::at(DVec3::X * 1e9)], 1e-6),
        MoveError::TooManySteps { key: 0, .. }
    ));
    assert_eq!(error(vec![Pose::IDENTITY, Pose::at(DVec3::NAN)], 0.125), MoveError::NotFinite);
}

#[test]
fn nothing_moves_beyond_the_reach_and_advection_in_place_has_the_same_bits() {
    let tool = tool(RoundedBox::new(DVec3::new(0.4, 0.2, 0.1), 0.05).unwrap(), 0.3, Profile::Quintic);
    let turned =
        Pose { rotation: rotation_from_vector(DVec3::new(0.3, 1.9, 0.4)), translation: DVec3::new(0.9, 0.2, 0.1) };
    let stroke = Move::new(tool, vec![Pose::IDENTITY, turned], 0.25).unwrap();
    let reach = stroke.reach();
    let stroke = crate::flow::Stroke::Move(stroke);
    let grid =
        (0..24_usize.pow(3)).map(|i| DVec3::new((i % 24) as f64, (i / 24 % 24) as f64, (i / 576) as f64) * 0.11 - 0.9);
    let rest: Vec<DVec3> = grid.collect();
    let mut images = rest.clone();
    stroke.advect(&mut images);
    assert_eq!(
        crate::flow::advect_points(&rest, std::slice::from_ref(&stroke), &isochore_mesh::NoProgress).unwrap(),
        images
    );
    let (mut inside, mut outside) = (0, 0);
    for (rest, image) in rest.iter().zip(&images) {
        if rest != image {
            assert_eq!(reach.distance(*rest), 0.0, "{rest}");
            inside += 1;
        }
        outside += usize::from(reach.distance(*rest) > 0.0);
    }
    assert!(inside > 500 && outside > 500, "{inside} {outside}");
    // Both consist of the same two segments, so the field in world coordinates has the same reach.
    let mask =
        crate::fields::Mask::new(vec![crate::fields::Pin::new(DVec3::X, 0.1, 0.1).unwrap()], None, vec![]).unwrap();
    let masked = stroke.masked(&Arc::new(mask), Aabb::of(rest.iter().copied()), 0.25).unwrap();
    let mut images = rest.clone();
    masked.advect(&mut images);
    assert!(rest.iter().zip(&images).all(|(rest, image)| rest == image || masked.reach().distance(*rest) == 0.0));
}
