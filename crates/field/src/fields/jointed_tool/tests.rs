use isochore_mesh::{Capsule, Ellipsoid, PointBlock};

use super::*;
use crate::fields::{
    BodyTwist, Field, FieldBlock, MovingTool,
    field::{
        finite_differences::{deviation, scattered_points},
        flux::{QUADRATURE_NOISE, worst_field_flux},
    },
    rotation_from_vector,
};

pub(crate) const RADIUS: f64 = 0.15;
const SUPPORT: f64 = 0.25;

fn capsule(half_length: f64, profile: Profile) -> Arc<Tool> {
    Arc::new(Tool::new(Arc::new(Capsule::new(RADIUS, half_length).unwrap()), SUPPORT, profile).unwrap())
}

/// A finger of two bones along z, with the joint at the origin.
pub(crate) fn finger() -> Arc<JointedTool> {
    let tool = capsule(0.25, Profile::Quintic);
    let bone = |z: f64, parent: Option<usize>| Bone {
        tool: Arc::clone(&tool),
        rest: Pose::at(DVec3::new(0.0, 0.0, z)),
        joint: DVec3::new(0.0, 0.0, if parent.is_none() { -0.5 } else { 0.0 }),
        parent,
    };
    Arc::new(JointedTool::new(vec![bone(-0.25, None), bone(0.25, Some(0))]).unwrap())
}

/// A palm with two parallel fingers; the bones are not in tree order.
pub(crate) fn hand() -> Arc<JointedTool> {
    let palm = Ellipsoid::new(DVec3::new(0.4, 0.3, 0.15)).unwrap();
    let palm = Arc::new(Tool::new(Arc::new(palm), 0.3, Profile::Quintic).unwrap());
    let finger = Arc::new(Tool::new(Arc::new(Capsule::new(0.1, 0.25).unwrap()), 0.2, Profile::Quintic).unwrap());
    let along_y = rotation_from_vector(DVec3::new(-std::f64::consts::FRAC_PI_2, 0.0, 0.0));
    let phalanx = |x: f64, y: f64, parent: usize| Bone {
        tool: Arc::clone(&finger),
        rest: Pose { rotation: along_y, translation: DVec3::new(x, y + 0.25, 0.0) },
        joint: DVec3::new(x, y, 0.0),
        parent: Some(parent),
    };
    let bones = vec![
        phalanx(-0.13, 0.78, 1),
        phalanx(-0.13, 0.28, 3),
        phalanx(0.13, 0.78, 4),
        Bone { tool: palm, rest: Pose::IDENTITY, joint: DVec3::ZERO, parent: None },
        phalanx(0.13, 0.28, 3),
    ];
    Arc::new(JointedTool::new(bones).unwrap())
}

pub(crate) fn posture(root: Pose, turns: &[[f64; 3]]) -> Posture {
    Posture { root, turns: turns.iter().map(|&turn| rotation_from_vector(turn.into())).collect() }
}

pub(crate) fn root() -> Pose {
    Pose { rotation: rotation_from_vector(DVec3::new(0.2, -0.3, 0.4)), translation: DVec3::new(0.1, 0.2, -0.1) }
}

/// A finger that bends while the whole moves, and a hand that closes while the whole moves.
pub(crate) fn motions() -> [(Arc<JointedTool>, Vec<Posture>); 2] {
    let closed = [[0.7, 0.0, 0.1], [0.8, 0.1, 0.0], [0.9, 0.0, 0.0], [0.1, 0.2, 0.0], [0.6, 0.0, -0.1]];
    [
        (
            finger(),
            vec![
                posture(Pose::IDENTITY, &[[0.0; 3]; 2]),
                posture(root(), &[[0.0, 0.2, 0.0], [0.8, 0.0, 0.3]]),
                posture(root(), &[[0.0, 0.0, 0.5], [1.2, 0.0, 0.3]]),
            ],
        ),
        (hand(), vec![posture(Pose::IDENTITY, &[[0.0; 3]; 5]), posture(root(), &closed)]),
    ]
}

pub(crate) fn evaluate(field: &dyn Field, point: DVec3) -> FieldBlock {
    let mut block = FieldBlock::ZERO;
    field.evaluate_into(&PointBlock::splat(point), &mut block);
    block
}

/// Current world position of a point at rest, from the definition: each bone's rotation about its
/// joint, then the motion of its parent.
pub(crate) fn pose_of(tool: &JointedTool, posture: &Posture, bone: usize, point: DVec3) -> DVec3 {
    let Bone { joint, parent, .. } = tool.bones()[bone];
    let turned = joint + posture.turns[bone] * (point - joint);
    match parent {
        Some(parent) => pose_of(tool, posture, parent, turned),
        None => posture.root.transform(turned),
    }
}

/// On the surface of a bone, away from its joints, the field is exactly its own motion, even next
/// to another bone.
#[test]
fn a_finger_does_not_move_its_neighbor() {
    let (tool, keys) = &motions()[1];
    let field = tool.motions(keys).unwrap()[0].at(0.0);
    for index in 0..32 {
        let angle = 0.2 * f64::from(index);
        // The gap between the fingers is 0.06; the middle of the first phalanx is 2.5 radii from
        // its joints.
        let point = DVec3::new(0.13 + 0.0999 * libm::cos(angle), 0.53, 0.0999 * libm::sin(angle));
        assert_eq!(evaluate(&*field, point).core[0], 4, "{point}");
    }
}

#[test]
fn material_within_two_bones_moves_at_single_speed() {
    let tool = finger();
    let shift = DVec3::new(0.0, 1.0, 0.0);
    let keys = [posture(Pose::IDENTITY, &[[0.0; 3]; 2]), posture(Pose::at(shift), &[[0.0; 3]; 2])];
    let joined = tool.motions(&keys).unwrap()[0].at(0.5);
    let joint = 0.5 * shift;
    // Rounding in the sum of the parts.
    assert!((evaluate(&*joined, joint).velocity.get(0).y - 1.0).abs() < 1e-14);
    let twist = BodyTwist { linear: shift, angular: DVec3::ZERO };
    let alone = |bone: &Bone| MovingTool::new(Arc::clone(&bone.tool), bone.rest, twist).at(0.5);
    let summed: f64 = tool.bones().iter().map(|bone| evaluate(&*alone(bone), joint).velocity.get(0).y).sum();
    assert!((summed - 2.0).abs() < 1e-14);
}

#[test]
fn bones_with_equal_motion_form_one_rigid_body() {
    for (tool, _) in motions() {
        let bones = tool.bones().len();
        let still = vec![[0.0; 3]; bones];
        let keys = [posture(Pose::IDENTITY, &still), posture(root(), &still)];
        let field = tool.motions(&keys).unwrap()[0].at(0.3);
        let twist = Pose::IDENTITY.twist_to(&root()).unwrap();
        let now = Pose::IDENTITY.moved(&twist, 0.3);
        let mut inside = 0;
        for point in scattered_points(20_000, 0.9) {
            let block = evaluate(&*field, point);
            if block.weight.value[0] == 1.0 {
                let local = now.rotation.conjugate() * (point - now.translation);
                let expected = now.rotation * twist.velocity(local);
                // Rounding near 1e-16 of potentials, times gradients of the weights up to 1/ε =
                // 160.
                assert!(block.velocity.get(0).distance(expected) < 5e-13, "{point}");
                inside += 1;
            }
        }
        assert!(inside > 100, "{inside}");
    }
}

#[test]
fn a_single_bone_has_the_field_of_its_tool() {
    let tool = capsule(0.3, Profile::Contact);
    let rest =
        Pose { rotation: rotation_from_vector(DVec3::new(0.3, 0.1, 0.0)), translation: DVec3::new(0.1, 0.0, 0.2) };
    let bone = Bone { tool: Arc::clone(&tool), rest, joint: DVec3::ZERO, parent: None };
    let jointed = Arc::new(JointedTool::new(vec![bone]).unwrap());
    let keys = [posture(Pose::IDENTITY, &[[0.0; 3]]), posture(root(), &[[0.0; 3]])];
    let field = jointed.motions(&keys).unwrap()[0].at(0.0);
    let end = Pose { rotation: root().rotation * rest.rotation, translation: root().transform(rest.translation) };
    let alone = MovingTool::new(tool, rest, rest.twist_to(&end).unwrap()).at(0.0);
    for point in scattered_points(500, 0.8) {
        let [a, b] = [&*field, &*alone].map(|field| evaluate(field, point));
        // Both evaluate the same formula, one in world and one in tool axes.
        assert!(a.velocity.get(0).distance(b.velocity.get(0)) < 1e-14, "{point}");
        assert!(a.potential.get(0).distance(b.potential.get(0)) < 1e-15, "{point}");
    }
}

#[test]
fn the_field_is_the_curl_of_its_potential_and_has_no_net_flux() {
    for (tool, keys) in motions() {
        let field = tool.motions(&keys).unwrap()[0].at(0.4);
        let seen = deviation(&*field, &scattered_points(300, 0.9), 1e-5);
        // Truncation: h²/6 of third derivatives of blends as narrow as ε = 0.006 to 0.01, that is
        // 1e-10/ε³, at points inside a blend. The second derivatives of the distances jump where
        // the cap of a capsule begins.
        assert!(seen.curl < 1e-4 && seen.divergence < 1e-3 && seen.gradient < 1e-4, "{seen:?}");
        let flux = worst_field_flux(&*field, |_| f64::INFINITY, 0.5);
        assert!(flux < QUADRATURE_NOISE, "{flux:e}");
    }
}

#[test]
fn material_at_a_joint_is_hardly_faster_than_either_bone() {
    let tool = finger();
    let keys = [posture(Pose::IDENTITY, &[[0.0; 3]; 2]), posture(Pose::IDENTITY, &[[0.0; 3], [1.0, 0.0, 0.0]])];
    let field = tool.motions(&keys).unwrap()[0].at(0.0);
    let (mut fastest, mut rigid) = (0.0_f64, 0.0_f64);
    let shared = |point: &DVec3| point.length() < RADIUS;
    for point in scattered_points(20_000, RADIUS).into_iter().filter(shared) {
        fastest = fastest.max(evaluate(&*field, point).velocity.get(0).length());
        rigid = rigid.max(DVec3::X.cross(point).length());
    }
    // The ratio is 1.15: the gauge of the joint's axis adds speed where the weights change.
    assert!(fastest < 1.2 * rigid && rigid > 0.95 * RADIUS, "{fastest} {rigid}");
}

#[test]
fn speeds_stay_within_their_bounds() {
    for (tool, keys) in motions() {
        for (leg, motion) in tool.motions(&keys).unwrap().iter().enumerate() {
            for (bone, placed) in tool.bones().iter().enumerate() {
                let corner = placed.rest.transform(placed.tool.distance().bounds().max);
                let at = |time: f64| motion.at(time).core_pose(bone as u32).transform(corner);
                for index in 1..20 {
                    let time = 0.05 * f64::from(index);
                    let speed = (at(time + 1e-5) - at(time - 1e-5)).length() / 2e-5;
                    assert!(speed < motion.core_speed() * (1.0 + 1e-9), "leg {leg}, bone {bone}: {speed}");
                    assert!(motion.core_speed() < motion.approach_speed());
                }
            }
        }
    }
}

#[test]
fn rejects_bones_that_are_not_a_tree() {
    let bone = |parent| Bone { parent, ..finger().bones()[0].clone() };
    let error = |parents: &[Option<usize>]| JointedTool::new(parents.iter().map(|&p| bone(p)).collect()).unwrap_err();
    assert_eq!(error(&[]), JointedToolError::NoFirstBone);
    assert_eq!(error(&[Some(1), Some(0)]), JointedToolError::NoFirstBone);
    assert_eq!(error(&[None, Some(0), None]), JointedToolError::TwoFirstBones { first: 0, bone: 2 });
    assert_eq!(error(&[None, Some(7)]), JointedToolError::NoParent { bone: 1 });
    assert_eq!(error(&[None, Some(2), Some(1)]), JointedToolError::Circle { bone: 1 });
    let other = Bone { tool: capsule(0.1, Profile::Septic), ..bone(Some(0)) };
    assert_eq!(JointedTool::new(vec![bone(None), other]).unwrap_err(), JointedToolError::Profile { bone: 1 });
}

#[test]
fn a_sampled_bone_needs_the_stated_reach() {
    use isochore_mesh::{DistanceField, DistanceFieldOptions, NoProgress, Padding, primitives};
    let mesh = primitives::icosphere(0.2, 2);
    let shapes = [(mesh.bounds(), SUPPORT); 2];
    let least = JointedTool::least_reach(shapes);
    let sampled = |reach: f64| {
        let options = DistanceFieldOptions { resolution: 16, padding: Padding::Reach(reach), ..Default::default() };
        let distance = DistanceField::new(&mesh, &options, &NoProgress).unwrap();
        let tool = Arc::new(Tool::new(Arc::new(distance), SUPPORT, Profile::Quintic).unwrap());
        let bone = |parent| Bone { tool: Arc::clone(&tool), rest: Pose::IDENTITY, joint: DVec3::ZERO, parent };
        JointedTool::new(vec![bone(None), bone(Some(0))])
    };
    assert!(sampled(least).is_ok());
    let reach = 0.99 * least;
    assert_eq!(sampled(reach).unwrap_err(), JointedToolError::Reach { bone: 0, least, reach });
}

#[test]
fn rejects_keys_with_an_ambiguous_motion() {
    let tool = finger();
    let half = [std::f64::consts::PI, 0.0, 0.0];
    let still = posture(Pose::IDENTITY, &[[0.0; 3]; 2]);
    let error = |keys: &[Posture]| tool.motions(keys).unwrap_err();
    assert_eq!(error(std::slice::from_ref(&still)), JointedToolError::TooFewKeys(1));
    let bent = posture(Pose::IDENTITY, &[[0.0; 3], half]);
    assert_eq!(error(&[still.clone(), bent]), JointedToolError::HalfTurn { key: 0, bone: Some(1) });
    let turned =
        Posture { root: Pose { rotation: rotation_from_vector(half.into()), ..Pose::IDENTITY }, ..still.clone() };
    assert_eq!(error(&[still.clone(), still.clone(), turned]), JointedToolError::HalfTurn { key: 1, bone: None });
    let short = Posture { turns: Vec::new(), ..still.clone() };
    assert_eq!(error(&[still, short]), JointedToolError::Turns { key: 1, turns: 0, bones: 2 });
}
