//! Recipes carried out on meshes and points.

use glam::DVec3;
use isochore_mesh::{Cancelled, Monitor, NoProgress, TriMesh, primitives};
use isochore_sculpt::{
    Meshes, Recipe, ReplayError, Report, Source,
    recipe::{Format, Override},
    replay, replay_points,
};

/// A press by a ball and a twist, without lock and refinement.
const BARE: &str = r#"
recipe = 1
target = { mesh = "target" }
[tools.ball]
shape = { kind = "sphere", radius = 0.4 }
support = 0.3
[[stroke]]
kind = "move"
tool = "ball"
keys = [ { at = [0, 0, 1.8] }, { at = [0, 0, 1.2] } ]
[[stroke]]
kind = "twist"
origin = [0, 0, 0]
axis = [0, 0, 2]
degrees_per_unit = 20
[refine]
enabled = false
[volume]
lock = false
"#;

fn recipe(settings: &[&str]) -> Recipe {
    let overrides: Vec<Override> = settings.iter().map(|text| Override::parse(text).unwrap()).collect();
    Recipe::parse(BARE, Format::Toml, &overrides).unwrap()
}

fn meshes(target: TriMesh) -> Meshes {
    Meshes::from([("target".to_owned(), target.into())])
}

#[test]
fn points_move_as_vertices_do() {
    let meshes = meshes(primitives::icosphere(1.0, 3));
    let recipe = recipe(&[]);
    let mesh = replay(&recipe, &meshes, &NoProgress).unwrap().deformed.mesh;
    let points = replay_points(&recipe, &Meshes::new(), &meshes["target"].positions, &NoProgress).unwrap();
    assert_eq!(points.points, mesh.positions);
    assert!(points.warnings.is_empty());
    assert_ne!(mesh.positions, meshes["target"].positions);
}

#[test]
fn a_finer_mesh_agrees_where_they_meet() {
    let recipe = recipe(&["refine.enabled=true"]);
    let [coarse, fine] = [2, 4].map(|subdivisions| {
        let meshes = meshes(primitives::icosphere(1.0, subdivisions));
        replay(&recipe, &meshes, &NoProgress).unwrap().deformed.mesh
    });
    // Subdivision leaves the vertices that are there in front, unchanged.
    let common = primitives::icosphere(1.0, 2).positions.len();
    assert_eq!(coarse.positions[..common], fine.positions[..common]);
}

#[test]
fn points_have_no_lock_and_are_told_so() {
    let recipe = recipe(&["volume.lock=true"]);
    let points = replay_points(&recipe, &Meshes::new(), &[DVec3::ZERO], &NoProgress).unwrap();
    assert!(points.warnings[0].contains("lock"), "{:?}", points.warnings);
}

#[test]
fn targets_are_scaled_then_rotated_then_moved() {
    let transform = "target.transform={ scale = 2, rotate = [0, 0, 3, 90], translate = [10, 0, 0] }";
    let mesh =
        TriMesh { positions: vec![DVec3::X, DVec3::Y, DVec3::Z], triangles: vec![[0, 1, 2]], ..TriMesh::default() };
    let target = replay(&recipe(&[transform]), &meshes(mesh), &NoProgress).unwrap().scene.target;
    let expected = [DVec3::new(10.0, 2.0, 0.0), DVec3::new(8.0, 0.0, 0.0), DVec3::new(10.0, 0.0, 2.0)];
    for (found, expected) in target.positions.iter().zip(expected) {
        // Coordinates of ten round at 2e-15.
        assert!(found.distance(expected) < 1e-14, "{found} {expected}");
    }
}

#[test]
fn frames_lead_from_rest_to_the_finished_mesh() {
    for lock in ["volume.lock=false", "volume.lock=true"] {
        let recipe = recipe(&[lock, "refine.enabled=true"]);
        let replay = replay(&recipe, &meshes(primitives::icosphere(1.0, 3)), &NoProgress).unwrap();
        let frames: Vec<TriMesh> = (0..5).map(|index| replay.frame(index, 5, &NoProgress).unwrap()).collect();
        assert_eq!(frames[0], replay.deformed.rest);
        assert_eq!(frames[4], replay.deformed.mesh);
        // Half of the time is the first of the two strokes.
        let mut first = recipe.clone();
        first.strokes.truncate(1);
        first.refine.enabled = false;
        let rest = meshes(replay.deformed.rest.clone());
        assert_eq!(frames[2], isochore_sculpt::replay(&first, &rest, &NoProgress).unwrap().deformed.mesh);
        assert!(frames.windows(2).all(|pair| pair[0].positions != pair[1].positions));
    }
}

#[test]
fn errors_name_what_cannot_be_followed() {
    let error = |settings: &[&str], meshes: &Meshes| match replay(&recipe(settings), meshes, &NoProgress) {
        Ok(_) => panic!("{settings:?}"),
        Err(error) => error.to_string(),
    };
    let sphere = meshes(primitives::icosphere(1.0, 1));
    assert!(error(&[], &Meshes::new()).contains("`target` was not loaded"));
    let tool = "tools.ball.shape={ kind = \"mesh\", mesh = \"king\", resolution = 16 }";
    assert!(error(&[tool], &sphere).contains("`king` was not loaded"));
    let mut open = primitives::icosphere(1.0, 1);
    open.triangles.pop();
    assert!(error(&["promise.volume=0.1"], &meshes(open)).starts_with("promise.volume: the target encloses no volume"));
    assert!(error(&["integrate.step=1e-300"], &sphere).starts_with("stroke.0: "));
}

#[test]
fn tools_that_no_stroke_uses_are_not_read() {
    let mut recipe = recipe(&[]);
    let king = Recipe::parse(
        &BARE.replace("{ kind = \"sphere\", radius = 0.4 }", "{ kind = \"mesh\", mesh = \"king\", resolution = 16 }"),
        Format::Toml,
        &[],
    );
    assert_eq!(king.as_ref().unwrap().mesh_names(), ["king", "target"]);
    recipe.tools.insert("king".to_owned(), king.unwrap().tools["ball"].clone());
    assert_eq!(recipe.mesh_names(), ["target"]);
    replay(&recipe, &meshes(primitives::icosphere(1.0, 1)), &NoProgress).unwrap();
}

#[test]
fn reports_are_measured_on_the_mesh_as_written() {
    let recipe = recipe(&["promise.volume=0.01"]);
    let replay = replay(&recipe, &meshes(primitives::icosphere(1.0, 3)), &NoProgress).unwrap();
    let source = Source { text: b"abc", overrides: &[] };
    let mut written = replay.deformed.mesh.clone();
    let report = Report::new(&recipe, source, &replay, &written, &NoProgress).unwrap();
    assert_eq!(report.missed_promises().count(), 0, "{:?} {:?}", report.promises, report.volume_change);
    let kept =
        ["lock_within_half_edge", "no_new_self_intersections", "positive_jacobian", "strokes_completed", "volume"];
    assert!(report.promises.keys().eq(&kept), "{:?}", report.promises);
    assert_eq!(report.recipe_sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");

    // A file that holds another mesh than the one in memory is judged by what it holds.
    written.positions.iter_mut().for_each(|position| *position *= 1.1);
    let report = Report::new(&recipe, source, &replay, &written, &NoProgress).unwrap();
    assert_eq!(report.missed_promises().collect::<Vec<_>>(), ["volume"]);
    // 1.1³ − 1, to the precision that the deformation left of the volume.
    assert!((report.volume_change.unwrap() - 0.331).abs() < 0.02);

    written.triangles.pop();
    let report = Report::new(&recipe, source, &replay, &written, &NoProgress).unwrap();
    assert_eq!((report.after.closed, report.after.volume, report.volume_change), (false, None, None));
    assert!(!report.promises["volume"]);
    let json = serde_json::to_string(&report).unwrap();
    assert_eq!(serde_json::from_str::<Report>(&json).unwrap(), report);
}

#[test]
fn work_can_be_cancelled() {
    struct Stop;
    impl Monitor for Stop {
        fn is_cancelled(&self) -> bool {
            true
        }
    }
    let result = replay(&recipe(&[]), &meshes(primitives::icosphere(1.0, 3)), &Stop);
    assert!(matches!(result, Err(ReplayError::Cancelled(Cancelled))));
}

/// A ball that is stamped into a sphere from above, and a twist.
const STAMPED: &str = r#"
recipe = 1
target = { mesh = "target" }
[tools.ball]
shape = { kind = "sphere", radius = 0.3 }
support = 0.3
[[stroke]]
kind = "stamp"
tool = "ball"
keys = [ { at = [0, 0, 1.5] }, { at = [0, 0, 1.15] } ]
relief = 0.04
[[stroke]]
kind = "twist"
origin = [0, 0, 0]
axis = [0, 0, 1]
degrees_per_unit = 20
[refine]
volume = 1e-5
[volume]
lock = false
"#;

fn stamped(settings: &[&str]) -> Recipe {
    let overrides: Vec<Override> = settings.iter().map(|text| Override::parse(text).unwrap()).collect();
    Recipe::parse(STAMPED, Format::Toml, &overrides).unwrap()
}

#[test]
fn a_stamp_keeps_the_volume_and_is_reported() {
    let recipe = stamped(&[]);
    let replay = replay(&recipe, &meshes(primitives::icosphere(1.0, 4)), &NoProgress).unwrap();
    let source = Source { text: b"", overrides: &[] };
    let report = Report::new(&recipe, source, &replay, &replay.deformed.mesh, &NoProgress).unwrap();
    let stamp = &report.strokes[0];
    assert_eq!(stamp.kind, "stamp");
    assert!(stamp.moved > 100 && stamp.inserted > 100 && stamp.evaluations > 1000);
    assert!(stamp.volume_change.unwrap().abs() <= 1e-14);
    assert_eq!(report.warnings, [""; 0]);
}

#[test]
fn frames_of_a_stamp_go_down_into_the_surface() {
    let replay = replay(&stamped(&[]), &meshes(primitives::icosphere(1.0, 4)), &NoProgress).unwrap();
    let frames: Vec<TriMesh> = (0..9).map(|index| replay.frame(index, 9, &NoProgress).unwrap()).collect();
    assert_eq!(frames[0].positions, replay.deformed.rest.positions);
    // The pole lies under the ball; nothing of the twist moves it.
    let heights: Vec<f64> = frames.iter().map(|frame| frame.positions[pole(&replay.deformed.rest)].z).collect();
    assert!(heights.windows(2).all(|pair| pair[1] <= pair[0]), "{heights:?}");
    assert!((heights[4] - 0.85).abs() < 0.01 && (heights[0] - 1.0).abs() < 0.01, "{heights:?}");
    for frame in &frames {
        assert_eq!(frame.triangles, replay.deformed.mesh.triangles);
        // The facets of the twist alone.
        assert!((frame.volume() / frames[0].volume() - 1.0).abs() < 1e-4);
    }
}

fn pole(mesh: &TriMesh) -> usize {
    let positions = &mesh.positions;
    (0..positions.len()).max_by(|&a, &b| positions[a].z.total_cmp(&positions[b].z)).unwrap()
}

#[test]
fn a_stamp_needs_a_volume() {
    let error = replay_points(&stamped(&[]), &Meshes::new(), &[DVec3::ZERO], &NoProgress).unwrap_err();
    assert_eq!(error.key().as_deref(), Some("stroke.0"));
    assert!(error.to_string().contains("points have none"), "{error}");

    let mut open = primitives::icosphere(1.0, 3);
    open.triangles.pop();
    let error = replay(&stamped(&[]), &meshes(open), &NoProgress).unwrap_err();
    assert_eq!(error.key().as_deref(), Some("stroke.0"));
    assert!(error.to_string().contains("open mesh"), "{error}");
}

#[test]
fn a_stamp_is_validated() {
    for (setting, key) in [
        ("stroke.0.tool='bal'", "stroke.0.tool"),
        ("stroke.0.relief=0", "stroke.0.relief"),
        ("stroke.0.keys=[]", "stroke.0.keys"),
    ] {
        let error = Recipe::parse(STAMPED, Format::Toml, &[Override::parse(setting).unwrap()]).unwrap_err();
        assert_eq!(error.key, key);
    }
}
