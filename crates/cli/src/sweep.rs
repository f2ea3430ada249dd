//! `isochore sweep`: the surface that a profile sweeps along a curve, as a mesh or as an exact rational net.

use std::path::Path;

use glam::{DVec2, DVec3};
use isochore_curve::{RationalCrossSection, sweep as sweep_grid};
use isochore_mesh::{GridMesh, TriMesh, io};

use crate::{
    Outcome,
    arguments::{SweepArguments, Twist},
    command_error::CommandError,
    console::Console,
    csv_table::CsvTable,
    job::write_mesh,
    spine_file::SpineFile,
    staging::Staging,
};

mod net;
mod step;

use net::Net;

/// Formats that hold the surface itself.
#[derive(Debug, Clone, Copy)]
enum Exact {
    Json,
    Step,
}

impl Exact {
    fn of_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "json" => Some(Self::Json),
            "step" | "stp" => Some(Self::Step),
            _ => None,
        }
    }
}

/// Points of a Bézier profile on a mesh.
const BEZIER_POINTS: usize = 33;

pub(crate) fn sweep(arguments: &SweepArguments, console: &Console) -> Result<Outcome, CommandError> {
    let exact = Exact::of_path(&arguments.output);
    if exact.is_none() && io::Format::of_path(&arguments.output).is_none() {
        let path = arguments.output.clone();
        return Err(io::WriteError::UnknownFormat { path }.into());
    }
    let mut staging = Staging::new(console.interrupt());
    let draft = staging.add_file(&arguments.output)?;
    let profile = Profile::read(arguments)?;
    let spine = SpineFile::read(&arguments.spine)?;
    if let Some(format) = exact {
        let net = Net::new(arguments, &spine, profile.curves(), profile.is_closed)?;
        let text = match format {
            Exact::Json => net.to_json(),
            Exact::Step => step::to_step(&net, &arguments.output),
        };
        staging.write(&draft, text.as_bytes())?;
        staging.commit()?;
        console.finish();
        console.say(format_args!("{}: {net}", arguments.output.display()));
        return Ok(Outcome::Done);
    }
    let mesh = mesh(arguments, &spine, &profile)?;
    write_mesh(&staging, &draft, &mesh)?;
    staging.commit()?;
    console.finish();
    console.say(format_args!(
        "{}: {} vertices, {} triangles",
        arguments.output.display(),
        mesh.positions.len(),
        mesh.triangles.len()
    ));
    Ok(Outcome::Done)
}

/// A profile as read.
#[derive(Debug)]
struct Profile {
    /// Homogeneous control points or, with unit weights, points.
    rows: Vec<DVec3>,
    is_bezier: bool,
    is_closed: bool,
}

impl Profile {
    fn read(arguments: &SweepArguments) -> Result<Self, CommandError> {
        let columns: &[usize] = if arguments.bezier { &[2, 3] } else { &[2] };
        let table = CsvTable::read(&arguments.profile, columns)?;
        let mut rows = Vec::with_capacity(table.rows.len());
        for (index, row) in table.rows.iter().enumerate() {
            let weight = row.get(2).copied().unwrap_or(1.0);
            if weight <= 0.0 {
                return Err(table.error(index, "a weight must be above 0"));
            }
            rows.push((DVec2::new(row[0], row[1]) * weight).extend(weight));
        }
        let needed = if arguments.profile_closed { 3 } else { 2 };
        if rows.len() < needed {
            return Err(table.error_in_file(format!("a profile needs at least {needed} rows, not {}", rows.len())));
        }
        if arguments.profile_closed && arguments.bezier {
            let problem = "--profile-closed joins the last row to the first; a Bézier curve closes by equal end rows";
            return Err(CommandError::Usage(problem.to_owned()));
        }
        if arguments.profile_closed && rows[0] == rows[rows.len() - 1] {
            let problem = "repeats the first row; with --profile-closed leave it out, the profile returns by itself";
            return Err(table.error(rows.len() - 1, problem));
        }
        Ok(Self { rows, is_bezier: arguments.bezier, is_closed: arguments.profile_closed })
    }

    /// The points that are swept, counter-clockwise where they close.
    fn points(&self) -> Vec<DVec2> {
        if self.is_bezier {
            return (0..BEZIER_POINTS).map(|i| self.point(i as f64 / (BEZIER_POINTS - 1) as f64)).collect();
        }
        let mut points: Vec<DVec2> = self.rows.iter().map(|row| row.truncate()).collect();
        let doubled_area: f64 = (0..points.len()).map(|i| points[i].perp_dot(points[(i + 1) % points.len()])).sum();
        if self.is_closed && doubled_area < 0.0 {
            // Outside out.
            points.reverse();
        }
        points
    }

    /// The point of the Bézier curve at `parameter`.
    fn point(&self, parameter: f64) -> DVec2 {
        let mut points = self.rows.clone();
        while points.len() > 1 {
            points = points.windows(2).map(|pair| pair[0].lerp(pair[1], parameter)).collect();
        }
        points[0].truncate() / points[0].z
    }

    /// The rational curves that make up the profile.
    fn curves(&self) -> Vec<RationalCrossSection> {
        if self.is_bezier {
            return vec![RationalCrossSection { control_points: self.rows.clone() }];
        }
        let count = self.rows.len();
        let sides = if self.is_closed { count } else { count - 1 };
        (0..sides).map(|i| RationalCrossSection { control_points: vec![self.rows[i], self.rows[(i + 1) % count]] }).collect()
    }
}

fn mesh(arguments: &SweepArguments, spine: &SpineFile, profile: &Profile) -> Result<TriMesh, CommandError> {
    let default_twist = if arguments.spine.closed { Twist::Minimal } else { Twist::None };
    let result = spine.stations(&arguments.spine, default_twist)?;
    let is_twist_closed = result.is_closed && arguments.spine.twist != Some(Twist::None);
    if arguments.caps && (result.is_closed || !profile.is_closed) {
        let problem =
            "--caps closes the ends of an open curve with a closed profile; see --closed and --profile-closed";
        return Err(CommandError::Usage(problem.to_owned()));
    }
    // Where the frames close, the last station is the first again.
    let rows = result.stations.len() - usize::from(is_twist_closed);
    let points = profile.points();
    let grid = sweep_grid(&result.stations[..rows], &points);
    let grid = GridMesh {
        points: &grid.points,
        columns: grid.columns,
        rows_close: is_twist_closed,
        columns_close: profile.is_closed,
    };
    Ok(if arguments.caps { grid.capped_mesh(&points) } else { grid.mesh() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clockwise_profiles_are_turned_around() {
        let rows = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0)].map(|(x, y)| DVec3::new(x, y, 1.0)).to_vec();
        let profile = Profile { rows, is_bezier: false, is_closed: true };
        assert_eq!(profile.points()[0], DVec2::X);
        assert_eq!(profile.curves().len(), 3);
    }

    #[test]
    fn rational_profiles_keep_their_weights() {
        // A quarter circle.
        let weight = std::f64::consts::FRAC_1_SQRT_2;
        let rows = vec![DVec3::new(1.0, 0.0, 1.0), DVec3::new(weight, weight, weight), DVec3::new(0.0, 1.0, 1.0)];
        let profile = Profile { rows, is_bezier: true, is_closed: false };
        assert!(profile.points().iter().all(|point| (point.length() - 1.0).abs() < 1e-15));
    }
}
