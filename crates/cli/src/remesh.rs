//! `isochore remesh`: even triangles on the same surface.

use std::path::{Path, PathBuf};

use isochore_mesh::{
    ClosedMesh, SelfIntersectionError, SelfIntersections, TriMesh,
    io::{self, Format, WriteError},
};
use isochore_sculpt::{RemeshError, Remeshed, session::RemeshOptions};
use serde::Serialize;

use crate::{
    arguments::RemeshArguments, command_error::CommandError, console::Console, outcome::Outcome, staging::Staging,
};

/// Result of the command.
#[derive(Debug, Clone, Serialize)]
struct Report {
    before: Quality,
    after: Quality,
    /// Signed relative change of the volume, measured on the written mesh; `None` for an open mesh.
    volume_change: Option<f64>,
    /// The same before the lock, measured before the mesh is written.
    volume_change_before_lock: Option<f64>,
    /// Longest displacement by the lock, model units; `None` if it was skipped.
    lock_max_shift: Option<f64>,
    /// Allowed distance between the two surfaces, model units.
    allowance: f64,
    splits: usize,
    collapses: usize,
    flips: usize,
    /// Wall-clock time of the remesh, seconds.
    seconds: f64,
}

/// Measurements of a mesh.
#[derive(Debug, Clone, Serialize)]
struct Quality {
    vertices: usize,
    triangles: usize,
    /// `None` for an open mesh.
    volume: Option<f64>,
    self_intersecting_triangles: usize,
    /// Smallest angle of any triangle, degrees.
    smallest_angle: f64,
    /// Fraction of the triangles with an angle below 5°.
    angle_below_5_degrees: f64,
    /// Fraction of the triangles with an angle below 20°.
    angle_below_20_degrees: f64,
}

pub(crate) fn remesh(arguments: &RemeshArguments, console: &Console) -> Result<Outcome, CommandError> {
    let output = arguments.output.clone().unwrap_or_else(|| beside(&arguments.mesh));
    let format = Format::of_path(&output).ok_or_else(|| WriteError::UnknownFormat { path: output.clone() })?;
    let mut staging = Staging::new(console.interrupt());
    let draft = staging.add_file(&output)?;
    let report_draft = arguments.report.as_ref().map(|path| staging.add_file(path)).transpose()?;

    let mesh = io::read(&arguments.mesh)?;
    let quality = |mesh: &TriMesh| {
        Quality::of(mesh, console).map_err(|error| match error {
            SelfIntersectionError::Cancelled(cancelled) => cancelled.into(),
            error => CommandError::file(&arguments.mesh, error),
        })
    };
    let before = quality(&mesh)?;
    let options = RemeshOptions {
        edge_length: arguments.edge_length,
        deviation: arguments.deviation,
        ..RemeshOptions::default()
    };
    let Remeshed { mesh, receipt } = isochore_sculpt::remesh(mesh, &options, console).map_err(|error| match error {
        RemeshError::Cancelled(cancelled) => cancelled.into(),
        error => CommandError::file(&arguments.mesh, error),
    })?;
    staging.write_mesh(&draft, &mesh)?;
    // A format of single precision rounds the mesh.
    let after = quality(&format.stored(&mesh))?;
    let size = before.volume.filter(|&volume| volume != 0.0).map(f64::abs);
    let relative = |change: Option<f64>| change.zip(size).map(|(change, size)| change / size);
    let report = Report {
        volume_change: relative(after.volume.zip(before.volume).map(|(after, before)| after - before)),
        volume_change_before_lock: relative(receipt.unlocked_volume_change),
        lock_max_shift: receipt.lock_max_shift,
        before,
        after,
        allowance: receipt.allowance,
        splits: receipt.splits,
        collapses: receipt.collapses,
        flips: receipt.flips,
        seconds: receipt.seconds,
    };
    if let Some(draft) = &report_draft {
        staging.write(draft, format!("{}\n", crate::console::to_json(&report)).as_bytes())?;
    }
    staging.commit()?;
    console.finish();
    if receipt.is_limited {
        console.warn("warning", "the limit on triangles prevented splits; choose longer edges");
    }
    conclude(&report, &output, console);
    Ok(Outcome::Done)
}

/// The default output of a mesh file.
fn beside(mesh: &Path) -> PathBuf {
    let mut name = mesh.file_stem().unwrap_or_default().to_owned();
    name.push("-remeshed");
    let path = mesh.with_file_name(name);
    mesh.extension().map_or(path.clone(), |extension| path.with_added_extension(extension))
}

fn conclude(report: &Report, output: &Path, console: &Console) {
    let Report { before, after, .. } = report;
    let [old, new] = [before, after].map(|quality| quality.self_intersecting_triangles);
    if new > old {
        let text = format!("rounding makes triangles intersect, {new} instead of {old}; write OBJ or PLY");
        console.warn("warning", format_args!("{}: {text}", output.display()));
    }
    if console.is_json() {
        console.print_json(report);
        return;
    }
    console.say(format_args!(
        "{}: {} triangles instead of {}, within {:.3e} of the surface",
        output.display(),
        after.triangles,
        before.triangles,
        report.allowance,
    ));
    let percent = |quality: &Quality| 100.0 * quality.angle_below_20_degrees;
    console.say(format_args!(
        "angles below 20°: {:.3} % of the triangles, {:.3} % before; smallest angle {:.1}°",
        percent(after),
        percent(before),
        after.smallest_angle,
    ));
    if let (Some(volume), Some(change)) = (after.volume, report.volume_change) {
        let before_lock = report
            .volume_change_before_lock
            .map_or(String::new(), |change| format!(" ({change:+.1e} before the lock)"));
        console.say(format_args!("volume {volume:.9}, relative change {change:+.1e}{before_lock}"));
    }
    console.say(format_args!("self-intersections: {new} triangles, {old} before"));
}

impl Quality {
    fn of(mesh: &TriMesh, console: &Console) -> Result<Self, SelfIntersectionError> {
        let smallest = |triangle: usize| mesh.triangle_angles(triangle).into_iter().fold(f64::INFINITY, f64::min);
        let angles: Vec<f64> = (0..mesh.triangles.len()).map(|triangle| smallest(triangle).to_degrees()).collect();
        let below =
            |limit: f64| angles.iter().filter(|&&angle| angle < limit).count() as f64 / angles.len().max(1) as f64;
        Ok(Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            volume: ClosedMesh::new(mesh).ok().map(|closed| closed.volume()),
            self_intersecting_triangles: SelfIntersections::of(mesh, console)?.triangles().len(),
            smallest_angle: angles.iter().copied().fold(60.0, f64::min),
            angle_below_5_degrees: below(5.0),
            angle_below_20_degrees: below(20.0),
        })
    }
}
