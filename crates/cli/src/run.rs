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
        console.say(format_args!("new self-intersections: {} triangles", report.certificate.after_rounding));
    }
    let mut outcome = Outcome::Done;
    for name in report.missed_promises() {
        outcome = Outcome::PromiseMissed;
        console.warn("promise missed", format_args!("{name}: {}", reason(report, name)));
    }
    outcome
}

/// The reason why a promise does not hold.
fn reason(report: &Report, promise: &str) -> String {
    let certificate = &report.certificate;
    match promise {
        "volume" => match report.volume_change {
            Some(change) => format!("the relative change of volume is {change:+.3e}"),
            None => "the written mesh does not enclose a volume".to_owned(),
        },
        "no_new_self_intersections" if certificate.new_crossings == 0 => format!(
            "rounding to the single precision of the format makes {} triangles cross; write OBJ or PLY",
            certificate.after_rounding
        ),
        "no_new_self_intersections" => {
            format!("{} triangles cross others and did not in the target", certificate.after_rounding)
        }
        "positive_jacobian" => {
            let smallest = report.strokes.iter().filter_map(|stroke| stroke.jacobian_min).fold(f64::INFINITY, f64::min);
            format!("the smallest Jacobian determinant of a stroke is {smallest:.3}")
        }
        "lock_within_half_edge" => format!(
            "the volume lock moved a vertex by {:.2} of the shortest edge at it",
            report.lock_max_shift_per_edge.unwrap_or_default()
        ),
        _ => {
            let is_stopped = |index: &usize| report.strokes[*index].stopped_at.is_some();
            let stopped: Vec<String> =
                (0..report.strokes.len()).filter(is_stopped).map(|index| index.to_string()).collect();
            format!("stroke {} ended early, before the surface would cross itself", stopped.join(", "))
        }
    }
}
