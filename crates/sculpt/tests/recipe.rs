//! Reading, checking and writing recipes.

use glam::DVec3;
use isochore_sculpt::recipe::{Format, Key, Location, Override, Recipe, RecipeError};

/// A recipe that uses every key that exists.
const FULL: &str = r#"recipe = 1

[target]
mesh = "bunny.obj"
transform = { scale = 2.0, rotate = [0, 0, 1, 90.0], translate = [1, 0, 0.1] }

[tools.ball]
shape = { kind = "sphere", radius = 0.4 }
support = 0.3
profile = "septic"

[tools.king]
support = 0.1
shape = { mesh = "king.obj", resolution = 64, transform = { scale = 0.5 }, kind = "mesh" }

[tools."a.b"]
support = 0.1
shape = { kind = "box", half_extents = [1, 1, 1], rounding = 0.1 }

[[stroke]]
kind = "move"
tool = "ball"
keys = [ { at = [0, 0, 1.8] }, { at = [0, 0, 0.9], rotate = [0, 0, 1, 30.0] } ]

[[stroke]]
origin = [0, 0, 0]
axis = [0, 0, 1]
degrees_per_unit = 90.0
kind = "twist"

[[stroke]]
kind = "bend"
origin = [0, 0, 0]
axis = [0, 0, 1]
degrees_per_unit2 = 60.0

[integrate]
step = 0.25
[refine]
enabled = true
volume = 1e-5
deviation = 1e-4
max_edge = 0.05
max_triangles = 1000
[promise]
volume = 0.005
no_new_self_intersections = true
[volume]
lock = false
[output]
mesh = "out.glb"
report = "report.json"
preview = "out.png"
frames = { count = 24, directory = "frames" }
"#;

fn read(text: &str) -> Result<Recipe, RecipeError> {
    Recipe::parse(text, Format::Toml, &[])
}

/// `FULL` with `from`, which must occur, replaced.
fn error_of(from: &str, to: &str) -> RecipeError {
    assert!(FULL.contains(from), "{from}");
    read(&FULL.replace(from, to)).expect_err(to)
}

#[test]
fn writing_and_reading_back_is_the_identity() {
    let recipe = read(FULL).unwrap();
    assert_eq!(Recipe::parse(&recipe.to_toml(), Format::Toml, &[]).unwrap(), recipe);
    assert_eq!(Recipe::parse(&recipe.to_json(), Format::Json, &[]).unwrap(), recipe);
    let value = serde_json::to_value(&recipe).unwrap();
    assert_eq!(serde_json::from_value::<Recipe>(value).unwrap(), recipe, "keys in order of name");
    assert_eq!(toml::from_str::<Recipe>(&recipe.to_toml()).unwrap(), recipe);
    let short = read("recipe = 1\n[target]\nshape = { kind = \"icosphere\", radius = 0.1, subdivisions = 2 }").unwrap();
    assert_eq!(Recipe::parse(&short.to_toml(), Format::Toml, &[]).unwrap(), short);
}

#[test]
fn defaults_are_those_that_are_promised() {
    let recipe = read("recipe = 1\ntarget = { mesh = \"a.obj\" }").unwrap();
    assert_eq!(recipe.integrate.step, 0.125);
    assert!(recipe.refine.enabled && recipe.volume.lock);
    assert_eq!((recipe.refine.volume, recipe.refine.deviation), (None, 1e-3));
    assert_eq!((recipe.refine.max_edge, recipe.refine.max_triangles), (None, 2_000_000));
    let promise = recipe.promise;
    assert_eq!(promise.volume, None);
    assert!(promise.no_new_self_intersections && promise.positive_jacobian);
    assert!(promise.lock_within_half_edge && promise.strokes_completed);
}

#[test]
fn errors_name_line_key_and_remedy() {
    let cases = [
        ("support = 0.3", "support = -0.3", "line 9: tools.ball.support: is -0.3; give a number above 0"),
        ("support = 0.3", "suport = 0.3", "line 9: tools.ball.suport: unknown key; did you mean `support`?"),
        ("\"septic\"", "\"sceptic\"", "line 10: tools.ball.profile: unknown value `sceptic`; did you mean `septic`?"),
        ("radius = 0.4", "radius = nan", "line 8: tools.ball.shape.radius: is NaN; give a finite number"),
        (
            "radius = 0.4",
            "radius = \"big\"",
            "line 8: tools.ball.shape.radius: expected a number, found the text \"big\"",
        ),
        ("radius = 0.4", "raduis = 0.4", "line 8: tools.ball.shape.raduis: unknown key; did you mean `radius`?"),
        (", radius = 0.4", "", "line 8: tools.ball.shape.radius: missing; add it"),
        ("resolution = 64", "resolution = 1", "line 14: tools.king.shape.resolution: is 1; give at least 4"),
        ("rounding = 0.1", "rounding = 2", "line 18: tools.a.b.shape.rounding: is 2, more than"),
        ("tool = \"ball\"", "tool = \"bal\"", "line 22: stroke.0.tool: unknown tool `bal`; did you mean `ball`?"),
        ("{ at = [0, 0, 1.8] }, ", "", "line 23: stroke.0.keys: has 1 poses; a motion needs at least 2"),
        ("30.0]", "180]", "line 23: stroke.0.keys.1.rotate: rotates by exactly 180 degrees"),
        ("at = [0, 0, 1.8]", "at = [0, 0]", "line 23: stroke.0.keys.0.at: expected 3 entries, found 2"),
        (
            "axis = [0, 0, 1]\ndegrees_per_unit ",
            "axis = [0, 0, 0]\ndegrees_per_unit ",
            "line 27: stroke.1.axis: has length zero",
        ),
        (
            "kind = \"twist\"",
            "kind = \"twirl\"",
            "line 29: stroke.1.kind: unknown value `twirl`; did you mean `twist`?",
        ),
        ("kind = \"twist\"", "", "line 25: stroke.1.kind: missing; add it"),
        (
            "kind = \"bend\"",
            "kind = \"quux\"",
            "line 32: stroke.2.kind: unknown value `quux`; valid choices: move, twist, bend, stamp, strip, ring, pose, region",
        ),
        ("[integrate]", "[intergrate]", "line 37: intergrate: unknown key; did you mean `integrate`?"),
        ("scale = 2.0", "scale = 0", "line 5: target.transform.scale: is 0; give a number above 0"),
        ("mesh = \"bunny.obj\"", "", "line 3: target: names neither a mesh nor a shape"),
        (
            "mesh = \"bunny.obj\"",
            "mesh = \"bunny.obj\"\nshape = { kind = \"icosphere\", radius = 1, subdivisions = 1 }",
            "line 3: target: names both a mesh and a shape",
        ),
        (
            "mesh = \"bunny.obj\"",
            "shape = { kind = \"icosphere\", radius = 1, subdivisions = 14 }",
            "line 4: target.shape.subdivisions: asks for 5368709120 triangles, more than",
        ),
        ("recipe = 1", "recipe = 2", "line 1: recipe: unknown version 2"),
        ("recipe = 1", "", "recipe: missing; add it"),
        ("step = 0.25", "step = ", "line 38: "),
        ("count = 24", "count = -1", "line 54: output.frames.count: expected a whole number, found -1"),
    ];
    for (from, to, expected) in cases {
        let text = error_of(from, to).to_string();
        assert!(text.starts_with(expected), "{from} -> {to}\n{text}\n{expected}");
        assert!(!text.contains('\n'), "{text}");
    }
}

#[test]
fn json_errors_name_the_line_too() {
    let json = read(FULL).unwrap().to_json();
    let line = 1 + json.lines().position(|line| line.contains("\"support\": 0.3")).unwrap();
    let error = Recipe::parse(&json.replace("\"support\": 0.3", "\"suport\": 0.3"), Format::Json, &[]).unwrap_err();
    assert_eq!(error.location, Location::Line(line));
    assert_eq!(error.key, "tools.ball.suport");
    assert!(Recipe::parse("{ \"recipe\": 1, ", Format::Json, &[]).is_err());
    assert!(Recipe::parse("", Format::Json, &[]).is_err());
    let twice = Recipe::parse("{\n \"recipe\": 1,\n \"recipe\": 1 }", Format::Json, &[]).unwrap_err();
    assert_eq!(twice.location, Location::Line(3));
}

#[test]
fn overrides_win_and_are_typed() {
    let set = |texts: &[&str]| {
        let overrides: Vec<Override> = texts.iter().map(|text| Override::parse(text).unwrap()).collect();
        Recipe::parse(FULL, Format::Toml, &overrides)
    };
    let recipe = set(&[
        "tools.ball.support=0.5",
        "tools.ball.profile = contact",
        "tools.\"a.b\".support=0.25",
        "stroke.2.degrees_per_unit2 = 45",
        "target.mesh='my mesh.obj'",
        "output={ mesh = \"b.ply\" }",
        "refine.enabled=false",
    ])
    .unwrap();
    assert_eq!(recipe.tools["ball"].support, 0.5);
    assert_eq!(recipe.tools["ball"].profile.to_string(), "contact");
    assert_eq!(recipe.tools["a.b"].support, 0.25);
    assert_eq!(recipe.target.mesh.as_deref(), Some("my mesh.obj"));
    assert_eq!((recipe.output.mesh.as_deref(), &recipe.output.report), (Some("b.ply"), &None));
    assert!(!recipe.refine.enabled);

    let message = |text: &str| set(&[text]).unwrap_err().to_string();
    assert_eq!(
        message("tools.ball.suport=1"),
        "--set tools.ball.suport=1: tools.ball.suport: unknown key; did you mean `support`?"
    );
    assert!(message("stroke.7.tool=ball").contains("the list has 3"), "{}", message("stroke.7.tool=ball"));
    assert!(message("refine.enabled=flase").contains("expected a boolean, found the text \"flase\""));
    assert!(Override::parse("refine.enabled").is_err());
    assert!(Override::parse("refine..enabled=true").is_err());
    assert!(Override::parse("refine.volume=[1").is_err());
}

#[test]
fn a_pose_must_have_numbers_and_an_axis() {
    let key = Key { at: [1.0, 2.0, 3.0], rotate: [0.0, 0.0, 2.0, 90.0] };
    let pose = key.pose().unwrap();
    // The sine of a quarter turn is exact up to rounding.
    assert!(pose.transform(DVec3::X).distance(DVec3::new(1.0, 3.0, 3.0)) < 1e-15);
    let wrong = [
        (Key { rotate: [0.0, 0.0, 0.0, 90.0], ..key.clone() }, "rotate", "has length zero"),
        (Key { rotate: [0.0, 0.0, 1.0, f64::NAN], ..key.clone() }, "rotate", "NaN"),
        (Key { at: [f64::INFINITY, 0.0, 0.0], ..key }, "at", "inf"),
    ];
    for (key, name, words) in wrong {
        let error = key.pose().unwrap_err();
        assert_eq!(error.key, name);
        assert!(error.to_string().contains(words), "{error}");
    }
}
