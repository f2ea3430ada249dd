//! Files that a recipe names.
#![cfg(feature = "io")]

use std::path::Path;

use isochore_mesh::primitives;
use isochore_sculpt::{
    Recipe, Source,
    files::{FileProblem, LoadError, NamedFile, TargetMesh, load},
    recipe::{Format, SpinePoints, Stroke, VertexWeights},
};

const TEXT: &str = r#"recipe = 1
target = { mesh = "target.obj" }
[tools.king]
shape = { kind = "mesh", mesh = "king.obj", resolution = 16 }
support = 0.3
[tools.unused]
shape = { kind = "mesh", mesh = "unused.obj", resolution = 16 }
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
"#;

const TETRAHEDRON: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

fn recipe() -> Recipe {
    Recipe::parse(TEXT, Format::Toml, &[]).unwrap()
}

fn file(name: &str) -> Option<NamedFile<'static>> {
    match name {
        "target.obj" => Some(NamedFile::Bytes(TETRAHEDRON)),
        "king.obj" => Some(NamedFile::Mesh(primitives::icosphere(0.2, 1).into())),
        "spine.csv" => Some(NamedFile::Bytes(b"x,y,z\n-1,0,0\n1,0,0\n")),
        "weights.csv" => Some(NamedFile::Bytes(b"0\n1\n0.5\n0\n")),
        _ => None,
    }
}

/// The error if the file `name` is replaced.
fn error(name: &str, replacement: Option<NamedFile<'static>>) -> LoadError {
    let resolve = |other: &str| if other == name { replacement.clone() } else { file(other) };
    load(&mut recipe(), TargetMesh::Required, &resolve).unwrap_err()
}

#[test]
fn loads_what_strokes_use_and_replaces_names() {
    let mut recipe = recipe();
    assert_eq!(recipe.file_names(), ["king.obj", "spine.csv", "target.obj", "weights.csv"]);
    let meshes = load(&mut recipe, TargetMesh::Required, &file).unwrap();
    assert_eq!(meshes.keys().collect::<Vec<_>>(), ["king.obj", "target.obj"]);
    assert_eq!(recipe.mask.vertices, Some(VertexWeights::Values(vec![0.0, 1.0, 0.5, 0.0])));
    let Stroke::Strip(strip) = &recipe.strokes[1] else { panic!("{:?}", recipe.strokes[1]) };
    assert_eq!(strip.spine, SpinePoints::Points(vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]));
}

#[test]
fn the_target_can_be_optional_or_skipped() {
    let without_target = |name: &str| if name == "target.obj" { None } else { file(name) };
    let names = |target, resolve: &dyn Fn(&str) -> Option<NamedFile<'static>>| {
        load(&mut recipe(), target, resolve).map(|meshes| meshes.into_keys().collect::<Vec<_>>())
    };
    assert_eq!(names(TargetMesh::Optional, &without_target).unwrap(), ["king.obj"]);
    assert_eq!(names(TargetMesh::Optional, &file).unwrap(), ["king.obj", "target.obj"]);
    assert_eq!(names(TargetMesh::Skipped, &file).unwrap(), ["king.obj"]);
    assert_eq!(names(TargetMesh::Required, &without_target).unwrap_err().key, "target.mesh");
}

#[test]
fn errors_name_key_file_and_row() {
    for (name, bytes, message) in [
        (
            "weights.csv",
            &b"0\n1\n"[..],
            "mask.vertices: weights.csv: row 2: this weight is the last: 2 weights for the 4 vertices of the target",
        ),
        (
            "weights.csv",
            b"0\n1\n2\n0\n",
            "mask.vertices: weights.csv: row 3: 2 is not a weight between 0 (free) and 1 (fixed)",
        ),
        ("spine.csv", b"0,0\n", "stroke.1.spine: spine.csv: row 1 has 2 columns; expected 3 or 6"),
        ("king.obj", b"v 0 0\n", "tools.king.shape.mesh: king.obj: line 1"),
    ] {
        let error = error(name, Some(NamedFile::Bytes(bytes)));
        assert!(error.to_string().starts_with(message), "{error}");
        assert_eq!(error.path(), Path::new(name));
    }
    let missing = error("king.obj", None);
    assert_eq!(missing.to_string(), "tools.king.shape.mesh: `king.obj` was not passed in");
    assert!(matches!(*missing.problem, FileProblem::NotGiven));
    let absent = error("spine.csv", Some(NamedFile::Path("absent/spine.csv".into())));
    assert_eq!((absent.key.as_str(), absent.path()), ("stroke.1.spine", Path::new("absent/spine.csv")));
    assert_eq!(absent.io_error().unwrap().kind(), std::io::ErrorKind::NotFound);
}

#[test]
fn errors_name_the_recipe_and_the_line_of_the_key() {
    let absent = || error("spine.csv", Some(NamedFile::Path("absent/spine.csv".into())));
    let message = |overrides: &[String]| {
        let source = Source { text: TEXT.as_bytes(), overrides };
        absent().in_recipe(Path::new("press.toml"), source).to_string()
    };
    assert!(message(&[]).starts_with("press.toml: line 16: stroke.1.spine: absent/spine.csv: "), "{}", message(&[]));
    assert!(message(&[]).ends_with("; paths are relative to the recipe"));
    let setting = ["stroke.1.spine=spine.csv".to_owned()];
    assert!(message(&setting).starts_with("press.toml: --set stroke.1.spine=spine.csv: stroke.1.spine: "));
    assert!(message(&["malformed".to_owned()]).starts_with("press.toml: stroke.1.spine: "), "the line is unknown");
    assert!(!absent().to_string().contains("recipe"), "no file of a recipe is known");
}
