//! `isochore demo`: a first run with built-in meshes.

use std::time::Instant;

use isochore_mesh::io::{self, Format};
use isochore_sculpt::Meshes;

use crate::{
    arguments::DemoArguments, command_error::CommandError, console::Console, job::Job, outcome::Outcome, run::conclude,
    staging::Staging,
};

/// The recipe. Its file names are relative to the demo's folder.
const RECIPE: &str = include_str!("demo/press.toml");
const RECIPE_NAME: &str = "press.toml";

/// The meshes that the recipe names.
const MESHES: [(&str, &[u8]); 2] = [
    ("planet.obj", include_bytes!("../../../data/planet.obj")),
    ("knight.obj", include_bytes!("../../../data/knight.obj")),
];

pub(crate) fn demo(arguments: &DemoArguments, console: &Console) -> Result<Outcome, CommandError> {
    let start = Instant::now();
    let folder = &arguments.output;
    let mut staging = Staging::new(console.interrupt());
    staging.add_folder(folder)?;

    let recipe_path = folder.join(RECIPE_NAME);
    let mut meshes = Meshes::new();
    for (name, bytes) in MESHES {
        let path = folder.join(name);
        let invalid = |error: &dyn std::fmt::Display| CommandError::file(&path, error);
        let format = Format::of_path(&path).ok_or_else(|| invalid(&"unknown mesh format"))?;
        let mesh = io::read_bytes(format, bytes).map_err(|error| invalid(&error))?;
        meshes.insert(name.to_owned(), mesh.into());
        let draft = staging.add_file(&path)?;
        staging.write(&draft, bytes)?;
    }
    let draft = staging.add_file(&recipe_path)?;
    staging.write(&draft, RECIPE.as_bytes())?;

    let job = Job::parse(&recipe_path, RECIPE.as_bytes().to_vec(), &[])?;
    let report = job.execute(meshes, start.elapsed().as_secs_f64(), staging, console)?;
    console.finish();
    if !console.is_json() {
        let first_line = RECIPE.lines().next().unwrap_or_default();
        console.say(first_line.trim_start_matches("# "));
    }
    let outcome = conclude(&report, job.outputs.mesh.as_deref(), console);
    if !console.is_json() {
        let outputs = [&job.outputs.preview, &job.outputs.report];
        for path in outputs.into_iter().flatten() {
            console.say(path.display());
        }
        console.say(format_args!("Edit {0}, then run it again: isochore run {0}", recipe_path.display()));
    }
    Ok(outcome)
}
