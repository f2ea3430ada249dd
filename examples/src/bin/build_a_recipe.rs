//! Builds a recipe in code, replays it and prints its report.

#![expect(clippy::print_stdout, reason = "the measurements are the result")]

use std::{collections::BTreeMap, error::Error, fs};

use isochore_examples::{folder, save_mesh};
use isochore_mesh::NoProgress;
use isochore_sculpt::{
    Meshes, Recipe, Report, Source,
    recipe::{Icosphere, Key, Move, Promise, Sphere, Stroke, Target, TargetShape, Tool, ToolShape, Twist},
    replay,
};

fn main() -> Result<(), Box<dyn Error>> {
    let key = |at| Key { at, rotate: [0.0, 0.0, 1.0, 0.0] };
    let ball = Tool {
        shape: ToolShape::Sphere(Sphere { radius: 0.4 }),
        support: 0.3,
        profile: Default::default(),
        free_form: 0.0,
    };
    let recipe = Recipe {
        recipe: 1,
        target: Target {
            shape: Some(TargetShape::Icosphere(Icosphere { radius: 1.0, subdivisions: 4 })),
            ..Target::default()
        },
        tools: BTreeMap::from([("ball".to_owned(), ball)]),
        strokes: vec![
            Stroke::Move(Move { tool: "ball".to_owned(), keys: vec![key([0.0, 0.0, 1.8]), key([0.0, 0.0, 1.1])] }),
            Stroke::Twist(Twist { origin: [0.0; 3], axis: [0.0, 0.0, 1.0], degrees_per_unit: 40.0 }),
        ],
        promise: Promise { volume: Some(1e-9), ..Promise::default() },
        integrate: Default::default(),
        refine: Default::default(),
        volume: Default::default(),
        mask: Default::default(),
        output: Default::default(),
    };
    // The text form reads back to an equal recipe; `isochore run` accepts it.
    let text = recipe.to_toml();
    let path = folder()?.join("build_a_recipe.toml");
    fs::write(&path, &text)?;
    println!("{}", path.display());

    let replay = replay(&recipe, &Meshes::new(), &NoProgress)?;
    let source = Source { text: text.as_bytes(), overrides: &[] };
    let report = Report::new(&recipe, source, &replay, &replay.deformed.mesh, &NoProgress)?;
    for stroke in &report.strokes {
        println!("{}: {} vertices moved, {} inserted", stroke.kind, stroke.moved, stroke.inserted);
    }
    println!("triangles: {} before, {} after", report.before.triangles, report.after.triangles);
    println!("relative change of volume: {:+.1e}", report.volume_change.unwrap_or(f64::NAN));
    println!("promises kept: {:?}", report.promises);
    save_mesh("build_a_recipe", &replay.deformed.mesh)
}
