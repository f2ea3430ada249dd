//! The search for triangles that cross, on one core: made-up scans with and without crossings, or the OBJ files that are named as
//! arguments, against PyMeshLab's filter and libigl's exact detector.

#![expect(clippy::print_stderr, reason = "says why a peer is missing")]

use std::{fs, path::Path};

use isochore_bench::{
    Comparison, PythonPeer, cpu_seconds, crossing_scans, give_mesh, median, on_one_core, scan, scratch,
};
use isochore_mesh::{NoProgress, SelfIntersections, TriMesh, io};
use serde_json::json;

/// Rounds after one that warms up.
const ROUNDS: usize = 7;

/// Jobs of the peers, with their names.
const PEERS: [(&str, &str); 2] =
    [("pymeshlab_crossings", "PyMeshLab 2025.7.post1"), ("libigl_crossings", "libigl 2.6.3, exact")];

fn main() {
    on_one_core(|| {
        Comparison::print_heading();
        let files: Vec<String> = std::env::args().skip(1).collect();
        for file in &files {
            let mesh = io::read(Path::new(file)).expect("a mesh that can be read");
            compare(&mesh, file);
        }
        if files.is_empty() {
            for subdivisions in [6, 7, 8] {
                let mesh = scan(subdivisions);
                compare(&mesh, &format!("a scan of {} triangles", mesh.triangles.len()));
            }
            for subdivisions in [6, 7] {
                let mesh = crossing_scans(subdivisions);
                compare(&mesh, &format!("crossing scans of {} triangles", mesh.triangles.len()));
            }
        }
    });
}

fn compare(mesh: &TriMesh, name: &str) {
    let mut peer = PythonPeer::start("surface", &[]);
    if let Ok(started) = &mut peer {
        give_mesh(started, mesh).expect("the peer takes a mesh");
    }
    let found = SelfIntersections::of(mesh, &NoProgress).expect("a mesh that can be searched");
    let mut is_found = vec![0_u8; mesh.triangles.len()];
    found.triangles().iter().for_each(|&triangle| is_found[triangle as usize] = 1);
    let output = scratch().join("surface-crossings.raw");

    for (job, peer_name) in PEERS {
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        let mut missing = None;
        for round in 0..=ROUNDS {
            let begin = cpu_seconds();
            drop(std::hint::black_box(SelfIntersections::of(mesh, &NoProgress)));
            let seconds = cpu_seconds() - begin;
            let answer = peer.as_mut().map_err(|error| error.clone());
            match answer.and_then(|peer| peer.seconds(&json!({ "job": job, "output": output }))) {
                Ok(peer_seconds) if round > 0 => {
                    ours.push(seconds);
                    theirs.push(peer_seconds);
                }
                Ok(_) => {}
                Err(error) => {
                    missing = Some(error);
                    break;
                }
            }
        }
        if let Some(error) = missing {
            eprintln!("{peer_name} is missing: {error}");
            continue;
        }
        let theirs_found = fs::read(&output).expect("the peer has written what it found");
        let only = |some: &[u8], others: &[u8]| some.iter().zip(others).filter(|(a, b)| a > b).count();
        let scale = 1e9 / mesh.triangles.len() as f64;
        Comparison {
            job: format!("crossings in {name}"),
            peer: peer_name.into(),
            unit: "ns a triangle".into(),
            ours: scale * median(&mut ours),
            theirs: scale * median(&mut theirs),
            accuracy: format!(
                "{} triangles; {} found here only, {} there only",
                found.triangles().len(),
                only(&is_found, &theirs_found),
                only(&theirs_found, &is_found)
            ),
        }
        .report();
    }
}
