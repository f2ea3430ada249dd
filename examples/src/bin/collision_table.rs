#![expect(clippy::print_stdout, reason = "examples print the paths of their files")]

//! Six cases similar to table 13.1 of Zheng's thesis, whose models and paths are not published.
//! Measures the change of volume without the volume lock, unrefined and refined, and frames per
//! second on one core, and lists them beside the published values. Writes `collision_table.md`.

use std::{error::Error, fmt::Write, fs};

use isochore_examples::{folder, scene};
use isochore_field::{DeformOptions, Stroke, deform};
use isochore_mesh::NoProgress;

/// Recipe; model, triangles, volumes before and after, and frames per second in the thesis.
const CASES: [(&str, &str, usize, f64, f64, f64); 6] = [
    ("sphere", "sphere (C)", 11_200, 2.132, 2.127, 78.0),
    ("hare", "bunny (C)", 23_380, 1.997, 1.988, 36.0),
    ("chess", "chess (C)", 23_844, 0.576, 0.572, 36.0),
    ("rocker_arm", "rocker arm (C)", 43_468, 0.143, 0.142, 30.0),
    ("rod", "cube (R)", 33_600, 8.000, 8.033, 39.0),
    ("waist", "Venus (R)", 36_396, 74.811, 74.324, 37.0),
];

fn main() -> Result<(), Box<dyn Error>> {
    let mut table = String::from(
        "| recipe | triangles | change | refined to | change | frames/s | thesis | triangles | change | frames/s |\n\
         |---|---:|---:|---:|---:|---:|---|---:|---:|---:|\n",
    );
    // One core, as in the thesis.
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for (recipe, model, triangles, before, after, frames) in CASES {
        let scene = scene(recipe)?;
        let run = |options: DeformOptions| one.install(|| deform(&scene.target, &scene.strokes, &options, &NoProgress));
        let plain = run(DeformOptions { refine: None, lock: false })?;
        let refined = run(DeformOptions { lock: false, ..scene.options })?;
        let volume = scene.target.volume();
        let change = |deformed: f64| deformed / volume - 1.0;
        let steps: usize = scene.strokes.iter().map(steps).sum();
        writeln!(
            table,
            "| `{recipe}` | {} | {:+.3} % | {} | {:+.4} % | {:.0} | {model} | {triangles} | {:+.3} % | {frames} |",
            scene.target.triangles.len(),
            100.0 * change(plain.mesh.volume()),
            refined.mesh.triangles.len(),
            100.0 * change(refined.mesh.volume()),
            steps as f64 / plain.receipt.seconds.advect,
            100.0 * (after / before - 1.0),
        )?;
    }
    let path = folder()?.join("collision_table.md");
    fs::write(&path, &table)?;
    println!("{}", path.display());
    Ok(())
}

/// Number of frames: steps of the integrator, or one for strokes in closed form.
fn steps(stroke: &Stroke) -> usize {
    match stroke {
        Stroke::Move(stroke) => stroke.steps(),
        Stroke::Field(stroke) => stroke.steps(),
        Stroke::Stamp(stroke) => stroke.path().steps(),
        Stroke::Twist(_) | Stroke::Bend(_) => 1,
    }
}
