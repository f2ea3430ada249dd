//! `isochore run`: deforms the target of a recipe.

use std::{path::Path, time::Instant};

use isochore_sculpt::Report;

use crate::{
    arguments::RunArguments, command_error::CommandError, console::Console, job::Job, outcome::Outcome,
    staging::Staging, stream::stream,
};

pub(crate) fn run(arguments: &RunArguments, console: &Console) -> Result<Outcome, CommandError> {
    let start = Instant::now();
    let mut job = Job::read(&arguments.recipe, &arguments.settings)?;
    if let Some(output) = &arguments.output {
        job.outputs.mesh = Some(output.clone());
    }
    if let Some(report) = &arguments.report {
        job.outputs.report = Some(report.clone());
    }
    if job.outputs.mesh.is_none() && job.outputs.report.is_none() && !console.is_json() {
        return Err(CommandError::file(
            &job.path,
            "the recipe requests no output; set output.mesh or pass --output FILE",
        ));
    }
    if arguments.stream {
        return stream(job, console);
    }
    let meshes = job.read_meshes()?;
    let read_seconds = start.elapsed().as_secs_f64();
    let report = job.execute(meshes, read_seconds, Staging::new(console.interrupt()), console)?;
    Ok(conclude(&report, job.outputs.mesh.as_deref(), console))
}

/// Prints the report as JSON or a summary in words, and reports missed promises.
pub(crate) fn conclude(report: &Report, mesh: Option<&Path>, console: &Console) -> Outcome {
    console.finish();
    for warning in &report.warnings {
        console.warn("warning", warning);
    }
    if console.is_json() {
        console.print_json(report);
    } else {
        let name = mesh.map_or("result".to_owned(), |path| path.display().to_string());
        let after = &report.after;
        console.say(format_args!(
            "{name}: {} vertices, {} triangles, {} vertices inserted, {} moved, by at most {:.3e}",
            after.vertices, after.triangles, report.inserted_vertices, report.moved_vertices, report.max_displacement,
        ));
        if let (Some(volume), Some(change)) = (after.volume, report.volume_change) {
            let before_lock = match (report.lock_max_shift, report.volume_change_before_lock) {
                (Some(shift), Some(change)) => {
                    format!(" ({change:+.1e} before the volume lock, which moved vertices by at most {shift:.1e})")
                }
                _ => String::new(),
            };
            console.say(format_args!("volume {volume:.9}, relative change {change:+.1e}{before_lock}"));
        }
    }
    let mut outcome = Outcome::Done;
    for name in report.missed_promises() {
        outcome = Outcome::PromiseMissed;
        let [before, after] = [&report.before, &report.after].map(|side| side.self_intersecting_triangles);
        let found = match (name, report.volume_change) {
            ("volume", Some(change)) => format!("the relative change of volume is {change:+.3e}"),
            ("volume", None) => "the written mesh does not enclose a volume".to_owned(),
            _ => format!("{after} triangles intersect others, up from {before}"),
        };
        console.warn("promise missed", format_args!("{name}: {found}"));
    }
    outcome
}
