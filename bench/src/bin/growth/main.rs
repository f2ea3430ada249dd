//! Scaling of each stage with the number of triangles, grid nodes and strokes, on one core. Prints
//! the slopes on logarithmic scales and plots `target/growth/*.svg`.
//!
//! A series ends before a run that would take longer than two seconds. `growth full` continues to
//! 10⁷ triangles and 20 seconds. `growth memory` prints the peak memory of stages instead.

#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

mod memory;
mod over_strokes;
mod over_triangles;
mod plot;
mod series;

use std::path::Path;

use isochore_bench::{on_one_core, print_row};
use isochore_mesh::{DistanceField, DistanceFieldOptions, NoProgress};

use crate::{plot::Plot, series::Series};

/// Limits of the series.
#[derive(Debug, Clone, Copy)]
struct Extent {
    /// Longest expected run, seconds.
    seconds: f64,
    /// Largest number of triangles.
    triangles: usize,
}

const SHORT: Extent = Extent { seconds: 2.0, triangles: 1_100_000 };

const FULL: Extent = Extent { seconds: 20.0, triangles: 11_000_000 };

/// Cells on the longest side of distance grids.
const RESOLUTIONS: [usize; 4] = [32, 64, 128, 256];

/// Segments of the scan that is sampled and deformed: 98,000 triangles.
const SEGMENTS: usize = 91;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["memory"] => return memory::measure(),
        ["memory-of", stage, segments] => {
            return on_one_core(|| memory::measure_stage(stage, segments.parse().expect("a number of segments")));
        }
        _ => {}
    }
    let extent = if arguments.iter().any(|argument| argument == "full") { FULL } else { SHORT };
    on_one_core(|| {
        let [mesh, deformation] = over_triangles::measure(extent);
        report("triangles", "triangles.svg", "Meshes: CPU time by number of triangles", &mesh);
        report("triangles", "deformation.svg", "Deformation: CPU time by number of triangles", &deformation);
        let grids = over_nodes(extent);
        report("grid nodes", "grid.svg", "Distance grids: CPU time by number of nodes", &grids);
        let [strokes, touched] = over_strokes::measure(extent);
        report("strokes", "strokes.svg", "Strokes: CPU time by number of strokes", &strokes);
        let title = "Strokes: CPU time by total number of moved vertices";
        report("moved vertices", "touched.svg", title, &touched);
    });
}

/// Distance grids of one mesh at increasing resolutions.
fn over_nodes(extent: Extent) -> Vec<Series> {
    let mesh = isochore_bench::scan_of_cube(SEGMENTS);
    let mut all = Series::new("distance grid");
    let mut band = Series::new("distance grid, band of 4 cells");
    for resolution in RESOLUTIONS {
        let options = DistanceFieldOptions { resolution, ..DistanceFieldOptions::default() };
        let narrow = DistanceFieldOptions { band: 4.0 * longest_side(&mesh) / resolution as f64, ..options };
        let sample = |options| DistanceField::new(&mesh, &options, &NoProgress).expect("a valid mesh");
        let nodes = sample(narrow).samples().len();
        all.measure(nodes, extent.seconds, || sample(options));
        band.measure(nodes, extent.seconds, || sample(narrow));
    }
    vec![all, band]
}

fn longest_side(mesh: &isochore_mesh::TriMesh) -> f64 {
    mesh.bounds().size().max_element()
}

/// Prints the slopes and writes the plot.
fn report(size: &str, file: &str, title: &str, series: &[Series]) {
    println!("\n{title}");
    print_row(["slope", "last slope", &format!("max {size}"), "seconds at max", "stage"]);
    for series in series {
        let Some(&(largest, seconds)) = series.points.last() else { continue };
        print_row([
            &format!("{:.2}", series.slope()),
            &format!("{:.2}", series.last_slope()),
            &largest.to_string(),
            &format!("{seconds:.3}"),
            series.stage,
        ]);
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/growth");
    std::fs::create_dir_all(&folder).expect("the target folder can be written");
    Plot { title, size, series }.write(&folder.join(file)).expect("the target folder can be written");
}
