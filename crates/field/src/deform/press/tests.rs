use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{
    Aabb, Distance, DistanceBlock, LANES, NoProgress, PointBlock, SelfIntersections, Sphere, TriMesh, primitives,
};

use super::*;
use crate::{
    deform::{DeformError, DeformOptions, Deformed, Note, RefineOptions, deform},
    fields::{Pose, Profile, Tool, pose::Placement, rotation_from_vector},
    flow::{AdvectError, Move, Stroke, Twist, advect_points},
};

/// Radius, thickness, and height and wavelength of the relief of the coin.
const RADIUS: f64 = 0.5;
const THICKNESS: f64 = 0.3;
const RELIEF: f64 = 0.03;
const WAVELENGTH: f64 = 0.4;

/// A coin that faces −z: z = 0 is the mean of its relief, a product of two waves.
#[derive(Debug)]
struct Coin;

impl Coin {
    fn at(point: DVec3) -> (f64, DVec3) {
        let wave = std::f64::consts::TAU / WAVELENGTH;
        let (sin_x, cos_x) = libm::sincos(wave * point.x);
        let (sin_y, cos_y) = libm::sincos(wave * point.y);
        let slope = RELIEF * wave;
        // At the steepest slope of the relief, the height exceeds the distance by this factor.
        let scale = 1.0 / (1.0 + slope * slope).sqrt();
        let face = scale * (-RELIEF * cos_x * cos_y - point.z);
        let face_gradient = scale * DVec3::new(slope * sin_x * cos_y, slope * cos_x * sin_y, -1.0);
        let radius = point.x.hypot(point.y);
        let edge = radius - RADIUS;
        let edge_gradient = DVec3::new(point.x, point.y, 0.0).normalize_or_zero();
        let back = point.z - THICKNESS;
        let (f, e, b) = (face.max(0.0), edge.max(0.0), back.max(0.0));
        let outside = (f * f + e * e + b * b).sqrt();
        if outside > 0.0 {
            return (outside, (f * face_gradient + e * edge_gradient + b * DVec3::Z) / outside);
        }
        let inside = [(face, face_gradient), (edge, edge_gradient), (back, DVec3::Z)];
        inside.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    }
}

impl Distance for Coin {
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        for lane in 0..LANES {
            let (value, gradient) = Self::at(points.get(lane));
            out.value[lane] = value;
            out.gradient.set(lane, gradient);
        }
    }

    fn bounds(&self) -> Aabb {
        Aabb { min: DVec3::new(-RADIUS, -RADIUS, -RELIEF), max: DVec3::new(RADIUS, RADIUS, THICKNESS) }
    }

    fn centroid(&self) -> DVec3 {
        DVec3::new(0.0, 0.0, 0.5 * THICKNESS)
    }

    fn lipschitz(&self) -> f64 {
        1.25
    }
}

const SUPPORT: f64 = 0.35;
const DEPTH: f64 = 0.12;
const TOP: f64 = 0.4;
const FLAT: DeformOptions = DeformOptions { refine: None, lock: false };

fn refined() -> DeformOptions {
    let refine = RefineOptions { volume: Some(1e-4), ..RefineOptions::default() };
    DeformOptions { refine: Some(refine), lock: false }
}

fn tool(distance: impl Distance + 'static) -> Arc<Tool> {
    Arc::new(Tool::new(Arc::new(distance), SUPPORT, Profile::Quintic).unwrap())
}

/// A slab whose upper face is at [`TOP`].
fn slab(segments: usize) -> TriMesh {
    primitives::box_mesh(DVec3::new(1.2, 1.2, TOP), [segments, segments, segments / 20])
}

fn coin_keys() -> Vec<Pose> {
    vec![Pose::at(DVec3::Z * (TOP + RELIEF)), Pose::at(DVec3::Z * (TOP - DEPTH))]
}

/// The coin pressed in `steps` steps.
fn coin(steps: usize) -> Stroke {
    let tool = tool(Coin);
    let step = (DEPTH + RELIEF) / tool.feature_size() / (steps as f64 - 0.5);
    let stamp = Stamp::new(tool, coin_keys(), step, Some(WAVELENGTH / 8.0)).unwrap();
    assert_eq!(stamp.path().steps(), steps);
    Stroke::Stamp(stamp)
}

fn run(mesh: &TriMesh, strokes: &[Stroke], options: &DeformOptions) -> Deformed {
    deform(mesh, strokes, options, &NoProgress).unwrap()
}

fn volume_error(deformed: &Deformed) -> f64 {
    let receipt = &deformed.receipt;
    (receipt.volume_before_lock.unwrap() / receipt.volume_before.unwrap() - 1.0).abs()
}

/// Distances of all vertices from a tool.
fn distances(mesh: &TriMesh, distance: &dyn Distance, pose: &Pose) -> Vec<f64> {
    let placement = Placement::from(pose);
    mesh.positions.iter().map(|&position| distance.sample(placement.to_local(position)).0).collect()
}

fn highest(mesh: &TriMesh) -> f64 {
    mesh.positions.iter().map(|position| position.z).fold(f64::NEG_INFINITY, f64::max)
}

/// Final distances from the coin of the vertices that it certainly covers.
fn covered(deformed: &Deformed) -> Vec<f64> {
    let distances = distances(&deformed.mesh, &Coin, &coin_keys()[1]);
    let is_covered = |rest: &DVec3| rest.z == TOP && rest.truncate().length() < 0.95 * RADIUS;
    deformed.rest.positions.iter().zip(distances).filter(|(rest, _)| is_covered(rest)).map(|(_, d)| d).collect()
}

/// Rounding of a distance near coordinates of one, which the press treats as contact.
const ROUNDING: f64 = 64.0 * f64::EPSILON * 2.0;

#[test]
fn the_volume_is_kept_and_the_tool_does_not_cut() {
    for (mesh, options) in [(slab(80), FLAT), (slab(20), refined())] {
        let deformed = run(&mesh, &[coin(20)], &options);
        assert!(volume_error(&deformed) <= 1e-14, "{:.1e}", volume_error(&deformed));
        let least = distances(&deformed.mesh, &Coin, &coin_keys()[1]).into_iter().fold(f64::INFINITY, f64::min);
        assert!(least >= -ROUNDING, "a vertex is {least:.1e} deep in the tool");
        let covered = covered(&deformed);
        assert!(covered.len() > 500);
        assert!(covered.iter().all(|distance| distance.abs() <= ROUNDING));
        assert!(SelfIntersections::of(&deformed.mesh, &NoProgress).unwrap().triangles().is_empty());
        assert_eq!(deformed.receipt.notes, []);
    }
}

#[test]
fn the_height_of_the_rim_does_not_depend_on_the_steps() {
    for (mesh, options) in [(slab(80), FLAT), (slab(20), refined())] {
        let [few, some, many] = [5, 20, 80].map(|steps| highest(&run(&mesh, &[coin(steps)], &options).mesh) - TOP);
        assert!(many > 0.08, "{many}");
        // The steps are of first order, and some of the five are halved because they would raise too much.
        assert!((few / many - 1.0).abs() < 0.02 && (some / many - 1.0).abs() < 0.01, "{few} {some} {many}");
    }
}

#[test]
fn the_relief_appears_between_vertices() {
    let deformed = run(&slab(20), &[coin(20)], &refined());
    let placement = Placement::from(&coin_keys()[1]);
    let (mut seen, mut gap): (usize, f64) = (0, 0.0);
    for (rest, triangle) in deformed.rest.triangles.iter().zip(&deformed.mesh.triangles) {
        let inside = |vertex: u32| deformed.rest.positions[vertex as usize];
        if rest.iter().all(|&vertex| inside(vertex).z == TOP && inside(vertex).truncate().length() < 0.9 * RADIUS) {
            let center = triangle.map(|vertex| deformed.mesh.positions[vertex as usize]).iter().sum::<DVec3>() / 3.0;
            gap = gap.max(Coin.sample(placement.to_local(center)).0.abs());
            seen += 1;
        }
    }
    // Over a chord of length h, a wave of amplitude a deviates by a h² k² / 8, in each of two directions.
    let wave = std::f64::consts::TAU / WAVELENGTH;
    let sagitta = 2.0 * RELIEF * (WAVELENGTH / 8.0 * wave).powi(2) / 8.0;
    assert!(seen > 1000 && gap < sagitta, "{seen} {gap} {sagitta}");
}

#[test]
fn the_outline_has_no_teeth() {
    // No triangle reaches from the face of the coin to a vertex beside it: vertices are on the outline.
    for segments in [20, 33] {
        let deformed = run(&slab(segments), &[coin(20)], &refined());
        let distances = distances(&deformed.mesh, &Coin, &coin_keys()[1]);
        let relief = WAVELENGTH / 8.0;
        let deep = coin_keys()[1].translation.z + RELIEF + 0.02;
        let mut on_face = 0;
        for triangle in &deformed.mesh.triangles {
            let is_face = |vertex: u32| {
                let position = deformed.mesh.positions[vertex as usize];
                position.z > 0.0 && position.z < deep && position.truncate().length() < RADIUS + 0.01
            };
            if triangle.iter().any(|&vertex| is_face(vertex)) {
                on_face += 1;
                let farthest = triangle.iter().map(|&vertex| distances[vertex as usize]).fold(0.0, f64::max);
                assert!(farthest <= 0.15 * relief, "{farthest}");
            }
        }
        assert!(on_face > 1000);
    }
}

#[test]
fn points_beyond_the_support_keep_their_bits() {
    let deformed = run(&slab(20), &[coin(20)], &refined());
    let mut far = 0;
    for (rest, position) in deformed.rest.positions.iter().zip(&deformed.mesh.positions) {
        // The midpoint of an edge moves with a raised end, so the raised part can extend by one edge, at
        // most 0.17.
        if rest.truncate().length() > RADIUS + SUPPORT + 0.17 || rest.z < 0.0 {
            assert_eq!(rest.to_array().map(f64::to_bits), position.to_array().map(f64::to_bits));
            far += 1;
        }
    }
    let moved = deformed.rest.positions.iter().zip(&deformed.mesh.positions).filter(|(a, b)| a != b).count();
    assert!(far > 500 && moved > 1000);
    assert_eq!((deformed.receipt.moved_vertices, deformed.receipt.strokes[0].moved), (moved, moved));
}

fn ball_press() -> Stroke {
    let keys = vec![Pose::at(DVec3::new(0.3, 0.2, 1.2)), Pose::at(DVec3::new(0.3, 0.2, 0.6))];
    Stroke::Move(Move::new(tool(Sphere::new(0.3).unwrap()), keys, 0.05).unwrap())
}

#[test]
fn flows_and_refinement_continue_after_a_stamp() {
    let mesh = slab(20);
    let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, 0.6).unwrap());
    let strokes = [twist.clone(), coin(20), ball_press(), twist];
    let deformed = run(&mesh, &strokes, &refined());
    let receipt = &deformed.receipt;
    assert!(receipt.strokes.iter().all(|stroke| stroke.moved > 100));
    assert!(receipt.strokes[1].volume_change.unwrap().abs() < 1e-14);
    assert!(receipt.strokes[1].inserted > 0 && receipt.strokes[2].inserted > 0);
    // Each run of flows keeps its relative facet error below 1e-4, by an asymptotic estimate. The error
    // of the time step is 1e-5.
    assert!(volume_error(&deformed) < 2.0 * 1e-4 + 2e-5, "{:.1e}", volume_error(&deformed));

    // The rest is the input mesh, split: the same triangles, each vertex at its origin.
    assert_eq!(deformed.rest.triangles, deformed.mesh.triangles);
    assert_eq!(deformed.rest.positions[..mesh.positions.len()], mesh.positions);
    assert!((deformed.rest.volume() / mesh.volume() - 1.0).abs() < 1e-14);
    assert!((deformed.rest.area() / mesh.area() - 1.0).abs() < 1e-13);
    let outer = DVec3::new(1.2, 1.2, TOP);
    assert!(deformed.rest.positions.iter().all(|position| (position.abs() / outer).max_element() == 1.0));
}

#[test]
fn a_stamp_does_not_change_the_strokes_before_it() {
    // The stamp is far from the ball, so the dent of the ball has the same bits as without it.
    let away = vec![Pose::at(DVec3::new(-0.8, -0.8, 1.0)), Pose::at(DVec3::new(-0.8, -0.8, 0.62))];
    let small = Arc::new(Tool::new(Arc::new(Sphere::new(0.25).unwrap()), 0.1, Profile::Quintic).unwrap());
    let stamp = Stroke::Stamp(Stamp::new(small, away, 0.125, None).unwrap());
    let mesh = slab(40);
    let alone = run(&mesh, &[ball_press()], &FLAT).mesh;
    let [before, after] =
        [vec![ball_press(), stamp.clone()], vec![stamp, ball_press()]].map(|strokes| run(&mesh, &strokes, &FLAT).mesh);
    let mut seen = 0;
    for (index, position) in alone.positions.iter().enumerate() {
        if position.x > -0.2 && position != &mesh.positions[index] {
            assert_eq!((before.positions[index], after.positions[index]), (*position, *position));
            seen += 1;
        }
    }
    assert!(seen > 100);
}

#[test]
fn a_stamp_continues_where_another_ended() {
    let deeper = vec![coin_keys()[1], Pose::at(DVec3::Z * (TOP - DEPTH - 0.05))];
    let again = Stroke::Stamp(Stamp::new(tool(Coin), deeper.clone(), 0.125, Some(WAVELENGTH / 8.0)).unwrap());
    let deformed = run(&slab(20), &[coin(20), again], &refined());
    assert!(volume_error(&deformed) <= 1e-14);
    let least = distances(&deformed.mesh, &Coin, &deeper[1]).into_iter().fold(f64::INFINITY, f64::min);
    assert!(least >= -ROUNDING, "{least:.1e}");
}

#[test]
fn a_lifted_stamp_moves_nothing() {
    let mut keys = coin_keys();
    keys.push(keys[0]);
    let pressed = |keys| {
        let stamp = Stroke::Stamp(Stamp::new(tool(Coin), keys, 0.125, Some(0.05)).unwrap());
        run(&slab(80), &[stamp], &FLAT).mesh
    };
    assert_eq!(pressed(coin_keys()), pressed(keys));
}

#[test]
fn a_stamp_works_in_any_pose() {
    let place = DVec3::new(300.0, -200.0, 100.0);
    let turn = rotation_from_vector(DVec3::new(0.4, -0.7, 0.2));
    let mesh = slab(20).transformed(1.0, turn, place);
    let pose = |height: f64, degrees: f64| {
        let spin = rotation_from_vector(DVec3::Z * degrees.to_radians());
        Pose { rotation: turn * spin, translation: place + turn * DVec3::Z * height }
    };
    let keys = vec![pose(TOP + RELIEF, 0.0), pose(TOP - DEPTH, 25.0)];
    let stamp = Stroke::Stamp(Stamp::new(tool(Coin), keys.clone(), 0.125, Some(0.05)).unwrap());
    let deformed = run(&mesh, &[stamp], &refined());
    assert!(volume_error(&deformed) <= 1e-14, "{:.1e}", volume_error(&deformed));
    let least = distances(&deformed.mesh, &Coin, &keys[1]).into_iter().fold(f64::INFINITY, f64::min);
    // Coordinates near 300 have rounding errors that are as much larger.
    assert!(least >= -300.0 * ROUNDING, "{least:.1e}");
}

#[test]
fn a_truncated_stamp_presses_part_of_the_path() {
    let half = coin(20).truncated(0.5);
    let deformed = run(&slab(20), &[half], &refined());
    let deepest = deformed.rest.positions.iter().zip(&deformed.mesh.positions).map(|(a, b)| a.z - b.z);
    // Half of the path, less the height of the relief at its start.
    assert!((deepest.fold(0.0, f64::max) - (0.5 * (DEPTH + RELIEF))).abs() < 1e-3);
    assert!(volume_error(&deformed) <= 1e-14);
    assert_eq!(run(&slab(20), &[coin(20).truncated(0.0)], &refined()).receipt.notes, [Note::StampMissed { stroke: 0 }]);
}

#[test]
fn the_lock_does_not_change_a_stamp() {
    let [bare, locked] =
        [false, true].map(|lock| run(&slab(20), &[coin(20)], &DeformOptions { lock, ..refined() }).mesh);
    let farthest = bare.positions.iter().zip(&locked.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!(farthest <= ROUNDING, "{farthest:.1e}");
}

#[test]
fn stamps_an_inverted_mesh() {
    let right = slab(20);
    let turned = right.clone().flipped();
    let [right, turned] = [right, turned].map(|mesh| run(&mesh, &[coin(20)], &refined()));
    assert!(volume_error(&turned) <= 1e-14);
    // Rounding can choose other diagonals; heights agree up to the sagitta of the rim.
    assert!((highest(&right.mesh) - highest(&turned.mesh)).abs() < 1e-3);
}

#[test]
fn threads_do_not_change_the_bits() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&slab(20), &[coin(20), ball_press()], &DeformOptions::default()).mesh)
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(8));
}

fn error(mesh: &TriMesh, stroke: Stroke) -> DeformError {
    deform(mesh, &[ball_press(), stroke], &refined(), &NoProgress).unwrap_err()
}

#[test]
fn rejects_a_mesh_without_volume() {
    let mut open = slab(20);
    open.triangles.pop();
    let found = error(&open, coin(5));
    assert_eq!(found, DeformError::Stamp { stroke: 1, source: PressError::NoVolume });
    assert!(found.to_string().contains("stroke 1") && found.to_string().contains("open"), "{found}");
    let sheet = TriMesh::new(vec![DVec3::X, DVec3::Y, DVec3::Z], vec![[0, 1, 2], [0, 2, 1]]);
    assert_eq!(error(&sheet, coin(5)), DeformError::Stamp { stroke: 1, source: PressError::NoVolume });
}

#[test]
fn rejects_points_without_a_surface() {
    let found = advect_points(&[DVec3::ZERO], &[ball_press(), coin(5)], &NoProgress).unwrap_err();
    assert_eq!(found, AdvectError::Stamp { stroke: 1 });
}

#[test]
fn rejects_a_tool_that_starts_inside() {
    let keys = vec![Pose::at(DVec3::Z * (TOP - 0.1)), Pose::at(DVec3::Z * (TOP - 0.2))];
    // Even if no vertex of the input mesh is inside the tool.
    for mesh in [slab(20), primitives::box_mesh(DVec3::new(1.2, 1.2, TOP), [1, 1, 1])] {
        let stamp = Stroke::Stamp(Stamp::new(tool(Coin), keys.clone(), 0.125, None).unwrap());
        let found = deform(&mesh, &[stamp], &refined(), &NoProgress).unwrap_err();
        assert!(
            matches!(found, DeformError::Stamp { stroke: 0, source: PressError::StartsInside { depth, .. } }
                if depth > 0.05 && depth < 0.2),
            "{found}"
        );
    }
}

#[test]
fn rejects_a_stamp_whose_volume_cannot_be_raised() {
    // A tool wider than the body, with almost no support beyond its edge.
    let plate = isochore_mesh::RoundedBox::new(DVec3::new(3.0, 3.0, 0.2), 0.0).unwrap();
    let narrow = Arc::new(Tool::new(Arc::new(plate), 0.02, Profile::Quintic).unwrap());
    let keys = vec![Pose::at(DVec3::Z * 0.7), Pose::at(DVec3::Z * 0.4)];
    let stamp = Stroke::Stamp(Stamp::new(narrow, keys, 1.0, Some(0.2)).unwrap());
    let found = deform(&slab(20), &[stamp], &refined(), &NoProgress).unwrap_err();
    assert!(matches!(found, DeformError::Stamp { source: PressError::NoRoom { .. }, .. }), "{found}");
}

#[test]
fn a_stamp_through_a_sheet_ends_before_the_sheet_crosses_itself() {
    let sheet = primitives::box_mesh(DVec3::new(1.2, 1.2, 0.05), [40, 40, 2]);
    let keys = vec![Pose::at(DVec3::Z * 0.1), Pose::at(DVec3::Z * -0.2)];
    let stamp = Stroke::Stamp(Stamp::new(tool(Coin), keys, 0.125, Some(0.05)).unwrap());
    match deform(&sheet, &[stamp], &refined(), &NoProgress) {
        Ok(deformed) => {
            // It ends before its two sides cross.
            let stroke = &deformed.receipt.strokes[0];
            let stopped_at = stroke.stopped_at.unwrap();
            assert!(stopped_at > 0.1 && stopped_at < 0.7, "{stopped_at}");
            assert!(matches!(deformed.receipt.notes[0], Note::Stopped { stroke: 0, .. }));
            assert_eq!(deformed.receipt.new_crossings, 0);
            let sheets = stroke.sheets.unwrap();
            assert!(sheets.gap > 0.0 && sheets.gap < 0.1 && sheets.at.abs().max_element() < 0.6, "{sheets:?}");
            assert!(deformed.mesh.positions.iter().all(|position| position.is_finite()));
            assert!(volume_error(&deformed) <= 1e-14);
        }
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn the_limit_on_triangles_holds_and_is_noted() {
    let refine = RefineOptions { max_triangles: 3000, ..RefineOptions::default() };
    let deformed = run(&slab(20), &[coin(20)], &DeformOptions { refine: Some(refine), lock: false });
    assert!(deformed.mesh.triangles.len() <= 3000);
    assert_eq!(deformed.receipt.notes, [Note::TriangleLimit { stroke: 0, max_triangles: 3000 }]);
}
