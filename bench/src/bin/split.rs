//! Splitting edges to a maximum length on one core, compared with manifold3d at equal numbers of
//! triangles. The input is a synthetic scan, or the mesh files given as arguments.

#![expect(clippy::print_stderr, reason = "reports why a peer is missing")]

use isochore_bench::{Comparison, PythonPeer, cpu_seconds, grouped, load_mesh, median, on_one_core, scan};
use isochore_mesh::{NoProgress, Subdivision, TriMesh, io};
use serde_json::json;

/// Rounds after one warm-up round.
const ROUNDS: usize = 7;

/// Maximum edge lengths requested from the peer, relative to the mean edge.
const LENGTHS: [f64; 3] = [0.7, 0.4, 0.2];

fn main() {
    on_one_core(|| {
        Comparison::print_heading();
        let files: Vec<String> = std::env::args().skip(1).collect();
        for file in &files {
            compare(&io::read(file).expect("a readable mesh"), file);
        }
        if files.is_empty() {
            compare(&scan(6), "a scan");
        }
    });
}

fn compare(mesh: &TriMesh, name: &str) {
    let mut peer = match PythonPeer::start("surface", &[]) {
        Ok(peer) => peer,
        Err(error) => return eprintln!("manifold3d is missing: {error}"),
    };
    load_mesh(&mut peer, mesh).expect("the peer accepts the mesh");
    let mean = mesh.edge_lengths().expect("edges").mean;
    for length in LENGTHS {
        let request = json!({ "job": "manifold_split", "length": length * mean });
        let reply = match peer.ask(&request) {
            Ok(reply) => reply,
            Err(error) => return eprintln!("manifold3d is missing: {error}"),
        };
        let number = |key: &str| reply[key].as_f64().expect("a number");
        let count = number("triangles");
        let longest = length_for(mesh, length * mean, count);
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        for round in 0..=ROUNDS {
            let begin = cpu_seconds();
            drop(std::hint::black_box(split(mesh, longest)));
            let seconds = cpu_seconds() - begin;
            let peer_seconds = peer.seconds(&request).expect("the peer replied before");
            if round > 0 {
                ours.push(seconds);
                theirs.push(peer_seconds);
            }
        }
        let fine = mesh.subdivided(&split(mesh, longest));
        Comparison {
            job: format!(
                "split {name} of {} triangles into {}",
                grouped(mesh.triangles.len()),
                grouped(count as usize)
            ),
            peer: "manifold3d 3.5.4 refine_to_length".into(),
            unit: "ns/output triangle".into(),
            ours: 1e9 * median(&mut ours) / fine.triangles.len() as f64,
            theirs: 1e9 * median(&mut theirs) / count,
            accuracy: format!(
                "{} triangles, longest edge {:.2} | {:.2} mean edges, volume {:+.0e} | {:+.0e}",
                fine.triangles.len(),
                fine.edge_lengths().expect("edges").max / mean,
                number("longest") / mean,
                fine.volume() / mesh.volume() - 1.0,
                number("volume_change")
            ),
        }
        .report();
    }
}

/// Maximum edge length that splits `mesh` into about `count` triangles, by bisection.
fn length_for(mesh: &TriMesh, guess: f64, count: f64) -> f64 {
    let (mut low, mut high) = (0.25 * guess, 8.0 * guess);
    for _ in 0..10 {
        let middle = (low * high).sqrt();
        if split(mesh, middle).triangles.len() as f64 > count { low = middle } else { high = middle }
    }
    high
}

fn split(mesh: &TriMesh, longest: f64) -> Subdivision {
    mesh.split_to_length(longest, usize::MAX, &NoProgress).expect("a valid mesh")
}
