//! Recipes of jointed tools and regions: what is refused, and where.

use isochore_sculpt::recipe::{Format, Recipe};

const FULL: &str = r#"recipe = 1
target = { shape = { kind = "icosphere", radius = 1.0, subdivisions = 1 } }
[tools.bone]
shape = { kind = "capsule", radius = 0.1, half_length = 0.2 }
support = 0.2
free_form = 0.5
[tools.other]
shape = { kind = "sphere", radius = 0.1 }
support = 0.2
profile = "septic"
[[stroke]]
kind = "pose"
bones = [
  { name = "upper", tool = "bone", at = [0, 0, 1], joint = [0, 0, 0.8] },
  { name = "lower", tool = "bone", at = [0, 0, 1.4], joint = [0, 0, 1.2], parent = "upper" },
]
keys = [ {}, { root = { at = [0, 0, -0.2] }, lower = { rotate = [1, 0, 0, 60.0] } } ]
[[stroke]]
kind = "region"
motion = { translate = [0, 0, 0.5] }
inner = { kind = "half_space", point = [0, 0, 0], normal = [0, 0, 1] }
outer_distance = 0.5
"#;

#[test]
fn reading_and_writing_back_is_the_identity() {
    let recipe = Recipe::parse(FULL, Format::Toml, &[]).unwrap();
    assert_eq!(Recipe::parse(&recipe.to_toml(), Format::Toml, &[]).unwrap(), recipe);
    assert_eq!(Recipe::parse(&recipe.to_json(), Format::Json, &[]).unwrap(), recipe);
}

#[test]
fn errors_name_key_and_remedy() {
    let cases = [
        ("free_form = 0.5", "free_form = 1.5", "tools.bone.free_form: is 1.5; give 1 or less"),
        (
            "parent = \"upper\"",
            "parent = \"uper\"",
            "stroke.0.bones.1.parent: unknown bone `uper`; did you mean `upper`?",
        ),
        (", parent = \"upper\"", "", "stroke.0.bones.1: has no parent, like `upper`"),
        ("parent = \"upper\"", "parent = \"lower\"", "stroke.0.bones.1.parent: leads to a cycle: lower, lower"),
        (
            "tool = \"bone\", at = [0, 0, 1.4]",
            "tool = \"other\", at = [0, 0, 1.4]",
            "stroke.0.bones.1.tool: its profile septic differs",
        ),
        ("name = \"lower\"", "name = \"upper\"", "stroke.0.bones.1.name: there is already a bone `upper`"),
        ("name = \"lower\"", "name = \"root\"", "stroke.0.bones.1.name: `root` names the whole tool"),
        ("lower = { rotate", "lover = { rotate", "stroke.0.keys.1.lover: unknown bone `lover`; did you mean `lower`?"),
        (
            "lower = { rotate",
            "lower = { at = [0, 0, 0], rotate",
            "stroke.0.keys.1.lower.at: only `root` has a position",
        ),
        ("60.0", "180.0", "stroke.0.keys.1.lower.rotate: rotates by exactly 180 degrees"),
        ("keys = [ {}, ", "keys = [ ", "stroke.0.keys: has 1 poses; a motion needs at least 2"),
        ("translate = [0, 0, 0.5]", "", "stroke.1.motion: names neither `translate` nor `rotate`"),
        ("half_space", "halfspace", "stroke.1.inner.kind: unknown value `halfspace`; did you mean `half_space`?"),
        ("normal = [0, 0, 1]", "normal = [0, 0, 0]", "stroke.1.inner.normal: has length zero"),
        ("outer_distance = 0.5", "outer_distance = 0", "stroke.1.outer_distance: is 0; give a number above 0"),
        ("outer_distance = 0.5", "outer_distance = 0.5\nprofile = \"thesis\"", "stroke.1.profile: `thesis` has a kink"),
    ];
    for (from, to, expected) in cases {
        assert!(FULL.contains(from), "{from}");
        let error = Recipe::parse(&FULL.replacen(from, to, 1), Format::Toml, &[]).expect_err(to).to_string();
        assert!(error.contains(expected), "{error}");
    }
}
