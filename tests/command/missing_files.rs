//! Files that a recipe names and that do not exist: the error names the recipe, the line of the key
//! and the remedy.

use std::fs;

use crate::folder::{Folder, TETRAHEDRON};

/// A recipe in the folder `recipes` that names two meshes and two tables.
const RECIPE: &str = r#"recipe = 1
target = { mesh = "data/hare.obj" }
[tools.king]
shape = { kind = "mesh", mesh = "data/king.obj", resolution = 16 }
support = 0.3
[[stroke]]
kind = "move"
tool = "king"
keys = [ { at = [0, 0, 2] }, { at = [0, 0, 1] } ]
[[stroke]]
kind = "strip"
mode = "along"
spine = "spine.csv"
radius = 0.2
support = 0.3
distance = 0.2
[mask]
vertices = "weights.csv"
[output]
mesh = "out.ply"
"#;

/// The recipe with all its files.
fn folder() -> Folder {
    let folder = Folder::with(&[]);
    fs::create_dir_all(folder.path("recipes/data")).unwrap();
    for (name, text) in [
        ("press.toml", RECIPE),
        ("data/hare.obj", TETRAHEDRON),
        ("data/king.obj", TETRAHEDRON),
        ("spine.csv", "-1,0,0\n1,0,0\n"),
        ("weights.csv", "0\n1\n0.5\n0\n"),
    ] {
        fs::write(folder.path("recipes").join(name), text).unwrap();
    }
    folder
}

/// Renames a file, runs the recipe, and expects an error that begins with `start` and ends with
/// `end`.
#[track_caller]
fn expect_missing(from: &str, to: &str, start: &str, end: &str) {
    let folder = folder();
    fs::rename(folder.path("recipes").join(from), folder.path("recipes").join(to)).unwrap();
    let before = folder.contents();
    let start = format!("error: recipes/press.toml: {start}: recipes/{from}: ");
    folder.run(&["run", "recipes/press.toml"]).expect_error(2, &[&start, &format!("{end}\n")]);
    assert_eq!(folder.contents(), before);
}

#[test]
fn errors_suggest_the_most_similar_file() {
    folder().run(&["run", "recipes/press.toml"]).expect(0);
    let similar = |name: &str| format!("; paths are relative to the recipe; did you mean `{name}`?");
    expect_missing("data/hare.obj", "data/hair.obj", "line 2: target.mesh", &similar("data/hair.obj"));
    expect_missing("data/hare.obj", "data/hare.ply", "line 2: target.mesh", &similar("data/hare.ply"));
    let tool = "line 4: tools.king.shape.mesh";
    expect_missing("data/king.obj", "data/knig.obj", tool, &similar("data/knig.obj"));
    expect_missing("spine.csv", "spline.csv", "line 13: stroke.1.spine", &similar("spline.csv"));
    expect_missing("weights.csv", "weight.csv", "line 18: mask.vertices", &similar("weight.csv"));
}

#[test]
fn errors_suggest_only_files_that_could_be_meant() {
    let end = "; paths are relative to the recipe";
    expect_missing("data/hare.obj", "data/planet.obj", "line 2: target.mesh", end);
    expect_missing("data/hare.obj", "data/hare.txt", "line 2: target.mesh", end);
    expect_missing("data/hare.obj", "hare.obj", "line 2: target.mesh", end);
    expect_missing("spine.csv", "spine.toml", "line 13: stroke.1.spine", end);
}

#[test]
fn errors_name_the_setting_that_names_the_file() {
    let folder = folder();
    let run = |setting: &str| folder.run(&["run", "recipes/press.toml", "--set", setting]);
    run("target.mesh=hare.obj").expect_error(
        2,
        &[
            "press.toml: --set target.mesh=hare.obj: target.mesh: recipes/hare.obj: ",
            "; paths are relative to the recipe\n",
        ],
    );
    let absent = folder.path("absent.obj");
    let run = run(&format!("target.mesh='{}'", absent.display())).expect(2);
    assert!(!run.stderr.contains("relative to the recipe"), "an absolute path: {}", run.stderr);
}

#[test]
fn streams_name_the_recipe_too() {
    let text = RECIPE.replace("data/hare.obj", "points.ply").replace("[mask]\nvertices = \"weights.csv\"\n", "");
    let folder = folder();
    fs::write(folder.path("recipes/press.toml"), text).unwrap();
    fs::write(folder.path("recipes/point.ply"), "").unwrap();
    folder.run(&["run", "recipes/press.toml", "--stream"]).expect_error(
        2,
        &["recipes/press.toml: line 2: target.mesh: recipes/points.ply: ", "; did you mean `point.ply`?"],
    );
}

#[test]
fn json_has_the_line_of_the_key() {
    let folder = folder();
    let error = |arguments: &[&str]| -> serde_json::Value {
        let run = folder.run(&[&["run", "recipes/press.toml", "--json"], arguments].concat()).expect(2);
        serde_json::from_str(&run.stderr).unwrap()
    };
    fs::remove_file(folder.path("recipes/data/king.obj")).unwrap();
    let missing = error(&[]);
    assert_eq!(missing["file"], "recipes/press.toml");
    assert_eq!((missing["line"].as_u64(), missing["key"].as_str()), (Some(4), Some("tools.king.shape.mesh")));
    // The line of the recipe is not one of an invalid mesh.
    fs::write(folder.path("recipes/data/king.obj"), "v 0 0\n").unwrap();
    let invalid = error(&[]);
    assert_eq!((invalid["file"].as_str(), invalid["line"].as_u64()), (Some("recipes/data/king.obj"), None));
    assert_eq!(invalid["key"], "tools.king.shape.mesh");
}
