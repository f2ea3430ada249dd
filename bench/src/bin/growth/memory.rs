//! How much memory stages hold at their peak, each in a process of its own, since one that has run before leaves memory that
//! is taken again without being counted.

use std::process::Command;

use isochore_bench::{peak_bytes, print_row, scan_of_cube};
use isochore_field::deform;
use isochore_mesh::{NoProgress, SelfIntersections, TriMesh};

use crate::over_triangles::{LOCAL_VERTICES, press, reach_of, refinement};

/// Of the scans: about 300,000, 1,000,000 and 3,000,000 triangles.
const SEGMENTS: [usize; 3] = [162, 289, 513];

const STAGES: [&str; 3] = ["splitting to 0.6 mean edges", "self-intersection", "deform, 1,000 vertices touched"];

/// Runs each stage in its own process and prints what it held.
pub(crate) fn measure() {
    print_row(["triangles", "triangles in the end", "bytes each", "stage"]);
    let program = std::env::current_exe().expect("a running program has a file");
    for stage in STAGES {
        for segments in SEGMENTS {
            let child = Command::new(&program).args(["memory-of", stage, &segments.to_string()]).status();
            assert!(child.expect("the same program can be started").success(), "{stage}");
        }
    }
}

/// Runs one stage on a scan and prints what it held beyond the mesh itself, and what it returns among it.
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
    let (split, bytes) = peak_bytes(|| mesh.split_to_length(longest, usize::MAX, &NoProgress).expect("a sound mesh"));
    (split.triangles.len(), bytes)
}

fn search(mesh: &TriMesh) -> (usize, Option<u64>) {
    let (_, bytes) = peak_bytes(|| SelfIntersections::of(mesh, &NoProgress).expect("a sound mesh"));
    (mesh.triangles.len(), bytes)
}

fn deform_locally(mesh: &TriMesh) -> (usize, Option<u64>) {
    let strokes = [press(mesh.positions[mesh.positions.len() / 2], reach_of(LOCAL_VERTICES, mesh))];
    let (deformed, bytes) = peak_bytes(|| deform(mesh, &strokes, &refinement(), &NoProgress).expect("a sound mesh"));
    (deformed.mesh.triangles.len(), bytes)
}
