use super::*;
use crate::fields::{
    field::finite_differences::scattered_points,
    jointed_tool::tests::{evaluate, motions, pose_of},
};

#[test]
fn the_core_of_every_bone_follows_its_bone() {
    for (tool, keys) in motions() {
        let stroke = FieldStroke::new(tool.motions(&keys).unwrap(), 0.125).unwrap();
        let stroke = Stroke::Field(stroke);
        let motions = tool.motions(&keys).unwrap();
        let mut followed = vec![0; tool.bones().len()];
        for point in scattered_points(100_000, 1.3) {
            let core = evaluate(&*motions[0].at(0.0), point).core[0];
            // The core of a bone shrinks as another bone bends towards it.
            let is_kept = |motion: &Arc<dyn MovingField>| {
                (0..=8).all(|index| {
                    let field = motion.at(f64::from(index) / 8.0);
                    evaluate(&*field, field.core_pose(core).transform(point)).core[0] == core
                })
            };
            if core == NO_CORE || !motions.iter().all(is_kept) {
                continue;
            }
            let mut moved = [point];
            stroke.advect_chunk(&mut moved);
            let expected = pose_of(&tool, &keys[keys.len() - 1], core as usize, point);
            // Rounding of a hundred steps in closed form.
            assert!(moved[0].distance(expected) < 1e-13, "bone {core} at {point}");
            followed[core as usize] += 1;
        }
        // A bone of a finger has a volume of 0.02, and the cube 5700 points per unit of volume. At least a
        // quarter of the points are in the core.
        assert!(followed.iter().all(|&count| count > 30), "{followed:?}");
    }
}

#[test]
fn untouchable_points_do_not_move_and_a_truncated_stroke_ends_on_the_path() {
    for (tool, keys) in motions() {
        let stroke = Stroke::Field(FieldStroke::new(tool.motions(&keys).unwrap(), 0.25).unwrap());
        let points = scattered_points(400, 2.0);
        let mut moved = points.clone();
        stroke.advect_chunk(&mut moved);
        let mut untouchable = 0;
        for (point, moved) in points.iter().zip(&moved) {
            if !stroke.may_touch(*point, 0.0) {
                assert_eq!(point, moved);
                untouchable += 1;
            }
        }
        assert!(untouchable > 50 && points != moved, "{untouchable}");
    }
}
