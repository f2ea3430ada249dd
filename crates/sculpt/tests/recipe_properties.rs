//! Recipes of any content are written and read back without loss; texts of any content are read without panic.

use isochore_sculpt::recipe::{
    Bend, Format, Key, Move, Override, Profile, Radius, Recipe, Ring, Sphere, SpinePoints, Stamp, Strip, StripMode,
    Stroke, Tool, ToolShape, Twist,
};
use proptest::{
    array::{uniform2, uniform3},
    collection::vec,
    prelude::*,
};

const TEXT: &str = r#"recipe = 1
[target]
shape = { kind = "icosphere", radius = 1.0, subdivisions = 2 }
transform = { scale = 2.0, rotate = [0, 0, 1, 90.0] }
[tools.ball]
shape = { kind = "sphere", radius = 0.4 }
support = 0.3
[[stroke]]
kind = "move"
tool = "ball"
keys = [ { at = [0, 0, 1.8] }, { at = [0, 0, 0.9], rotate = [0, 0, 1, 30.0] } ]
[[stroke]]
kind = "twist"
origin = [0, 0, 0]
axis = [0, 0, 1]
degrees_per_unit = 90.0
[output]
mesh = "out.glb"
"#;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1e3..1e3_f64, -1e300..1e300_f64, Just(5e-324), Just(0.1 + 0.2), Just(3.0)]
}

fn length() -> impl Strategy<Value = f64> {
    prop_oneof![1e-300..1e300_f64, Just(5e-324), Just(0.1 + 0.2), Just(3.0)]
}

fn stroke() -> impl Strategy<Value = Stroke> {
    // An axis with a part along z has a direction; keys with one rotation for all are never half a turn apart.
    let axis = (uniform3(-1.0..1.0_f64)).prop_map(|[x, y, z]| [x, y, 1.0 + z.abs()]);
    prop_oneof![
        ("[a-c]", vec(uniform3(number()), 2..5)).prop_map(|(tool, places)| {
            let keys = places.into_iter().map(|at| Key { at, rotate: [0.0, 1.0, 1.0, 0.1] }).collect();
            Stroke::Move(Move { tool, keys })
        }),
        (uniform3(number()), axis.clone(), number())
            .prop_map(|(origin, axis, degrees_per_unit)| Stroke::Twist(Twist { origin, axis, degrees_per_unit })),
        (uniform3(number()), axis, number()).prop_map(|(origin, axis, degrees_per_unit2)| Stroke::Bend(Bend {
            origin,
            axis,
            degrees_per_unit2
        })),
        ("[a-c]", vec(uniform3(number()), 2..5), proptest::option::of(length())).prop_map(|(tool, places, relief)| {
            let keys = places.into_iter().map(|at| Key { at, rotate: [0.0, 1.0, 1.0, 0.1] }).collect();
            Stroke::Stamp(Stamp { tool, keys, relief })
        }),
        strip(),
        (uniform3(number()), length(), length(), length(), number()).prop_map(
            |(center, major, minor, support, distance)| {
                let axis = [0.0, 0.0, 1.0];
                Stroke::Ring(Ring { center, axis, major, minor, support, distance, profile: Profile::Septic })
            }
        ),
    ]
}

fn strip() -> impl Strategy<Value = Stroke> {
    let spine = || {
        prop_oneof![
            "[ -~ä]{1,8}".prop_map(SpinePoints::File),
            [uniform3(number()), uniform3(number())].prop_map(|points| SpinePoints::Points(points.to_vec())),
        ]
    };
    let shape = prop_oneof![
        (length(), length()).prop_map(|(radius, support)| (Some(Radius::Constant(radius)), None, None, Some(support))),
        (vec(length(), 1..4), length()).prop_map(|(radii, support)| (
            Some(Radius::Varying(radii)),
            None,
            None,
            Some(support)
        )),
        (vec(uniform2(number()), 3..5), length()).prop_map(|(section, support)| (
            None,
            Some(section),
            None,
            Some(support)
        )),
        "[ac]".prop_map(|tool| (None, None, Some(tool), None)),
    ];
    (spine(), proptest::option::of(spine()), shape, any::<bool>(), number()).prop_map(
        |(spine, spine_end, (radius, section, tool, support), is_along, distance)| {
            let (mode, direction) =
                if is_along { (StripMode::Along, None) } else { (StripMode::Across, Some([0.0, 0.5, 1.0])) };
            let reference = section.as_ref().map(|_| [1.0, 0.0, 0.0]);
            let profile = support.map(|_| Profile::Contact);
            Stroke::Strip(Strip {
                mode,
                spine,
                spine_end,
                radius,
                section,
                reference,
                tool,
                support,
                profile,
                distance,
                direction,
            })
        },
    )
}

fn recipe() -> impl Strategy<Value = Recipe> {
    let sections = (length(), any::<bool>(), length(), proptest::option::of(length()), any::<bool>());
    (vec(stroke(), 0..6), length(), length(), "[ -~äß\n\"]{0,12}", sections).prop_map(
        |(strokes, radius, support, name, (step, enabled, deviation, promise, lock))| {
            let mut recipe = Recipe::parse("recipe = 1\ntarget = { mesh = \"a\" }", Format::Toml, &[]).unwrap();
            for (tool, profile) in [("a", Profile::Quintic), ("b", Profile::Thesis), ("c", Profile::Contact)] {
                let shape = ToolShape::Sphere(Sphere { radius });
                recipe.tools.insert(tool.to_owned(), Tool { shape, support, profile, free_form: 0.0 });
            }
            recipe.strokes = strokes;
            recipe.target.mesh = Some(name.clone());
            recipe.output.mesh = Some(name);
            recipe.integrate.step = step.min(1.0);
            recipe.refine.enabled = enabled;
            recipe.refine.deviation = deviation;
            recipe.promise.volume = promise;
            recipe.volume.lock = lock;
            recipe
        },
    )
}

proptest! {
    #[test]
    fn nothing_is_lost(recipe in recipe()) {
        prop_assert_eq!(&Recipe::parse(&recipe.to_toml(), Format::Toml, &[]).unwrap(), &recipe);
        prop_assert_eq!(&Recipe::parse(&recipe.to_json(), Format::Json, &[]).unwrap(), &recipe);
    }

    #[test]
    fn damaged_texts_are_read_or_refused_in_one_line(
        damages in vec((0..TEXT.len(), 0..8_usize, "[ -~\n]{0,4}"), 1..4),
        is_json in any::<bool>(),
    ) {
        let recipe = Recipe::parse(TEXT, Format::Toml, &[]).unwrap();
        let (mut text, format) = match is_json {
            true => (recipe.to_json(), Format::Json),
            false => (TEXT.to_owned(), Format::Toml),
        };
        for (start, length, insert) in damages {
            let start = start.min(text.len());
            let end = (start + length).min(text.len());
            text.replace_range(start..end, &insert);
        }
        if let Err(error) = Recipe::parse(&text, format, &[]) {
            prop_assert!(!error.to_string().contains('\n'), "{}", error);
        }
    }

    #[test]
    fn overrides_of_any_content_do_not_panic(text in "[a-z.]{0,12}=?[ -~]{0,12}") {
        if let Ok(setting) = Override::parse(&text) {
            let _ = Recipe::parse(TEXT, Format::Toml, &[setting]);
        }
    }
}
