//! Peak memory of stages. Each stage runs in its own process, because memory that an earlier stage
//! has freed would be reused without being counted.

use std::process::Command;

use isochore_bench::{peak_bytes, print_row, scan_of_cube};
use isochore_field::deform;
use isochore_mesh::{NoProgress, SelfIntersections, TriMesh};

use crate::over_triangles::{LOCAL_VERTICES, press, reach_of, refinement};

/// Segments of the scans: about 300,000, 1,000,000 and 3,000,000 triangles.
const SEGMENTS: [usize; 3] = [162, 289, 513];

const STAGES: [&str; 3] = ["splitting to 0.6 mean edges", "self-intersection", "deform, 1,000 vertices touched"];

/// Runs each stage in its own process and prints its peak memory.
pub(crate) fn measure() {
    print_row(["triangles", "final triangles", "bytes/triangle", "stage"]);
    let program = std::env::current_exe().expect("this program has a path");
    for stage in STAGES {
        for segments in SEGMENTS {
            let child = Command::new(&program).args(["memory-of", stage, &segments.to_string()]).status();
            assert!(child.expect("this program can be started").success(), "{stage}");
        }
    }
}

/// Runs one stage on a scan and prints its peak memory in addition to the input mesh. The result of
/// the stage is included.
pub(crate) fn measure_stage(stage: &str, segments: usize) {
    let mesh = scan_of_cube(segments);
    let (count, bytes) = match STAGES.iter().position(|known| *known == stage) {
        Some(0) => split(&mesh),
        Some(1) => search(&mesh),
        _ => deform_locally(&mesh),
    };
    let bytes = bytes.map_or("unknown".into(), |bytes| format!("{:.0}", bytes as f64 / count as f64));
    print_row([&mesh.triangles.len().to_string(), &count.to_string(), &bytes, stage]);
}

fn split(mesh: &TriMesh) -> (usize, Option<u64>) {
    let longest = 0.6 * mesh.edge_lengths().expect("edges").mean;
    let (split, bytes) = peak_bytes(|| mesh.split_to_length(longest, usize::MAX, &NoProgress).expect("a valid mesh"));
    (split.triangles.len(), bytes)
}

fn search(mesh: &TriMesh) -> (usize, Option<u64>) {
    let (_, bytes) = peak_bytes(|| SelfIntersections::of(mesh, &NoProgress).expect("a valid mesh"));
    (mesh.triangles.len(), bytes)
}

fn deform_locally(mesh: &TriMesh) -> (usize, Option<u64>) {
    let strokes = [press(mesh.positions[mesh.positions.len() / 2], reach_of(LOCAL_VERTICES, mesh))];
    let (deformed, bytes) = peak_bytes(|| deform(mesh, &strokes, &refinement(), &NoProgress).expect("a valid mesh"));
    (deformed.mesh.triangles.len(), bytes)
}
