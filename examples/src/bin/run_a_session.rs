//! Sculpts interactively, without a window: strokes, changed ranges of the render buffers, undo,
//! redo and the log.

#![expect(clippy::print_stdout, reason = "the measurements are the result")]

use std::{error::Error, fs, sync::Arc};

use glam::DVec3;
use isochore_examples::{folder, save_mesh};
use isochore_field::Pose;
use isochore_mesh::{NoProgress, primitives};
use isochore_sculpt::{
    Meshes, recipe,
    session::{Session, SessionOptions, SessionTool, StrokeOptions},
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut session = Session::open(primitives::icosphere(1.0, 5), SessionOptions::default())?;
    let ball = recipe::Tool {
        shape: recipe::ToolShape::Sphere(recipe::Sphere { radius: 0.3 }),
        support: 0.25,
        profile: recipe::Profile::Quintic,
        free_form: 0.0,
    };
    let tool = Arc::new(SessionTool::new("ball", ball, &Meshes::new(), &NoProgress)?);
    // The first call reports the whole buffers. Later calls report what a renderer must upload
    // again.
    session.take_changes();

    for (stroke, direction) in [DVec3::Z, DVec3::X].into_iter().enumerate() {
        session.begin_stroke(&tool, StrokeOptions::default())?;
        for frame in 0..=10 {
            let time = 0.016 * f64::from(frame);
            session.move_to(&Pose::at(direction * (1.5 - 0.03 * f64::from(frame))), time)?;
            let changes = session.take_changes();
            if frame == 5 {
                let changed: u32 = changes.positions.iter().map(|range| range.end - range.start).sum();
                println!("stroke {stroke}, frame {frame}: {changed} of {} positions changed", session.vertex_count());
            }
        }
        let receipt = session.end_stroke()?;
        let change = receipt.volume.map_or(0.0, |volume| volume.total());
        println!("stroke {stroke}: {} vertices inserted, volume changed by {change:+.1e}", receipt.inserted_vertices);
    }

    let sculpted = session.buffers().positions.to_vec();
    session.undo()?;
    session.redo()?;
    println!("undo and redo restore every bit: {}", session.buffers().positions == sculpted);

    // The log is a recipe; `isochore run` replays it.
    let log = folder()?.join("run_a_session.toml");
    fs::write(&log, session.log().to_toml())?;
    println!("{}", log.display());
    save_mesh("run_a_session", &session.export(true).mesh)
}
