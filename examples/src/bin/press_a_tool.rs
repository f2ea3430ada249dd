//! Presses a chess pawn into the planet of the folder `data` and measures how well the volume is
//! preserved.

#![expect(clippy::print_stdout, reason = "the measurements are the result")]

use std::{error::Error, sync::Arc};

use glam::DVec3;
use isochore_examples::{data_mesh, save_mesh, save_picture};
use isochore_field::{DeformOptions, Move, Pose, Profile, Stroke, Tool, deform};
use isochore_mesh::{DistanceFieldOptions, NoProgress, SmoothDistance};
use isochore_picture::{Body, Camera, Options, Panel};

/// Distance from the surface of the pawn over which its field fades out, model units.
const SUPPORT: f64 = 0.35;

fn main() -> Result<(), Box<dyn Error>> {
    let planet = data_mesh("planet")?;
    let pawn = data_mesh("pawn")?;

    // A tool needs the signed distance to its shape, up to its support and without kinks.
    let options = DistanceFieldOptions { resolution: 64, ..DistanceFieldOptions::default() };
    let distance = Arc::new(SmoothDistance::new(&pawn, SUPPORT, &options, &NoProgress)?);
    let tool = Arc::new(Tool::new(distance, SUPPORT, Profile::Quintic)?);

    // The pawn is upright; its base sinks into the planet from above.
    let keys = [1.45, 0.85].map(|height| Pose::at(DVec3::new(0.0, 0.0, height))).to_vec();
    let stroke = Stroke::Move(Move::new(tool, keys, 0.125)?);

    let deformed = deform(&planet, &[stroke], &DeformOptions::default(), &NoProgress)?;
    let (receipt, volume) = (&deformed.receipt, planet.volume());
    println!("triangles: {} before, {} after", planet.triangles.len(), deformed.mesh.triangles.len());
    println!("vertices moved: {}, by at most {:.3}", receipt.moved_vertices, receipt.max_displacement);
    if let Some(unlocked) = receipt.volume_before_lock {
        println!("relative change of volume before the volume lock: {:+.1e}", unlocked / volume - 1.0);
    }
    println!("relative change of volume: {:+.1e}", deformed.mesh.volume() / volume - 1.0);

    save_mesh("press_a_tool", &deformed.mesh)?;
    let panels =
        [("before", &planet), ("after", &deformed.mesh)].map(|(name, mesh)| Panel::new(name).with(Body::new(mesh)));
    let camera = Camera::from_direction(DVec3::new(0.3, -1.0, 1.2));
    save_picture("press_a_tool", &panels, &camera, &Options { width: 1200, height: 620, ..Options::default() })
}
