//! The self-intersection check on one core, compared with PyMeshLab's filter and libigl's exact
//! detector. The input is synthetic scans with and without intersections, or the mesh files given
//! as arguments.

#![expect(clippy::print_stderr, reason = "reports why a peer is missing")]

use std::{fs, path::Path};

use isochore_bench::{
    Comparison, PythonPeer, cpu_seconds, grouped, intersecting_scans, load_mesh, median, on_one_core, scan, scratch,
};
use isochore_mesh::{NoProgress, SelfIntersections, TriMesh, io};
use serde_json::json;

/// Rounds after one warm-up round.
const ROUNDS: usize = 7;

/// Jobs and names of the peers.
const PEERS: [(&str, &str); 2] =
    [("pymeshlab_intersections", "PyMeshLab 2025.7.post1"), ("libigl_intersections", "libigl 2.6.3, exact")];

fn main() {
    on_one_core(|| {
        Comparison::print_heading();
        let files: Vec<String> = std::env::args().skip(1).collect();
        for file in &files {
            let mesh = io::read(Path::new(file)).expect("a readable mesh");
            compare(&mesh, file);
        }
        if files.is_empty() {
            for subdivisions in [6, 7, 8] {
                let mesh = scan(subdivisions);
                compare(&mesh, &format!("scan of {} triangles", grouped(mesh.triangles.len())));
            }
            for subdivisions in [6, 7] {
                let mesh = intersecting_scans(subdivisions);
                compare(&mesh, &format!("intersecting scans of {} triangles", grouped(mesh.triangles.len())));
            }
        }
    });
}

fn compare(mesh: &TriMesh, name: &str) {
    let mut peer = PythonPeer::start("surface", &[]);
    if let Ok(started) = &mut peer {
        load_mesh(started, mesh).expect("the peer accepts the mesh");
    }
    let found = SelfIntersections::of(mesh, &NoProgress).expect("a valid mesh");
    let mut is_found = vec![0_u8; mesh.triangles.len()];
    found.triangles().iter().for_each(|&triangle| is_found[triangle as usize] = 1);
    let output = scratch().join("surface-intersections.raw");

    for (job, peer_name) in PEERS {
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        let mut missing = None;
        for round in 0..=ROUNDS {
            let begin = cpu_seconds();
            drop(std::hint::black_box(SelfIntersections::of(mesh, &NoProgress)));
            let seconds = cpu_seconds() - begin;
            let started = peer.as_mut().map_err(|error| error.clone());
            match started.and_then(|peer| peer.seconds(&json!({ "job": job, "output": output }))) {
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
        let theirs_found = fs::read(&output).expect("the peer wrote its result");
        let only = |some: &[u8], others: &[u8]| some.iter().zip(others).filter(|(a, b)| a > b).count();
        let scale = 1e9 / mesh.triangles.len() as f64;
        Comparison {
            job: format!("self-intersection check, {name}"),
            peer: peer_name.into(),
            unit: "ns/triangle".into(),
            ours: scale * median(&mut ours),
            theirs: scale * median(&mut theirs),
            accuracy: format!(
                "{} intersecting triangles; {} only in isochore, {} only in the peer",
                found.triangles().len(),
                only(&is_found, &theirs_found),
                only(&theirs_found, &is_found)
            ),
        }
        .report();
    }
}
