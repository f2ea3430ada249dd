//! Construction of a distance grid, compared with node-by-node queries of general libraries.
//!
//! Times are CPU times on one core unless a table says otherwise. Arguments: a mesh file, which
//! replaces the generated mesh of 70,000 triangles, and `threads`, which selects only the table of
//! two threads. That table needs an idle machine.

#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

mod peers;
mod stages;

use std::time::Instant;

use glam::dvec3;
use isochore_bench::{Comparison, median, on_one_core, peak_bytes, print_row};
use isochore_mesh::primitives::latitude_longitude_sphere;
use isochore_mesh::{DistanceField, DistanceFieldOptions, NoProgress, TriMesh, io};
use peers::{Round, Task};
use stages::{Stages, build};

/// Rounds of each measurement, after one warm-up round.
const ROUNDS: usize = 7;

/// Approximate number of nodes that a peer computes per round. All nodes would take minutes. Whole
/// layers are used, so that neighbors benefit from the cache.
const NODES_QUERIED: usize = 30_000;

/// Signs are not compared at distances below this, relative to the size of the mesh. Larger: wrong
/// signs are missed. Smaller: rounding counts as a wrong sign.
const ON_SURFACE: f64 = 1e-6;

/// A shape with hollows and ridges that fills a small part of its bounding box.
fn rugged(around: usize, upward: usize) -> TriMesh {
    let mut mesh = latitude_longitude_sphere(1.0, around, upward);
    for p in &mut mesh.positions {
        let bump = 1.0 + 0.3 * (7.0 * p.x).sin() * (5.0 * p.y + 2.0 * p.z).cos() + 0.02 * (40.0 * p.z).sin();
        *p *= dvec3(0.8, 0.6, 1.0) * bump;
    }
    mesh
}

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let with_peers = !arguments.iter().any(|argument| argument == "threads");
    arguments.retain(|argument| argument != "threads");
    let mesh = match arguments.first() {
        Some(path) => io::read(path).expect("a readable mesh"),
        None => rugged(220, 160),
    };
    let fine = rugged(880, 640);
    if with_peers {
        on_one_core(|| measure_on_one_core(&mesh, &fine));
    }
    println!("\nwall time on two threads");
    Comparison::print_heading();
    two_threads(&mesh, 128);
    two_threads(&fine, 64);
}

/// All measurements on one core.
fn measure_on_one_core(mesh: &TriMesh, fine: &TriMesh) {
    println!("errors are relative to the size of the mesh; the reference is in double precision");
    compare(mesh, 64);
    compare(mesh, 128);
    compare(fine, 64);

    println!("\nbands around the surface, milliseconds");
    print_row(["triangles", "cells", "band", "hierarchy", "distance", "signs", "spline"]);
    for band in [f64::INFINITY, 8.0, 3.0] {
        measure_stages(mesh, band);
    }
    println!("\nmesh with 1,000 holes, milliseconds");
    print_row(["triangles", "cells", "band", "hierarchy", "distance", "signs", "spline"]);
    measure_stages(&with_holes(mesh.clone(), 1000), f64::INFINITY);
}

/// Compares the distance field with all peers, alternately.
fn compare(mesh: &TriMesh, resolution: usize) {
    let options = DistanceFieldOptions { resolution, ..Default::default() };
    let (field, peak) = peak_bytes(|| DistanceField::new(mesh, &options, &NoProgress).expect("a valid mesh"));
    let count = field.grid().len();
    let [nx, ny, nz] = field.grid().dims;
    let layer_step = (count / NODES_QUERIED).max(1);
    let layers = nz / layer_step;
    let first_layer = (nz - (layers - 1) * layer_step) / 2;
    let task = Task { mesh, grid: field.grid(), first_layer, layer_step, layers };

    let mut peers = peers::all();
    peers.retain_mut(|peer| match peer.prepare(&task) {
        Ok(()) => true,
        Err(reason) => {
            println!("{} is missing: {reason}", peer.name());
            false
        }
    });
    let mut ours = Vec::new();
    let mut theirs: Vec<Vec<Round>> = peers.iter().map(|_| Vec::new()).collect();
    for _ in 0..=ROUNDS {
        ours.push(build(mesh, &options).1);
        for (peer, rounds) in peers.iter_mut().zip(&mut theirs) {
            rounds.push(peer.round(&task).unwrap_or_else(|reason| panic!("{}: {reason}", peer.name())));
        }
    }

    let of_ours = |part: fn(&Stages) -> f64| median(&mut ours[1..].iter().map(part).collect::<Vec<_>>());
    let hierarchy = of_ours(|stages| stages.hierarchy);
    let node = of_ours(|stages| stages.distance + stages.signs) / count as f64;
    println!();
    print_row([
        "triangles",
        "cells",
        "nodes",
        "hierarchy ms",
        "distance ns/node",
        "signs ns/node",
        "spline ns/node",
        "peak MB",
    ]);
    let nanoseconds = |seconds: f64| format!("{:.1}", 1e9 * seconds / count as f64);
    print_row([
        &mesh.triangles.len().to_string(),
        &resolution.to_string(),
        &format!("{nx} x {ny} x {nz}"),
        &format!("{:.1}", 1e3 * hierarchy),
        &nanoseconds(of_ours(|stages| stages.distance)),
        &nanoseconds(of_ours(|stages| stages.signs)),
        &nanoseconds(of_ours(|stages| stages.spline)),
        &peak.map_or("n/a".into(), |bytes| format!("{:.0}", 1e-6 * bytes as f64)),
    ]);
    let thousands = mesh.triangles.len() / 1000;
    let job = format!("signed distance grid, {thousands}k triangles, {resolution} cells");
    let own: Vec<f64> = task.nodes().map(|node| f64::from(field.samples()[node])).collect();
    let exact = theirs[0][0].distances.clone();
    let size = mesh.bounds().size().max_element();
    let errors_of = |distances: &[f64]| {
        let pairs = || distances.iter().zip(&exact);
        let error = pairs().map(|(d, exact)| (d.abs() - exact.abs()).abs()).fold(0.0, f64::max) / size;
        let wrong_signs = pairs().filter(|&(d, exact)| d * exact < 0.0 && exact.abs() > ON_SURFACE * size).count();
        (format!("{error:.0e}"), wrong_signs.to_string())
    };
    Comparison::print_heading();
    let mut rows = Vec::new();
    for (peer, rounds) in peers.iter().zip(&theirs) {
        let of_theirs = |part: fn(&Round) -> f64| median(&mut rounds[1..].iter().map(part).collect::<Vec<_>>());
        let (build, query) = (of_theirs(|round| round.build), of_theirs(|round| round.query));
        let ((error, wrong_signs), (their_error, their_wrong_signs)) =
            (errors_of(&own), errors_of(&rounds[0].distances));
        let their_wrong_signs = if peer.has_signs() { their_wrong_signs } else { "n/a".into() };
        let accuracy = format!("error {error} / {their_error}, wrong signs {wrong_signs} / {their_wrong_signs}");
        let row = |job: &str, unit: &str, ours: f64, theirs: f64| Comparison {
            job: job.into(),
            peer: peer.name().into(),
            unit: unit.into(),
            ours,
            theirs,
            accuracy: accuracy.clone(),
        };
        row(&job, "ns/node", 1e9 * node, 1e9 * query).report();
        let whole = |build: f64, node: f64| 1e3 * (build + node * count as f64);
        rows.push(row(&format!("{job}, including preparation"), "ms", whole(hierarchy, node), whole(build, query)));
    }
    rows.iter().for_each(Comparison::report);
}

/// Measures the stages of one field with 128 cells and a band of `band_cells` cells.
fn measure_stages(mesh: &TriMesh, band_cells: f64) {
    let resolution = 128;
    let cell = mesh.bounds().size().max_element() / resolution as f64;
    let options = DistanceFieldOptions { resolution, band: band_cells * cell, ..Default::default() };
    let rounds: Vec<Stages> = (0..=ROUNDS).map(|_| build(mesh, &options).1).collect();
    let of = |part: fn(&Stages) -> f64| {
        let seconds = median(&mut rounds[1..].iter().map(part).collect::<Vec<_>>());
        format!("{:.1}", 1e3 * seconds)
    };
    print_row([
        &mesh.triangles.len().to_string(),
        &resolution.to_string(),
        &format!("{band_cells}"),
        &of(|stages| stages.hierarchy),
        &of(|stages| stages.distance),
        &of(|stages| stages.signs),
        &of(|stages| stages.spline),
    ]);
}

fn with_holes(mut mesh: TriMesh, holes: usize) -> TriMesh {
    let every = mesh.triangles.len() / holes;
    let mut number = 0;
    mesh.triangles.retain(|_| {
        number += 1;
        number % every != 0
    });
    mesh
}

fn two_threads(mesh: &TriMesh, resolution: usize) {
    let options = DistanceFieldOptions { resolution, ..Default::default() };
    let pools = [1, 2]
        .map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started"));
    let mut seconds = [const { Vec::new() }; 2];
    for _ in 0..=ROUNDS {
        for (pool, seconds) in pools.iter().zip(&mut seconds) {
            let begin = Instant::now();
            pool.install(|| drop(DistanceField::new(mesh, &options, &NoProgress).expect("a valid mesh")));
            seconds.push(begin.elapsed().as_secs_f64());
        }
    }
    // Other load on the machine can only increase the time, so take the minimum.
    let [one, two] = seconds.map(|seconds| seconds.into_iter().fold(f64::INFINITY, f64::min));
    let row = Comparison {
        job: format!(
            "signed distance grid on two threads, {}k triangles, {resolution} cells, wall time",
            mesh.triangles.len() / 1000
        ),
        peer: "isochore on one thread".into(),
        unit: "ms".into(),
        ours: 1e3 * two,
        theirs: 1e3 * one,
        accuracy: String::new(),
    };
    row.report();
}
