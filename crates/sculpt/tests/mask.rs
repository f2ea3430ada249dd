//! Masks of recipes, on meshes and points.

use glam::DVec3;
use isochore_mesh::{NoProgress, primitives};
use isochore_sculpt::{
    Meshes, Recipe,
    recipe::{Format, Override},
    replay, replay_points,
};

/// A press beside a plane of symmetry, and a bend across it.
const TEXT: &str = r#"
recipe = 1
target = { mesh = "target" }
[tools.ball]
shape = { kind = "sphere", radius = 0.4 }
support = 0.3
[[stroke]]
kind = "move"
tool = "ball"
keys = [ { at = [0.3, 0, 1.8] }, { at = [0.3, 0, 1.4] } ]
[[stroke]]
kind = "bend"
origin = [0, 0, 0]
axis = [2, 0, 0]
degrees_per_unit2 = 20
[mask]
pins = [ { center = [0, 0, -1], radius = 0.3, support = 0.3 } ]
mirror = [ { point = [0, 0, 0], normal = [-3, 0, 0] } ]
[refine]
enabled = false
[volume]
lock = false
"#;

fn recipe(settings: &[&str]) -> Recipe {
    let overrides: Vec<Override> = settings.iter().map(|text| Override::parse(text).unwrap()).collect();
    Recipe::parse(TEXT, Format::Toml, &overrides).unwrap()
}

fn meshes() -> Meshes {
    Meshes::from([("target".to_owned(), primitives::icosphere(1.0, 3).into())])
}

/// The error of a recipe, found when it is read or replayed.
fn error(settings: &[&str]) -> String {
    let overrides: Vec<Override> = settings.iter().map(|text| Override::parse(text).unwrap()).collect();
    match Recipe::parse(TEXT, Format::Toml, &overrides) {
        Err(error) => error.to_string(),
        Ok(recipe) => replay(&recipe, &meshes(), &NoProgress).unwrap_err().to_string(),
    }
}

#[test]
fn pins_hold_and_mirrors_are_symmetric() {
    let (recipe, meshes) = (recipe(&[]), meshes());
    let rest = &meshes["target"].positions;
    let image = replay(&recipe, &meshes, &NoProgress).unwrap().deformed.mesh.positions;
    let pinned = |rest: &DVec3| rest.distance(DVec3::NEG_Z) < 0.3;
    assert!(rest.iter().filter(|rest| pinned(rest)).count() > 10);
    for (rest, image) in rest.iter().zip(&image) {
        assert!(!pinned(rest) || rest == image);
    }
    assert!(rest.iter().zip(&image).any(|(rest, image)| rest.distance(*image) > 0.1));
    // The mirror images of points that are exactly symmetric are exactly symmetric across a plane of coordinates.
    let flip = DVec3::new(-1.0, 1.0, 1.0);
    let mirrored: Vec<DVec3> = rest.iter().map(|rest| flip * *rest).collect();
    let mirrored = replay_points(&recipe, &meshes, &mirrored, &NoProgress).unwrap().points;
    for (image, mirrored) in image.iter().zip(mirrored) {
        assert_eq!(flip * *image, mirrored);
    }
}

#[test]
fn points_move_as_vertices_do_and_need_the_target() {
    let weights = primitives::icosphere(1.0, 3).positions.iter().map(|p| f64::from(u8::from(p.y > 0.5))).collect();
    let mut recipe = recipe(&[]);
    recipe.mask.fade = Some(0.4);
    recipe.mask.vertices = Some(isochore_sculpt::recipe::VertexWeights::Values(weights));
    let meshes = meshes();
    let rest = &meshes["target"].positions;
    let mesh = replay(&recipe, &meshes, &NoProgress).unwrap().deformed.mesh;
    assert_eq!(replay_points(&recipe, &meshes, rest, &NoProgress).unwrap().points, mesh.positions);
    let held = rest.iter().zip(&mesh.positions).filter(|(rest, _)| rest.y > 0.5);
    assert!(held.clone().count() > 100 && held.into_iter().all(|(rest, image)| rest == image));
    let missing = replay_points(&recipe, &Meshes::new(), rest, &NoProgress).unwrap_err();
    assert!(missing.to_string().contains("`target` was not loaded"), "{missing}");
}

#[test]
fn rates_that_refinement_cannot_follow_are_refused() {
    let refined = |degrees: &str| error(&["mask={}", "refine.enabled=true", degrees]);
    // The corners of the bounds are √3 from the origin: a shear of 2 · 3 a radian.
    let words = "stroke.1.degrees_per_unit2: is 1000, which winds the target up more finely";
    assert!(refined("stroke.1.degrees_per_unit2=1000").contains(words));
    let bare = recipe(&["mask={}", "stroke.1.degrees_per_unit2=1000"]);
    assert!(replay(&bare, &meshes(), &NoProgress).is_ok());
}

#[test]
fn errors_of_masks_name_the_key() {
    for (settings, words) in [
        (&["mask.pins.0.support=0"][..], "mask.pins.0.support: is 0; give a number above 0"),
        (&["mask.pins.0.radius=-1"], "mask.pins.0.radius: is -1; give 0 or more"),
        (&["mask.mirror.0.normal=[0,0,0]"], "mask.mirror.0.normal: has length zero"),
        (
            &["mask.mirror=[{point=[0,0,0],normal=[1,0,0]},{point=[0,0,0],normal=[1,1,0]}]"],
            "mask.mirror: mirror planes 0 and 1, counted from 0, are not perpendicular",
        ),
        (&["mask.mirror.0.normal=[0,1,0]"], "stroke.1: the mirror image of the motion undoes it"),
        (&["mask.fade=1"], "mask.fade: sets how the weights of `vertices` fade"),
        (&["mask.vertices=[0,1,2]"], "mask.vertices.2: is 2; give 1 or less"),
        (&["mask.vertices=[0,1,'a']"], "mask.vertices.2: "),
        (&["mask.vertices=[0,1]"], "mask.vertices: 2 weights are given for 642 vertices"),
        (&["mask.vertices=7"], "mask.vertices: expected the name of a file or a list of numbers, found 7"),
        (&["mask.vertices=a.csv"], "mask.vertices: the file `a.csv` was not loaded"),
        (&["mask.pin=[]"], "unknown key; did you mean `pins`?"),
        (&["integrate.step=1.5"], "integrate.step: is 1.5; give 1 or less"),
    ] {
        let error = error(settings);
        assert!(error.contains(words), "{settings:?}: {error}");
    }
}
