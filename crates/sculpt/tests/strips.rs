//! Strips and rings in recipes.

use isochore_mesh::NoProgress;
use isochore_sculpt::{
    Meshes, Recipe, Report, SceneError, Source,
    recipe::{Format, RecipeError},
    replay, replay_points,
};

const RECIPE: &str = r#"recipe = 1
target = { shape = { kind = "icosphere", radius = 1.0, subdivisions = 3 } }
[tools.ball]
shape = { kind = "sphere", radius = 0.9 }
support = 0.2
[[stroke]]
kind = "strip"
mode = "along"
spine = [[-2, 0, 0.9], [0, 0, 0.8], [2, 0, 0.9]]
radius = 0.2
support = 0.3
distance = 0.2
[[stroke]]
kind = "strip"
mode = "across"
spine = [[-2, 0.3, 0], [0, 0.2, 0], [2, 0.3, 0]]
spine_end = [[-2, 0.4, 0], [0, 0.3, 0], [2, 0.4, 0]]
section = [[-0.1, -0.2], [0.1, -0.2], [0.1, 0.2], [-0.1, 0.2]]
reference = [0, 0, 1]
support = 0.3
profile = "septic"
distance = 0.1
direction = [0, 0, 1]
[[stroke]]
kind = "strip"
mode = "along"
spine = [[-2, 0, 0], [2, 0, 0]]
tool = "ball"
distance = 0.1
[[stroke]]
kind = "strip"
mode = "across"
spine = [[-3, 0, 0.7], [3, 0, 0.7]]
radius = [0.1, 0.3, 0.1]
support = 0.3
distance = 0.1
direction = [0, 1, 1]
[[stroke]]
kind = "ring"
center = [0, 0, 1]
axis = [0, 0, 2]
major = 0.6
minor = 0.2
support = 0.3
distance = -0.1
"#;

fn read(text: &str) -> Result<Recipe, RecipeError> {
    Recipe::parse(text, Format::Toml, &[])
}

/// The error of the recipe with the first `from`, which must occur, replaced.
fn error_of(from: &str, to: &str) -> String {
    assert!(RECIPE.contains(from), "{from}");
    read(&RECIPE.replacen(from, to, 1)).expect_err(to).to_string()
}

#[test]
fn writing_and_reading_back_is_the_identity() {
    let recipe = read(RECIPE).unwrap();
    assert_eq!(Recipe::parse(&recipe.to_toml(), Format::Toml, &[]).unwrap(), recipe);
    assert_eq!(Recipe::parse(&recipe.to_json(), Format::Json, &[]).unwrap(), recipe);
}

#[test]
fn errors_name_line_key_and_remedy() {
    let spine = "spine = [[-2, 0, 0.9], [0, 0, 0.8], [2, 0, 0.9]]";
    for (from, to, words) in [
        ("radius = 0.2\n", "", "stroke.0: has no cross-section; add one of radius, section and tool"),
        (
            "radius = 0.2\n",
            "radius = 0.2\ntool = \"ball\"\n",
            "stroke.0: has more than one of radius, section and tool",
        ),
        ("radius = 0.2\n", "radius = -1\n", "line 10: stroke.0.radius: is -1; give a number above 0"),
        ("radius = 0.2\n", "radius = [0.2, 0]\n", "line 10: stroke.0.radius.1: is 0; give a number above 0"),
        ("radius = 0.2\n", "radius = []\n", "line 10: stroke.0.radius: has 0 entries; give at least 1"),
        (
            "radius = 0.2\n",
            "radius = \"a\"\n",
            "line 10: stroke.0.radius: expected a number or a list of numbers, found the text \"a\"",
        ),
        ("support = 0.3\n", "", "stroke.0.support: missing; add it"),
        ("\"along\"", "\"aside\"", "line 8: stroke.0.mode: unknown value `aside`"),
        (spine, "spine = [[0, 0, 0]]", "line 9: stroke.0.spine: has 1 entries; give at least 2"),
        (spine, "spine = [[0, 0, 0], [1, 0]]", "line 9: stroke.0.spine.1: expected 3 entries, found 2"),
        (spine, "spine = [[0, 0, 0], [nan, 0, 1]]", "line 9: stroke.0.spine.1: is NaN; give a finite number"),
        (spine, "spine = 3", "line 9: stroke.0.spine: expected a list of points or the name of a file, found 3"),
        (
            "distance = 0.2",
            "distance = 0.2\ndirection = [0, 0, 1]",
            "stroke.0.direction: applies only to mode = \"across\"; remove it",
        ),
        ("direction = [0, 0, 1]\n", "", "stroke.1.direction: missing; add it"),
        (
            "spine_end = [[-2, 0.4, 0], ",
            "spine_end = [",
            "stroke.1.spine_end: has 2 points, but `spine` has 3; give as many",
        ),
        ("\"septic\"", "\"thesis\"", "stroke.1.profile: `thesis` has a kink at the surface"),
        ("tool = \"ball\"", "tool = \"bell\"", "stroke.2.tool: unknown tool `bell`; did you mean `ball`?"),
        ("tool = \"ball\"", "tool = \"ball\"\nsupport = 1", "stroke.2.support: is determined by the tool; remove it"),
        (
            "tool = \"ball\"",
            "tool = \"ball\"\nreference = [0, 0, 1]",
            "stroke.2.reference: applies only to strips with a section",
        ),
        ("axis = [0, 0, 2]", "axis = [0, 0, 0]", "stroke.4.axis: has length zero"),
    ] {
        let error = error_of(from, to);
        assert!(error.contains(words), "{error}\n{words}");
    }
}

#[test]
fn impossible_strips_name_the_stroke_and_both_lengths() {
    for (from, to, words) in [
        (
            "radius = 0.2\n",
            "radius = 30\n",
            "stroke.0: the field reaches 30.300000 from the spine, but the spine allows only",
        ),
        (
            "spine = [[-3, 0, 0.7], [3, 0, 0.7]]",
            "spine = [[0, 0, 0], [1, 0, 0]]",
            "stroke.3: the spine is 1.000000 long",
        ),
        ("minor = 0.2", "minor = 0.3", "stroke.4: minor radius and support, 0.6 together, reach the axis of the ring"),
        ("[[-2, 0, 0.9], [0, 0, 0.8]", "[[0, 0, 0.8], [0, 0, 0.8]", "stroke.0: the spine: points 0 and 1 coincide"),
    ] {
        let recipe = read(&RECIPE.replacen(from, to, 1)).unwrap();
        let error = replay_points(&recipe, &Meshes::new(), &[], &NoProgress).unwrap_err();
        assert!(error.to_string().starts_with(words), "{error}");
        assert_eq!(error.key().as_deref(), words.split(':').next());
    }
}

#[test]
fn curves_are_put_in_by_name() {
    let points = [[-2.0, 0.0, 0.9], [0.0, 0.0, 0.8], [2.0, 0.0, 0.9]];
    let text = RECIPE.replacen("[[-2, 0, 0.9], [0, 0, 0.8], [2, 0, 0.9]]", "\"spine.csv\"", 1);
    let mut recipe = read(&text).unwrap();
    assert_eq!(recipe.curve_names(), ["spine.csv"]);
    let error = replay_points(&recipe, &Meshes::new(), &[], &NoProgress).unwrap_err();
    assert!(matches!(error, SceneError::MissingCurve { name } if name == "spine.csv"));
    recipe.inline_curve("spine.csv", &points);
    assert_eq!(recipe, read(RECIPE).unwrap());
    assert!(recipe.curve_names().is_empty());
}

#[test]
fn strips_and_rings_keep_the_volume() {
    let recipe = read(&format!("{RECIPE}[volume]\nlock = false\n")).unwrap();
    let replay = replay(&recipe, &Meshes::new(), &NoProgress).unwrap();
    let source = Source { text: RECIPE.as_bytes(), overrides: &[] };
    let report = Report::new(&recipe, source, &replay, &replay.deformed.mesh, &NoProgress).unwrap();
    let kinds: Vec<&str> = report.strokes.iter().map(|stroke| stroke.kind.as_str()).collect();
    assert_eq!(kinds, ["strip", "strip", "strip", "strip", "ring"]);
    assert!(report.strokes.iter().all(|stroke| stroke.evaluations > 100 && stroke.moved > 10));
    // Refinement aims at 1e-4 by an estimate.
    assert!(report.volume_change.unwrap().abs() < 3e-4, "{:?}", report.volume_change);
}
