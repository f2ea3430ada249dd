//! `isochore sweep`: the surface that a cross-section sweeps along a curve, as a mesh or as exact
//! rational patches.

use std::path::Path;

use isochore_curve::sweep as sweep_grid;
use isochore_mesh::{
    GridMesh, TriMesh,
    io::{Format, WriteError},
};

use crate::{
    arguments::{SweepArguments, Twist},
    command_error::CommandError,
    console::Console,
    outcome::Outcome,
    spine_file::SpineFile,
    spine_options::{Rotation, SpineOptions},
    staging::Staging,
};

mod cross_section;
mod net;
mod step;

use cross_section::CrossSection;
use net::Net;

/// File format of the surface.
#[derive(Debug, Clone, Copy)]
enum Surface {
    Mesh,
    /// Exact patches as JSON.
    Json,
    /// Exact patches as STEP.
    Step,
}

impl Surface {
    fn of_path(path: &Path) -> Result<Self, CommandError> {
        let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("json") => Ok(Self::Json),
            Some("step" | "stp") => Ok(Self::Step),
            _ if Format::of_path(path).is_some() => Ok(Self::Mesh),
            _ => Err(WriteError::UnknownFormat { path: path.to_owned() }.into()),
        }
    }
}

pub(crate) fn sweep(arguments: &SweepArguments, console: &Console) -> Result<Outcome, CommandError> {
    let surface = Surface::of_path(&arguments.output)?;
    check(arguments)?;
    if !matches!(surface, Surface::Mesh) {
        net::check(arguments)?;
    }
    let default_twist = if arguments.spine.closed { Twist::Minimal } else { Twist::None };
    let options = SpineOptions::new(&arguments.spine, default_twist)?;
    let mut staging = Staging::new(console.interrupt());
    let draft = staging.add_file(&arguments.output)?;
    let cross_section = CrossSection::read(arguments)?;
    let spine = SpineFile::read(&options)?;
    let exact = || Net::new(&options, &spine, &cross_section);
    let summary = match surface {
        Surface::Mesh => {
            let mesh = mesh(&options, &spine, &cross_section, arguments.caps)?;
            staging.write_mesh(&draft, &mesh)?;
            format!("{} vertices, {} triangles", mesh.positions.len(), mesh.triangles.len())
        }
        Surface::Json => {
            let net = exact()?;
            staging.write(&draft, net.to_json().as_bytes())?;
            net.to_string()
        }
        Surface::Step => {
            let net = exact()?;
            staging.write(&draft, step::to_step(&net, &arguments.output).as_bytes())?;
            net.to_string()
        }
    };
    staging.commit()?;
    console.finish();
    console.say(format_args!("{}: {summary}", arguments.output.display()));
    Ok(Outcome::Done)
}

/// Rejects options that contradict each other.
fn check(arguments: &SweepArguments) -> Result<(), CommandError> {
    let problem = if arguments.profile_closed && arguments.bezier {
        "--profile-closed does not apply to --bezier; close a Bézier curve by equal first and last rows"
    } else if arguments.caps && (arguments.spine.closed || !arguments.profile_closed) {
        "--caps needs an open curve and a closed cross-section; remove --closed and add --profile-closed"
    } else {
        return Ok(());
    };
    Err(CommandError::Usage(problem.to_owned()))
}

fn mesh(
    options: &SpineOptions,
    spine: &SpineFile,
    cross_section: &CrossSection,
    has_caps: bool,
) -> Result<TriMesh, CommandError> {
    let result = spine.stations(options)?;
    let rows_close = result.is_closed && !matches!(options.rotation, Rotation::None);
    // If the frames close, the last station equals the first.
    let rows = result.stations.len() - usize::from(rows_close);
    let points = cross_section.points();
    let grid = sweep_grid(&result.stations[..rows], &points);
    let grid =
        GridMesh { points: &grid.points, columns: grid.columns, rows_close, columns_close: cross_section.is_closed };
    Ok(if has_caps { grid.capped_mesh(&points) } else { grid.mesh() })
}
