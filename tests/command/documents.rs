//! The recipes that the documents print.

use std::{fs, path::Path};

use crate::folder::Folder;

/// Runs the recipe of a document beside a copy of its target, as a reader would.
fn run_recipe_of(document: &str) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = fs::read_to_string(root.join(document)).unwrap();
    let recipe = text.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let folder = Folder::with(&[("press.toml", recipe)]);
    fs::create_dir(folder.path("data")).unwrap();
    fs::copy(root.join("data/hare.obj"), folder.path("data/hare.obj")).unwrap();
    folder.run(&["run", "press.toml"]).expect(0);
    let report = folder.json("report.json");
    assert_eq!(report["warnings"].as_array().map(Vec::len), Some(0), "{document}: {report}");
    assert!(report["moved_vertices"].as_u64().unwrap() > 1000, "{document}: {report}");
    assert!(folder.path("pressed.obj").is_file() && folder.path("pressed.png").is_file());
}

#[test]
fn the_recipe_of_the_readme_runs_without_warnings() {
    run_recipe_of("README.md");
}

#[test]
fn the_recipe_of_the_guide_runs_without_warnings() {
    run_recipe_of("docs/src/first-run.md");
}
