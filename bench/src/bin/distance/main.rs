//! Building a distance grid, against asking general libraries for one node after the other. Seconds are those that threads
//! worked; one core, unless a table says otherwise. An argument names a mesh to measure instead of the generated one.

#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

mod peers;
mod stages;

use std::time::Instant;

use glam::dvec3;
use isochore_bench::{cpu_seconds, median, on_one_core, print_row};
use isochore_mesh::primitives::latitude_longitude_sphere;
use isochore_mesh::{DistanceField, DistanceFieldOptions, Silent, TriMesh, io};
use peers::PEERS;
use stages::{Stages, build};

/// Rounds of each measurement, after one that warms up.
const ROUNDS: usize = 7;

/// Every so many rows of nodes are asked of other libraries, or a round would take minutes. Whole rows, because neighbors find what
/// they need in the cache. Coprime to the sides of the grids, so that they lie everywhere.
const STRIDE: usize = 17;

/// Closer to the surface than this, over the size of the mesh, a sign is a matter of rounding.
const ON_SURFACE: f64 = 1e-6;

/// A shape with hollows and ridges, which fills little of its bounding box.
fn rugged(around: usize, upward: usize) -> TriMesh {
    let mut mesh = latitude_longitude_sphere(1.0, around, upward);
    for p in &mut mesh.positions {
        let bump = 1.0 + 0.3 * (7.0 * p.x).sin() * (5.0 * p.y + 2.0 * p.z).cos() + 0.02 * (40.0 * p.z).sin();
        *p *= dvec3(0.8, 0.6, 1.0) * bump;
    }
    mesh
}

fn main() {
    let mesh = match std::env::args().nth(1) {
        Some(path) => io::read(path).expect("a mesh"),
        None => rugged(220, 160),
    };
    let fine = rugged(880, 640);
    on_one_core(|| {
        println!("peers answer every {STRIDE}th row; differences over the size of the mesh");
        compare(&mesh, 64);
        compare(&mesh, 128);
        compare(&fine, 64);

        println!("\nonly a band around the surface, milliseconds");
        print_row(["triangles", "cells", "band", "hierarchy", "distance", "signs", "spline"]);
        for band in [f64::INFINITY, 8.0, 3.0] {
            alone(&mesh, band);
        }
        println!("\n1,000 holes, milliseconds");
        print_row(["triangles", "cells", "band", "hierarchy", "distance", "signs", "spline"]);
        alone(&with_holes(mesh.clone(), 1000), f64::INFINITY);
    });
    println!("\nseconds by the clock on one and two threads");
    print_row(["triangles", "cells", "one", "two", "ratio"]);
    two_threads(&mesh, 128);
}

/// All peers and the distance field in turn.
fn compare(mesh: &TriMesh, resolution: usize) {
    let options = DistanceFieldOptions { resolution, ..Default::default() };
    let field = DistanceField::new(mesh, &options, &Silent).expect("a sound mesh");
    let [nx, ny, nz] = field.grid().dims;
    let nodes: Vec<usize> = (0..ny * nz).step_by(STRIDE).flat_map(|row| row * nx..(row + 1) * nx).collect();
    let mut ours = Vec::new();
    let mut theirs = [const { Vec::new() }; PEERS.len()];
    let mut answers = [const { Vec::new() }; PEERS.len()];
    for round in 0..=ROUNDS {
        let (_, stages) = build(mesh, &options);
        let work = PEERS.each_ref().map(|peer| {
            let begin = cpu_seconds();
            let query = (peer.build)(mesh);
            let built = cpu_seconds();
            let answers: Vec<f64> = nodes.iter().map(|&node| query(field.grid().node_at(node))).collect();
            (built - begin, cpu_seconds() - built, answers)
        });
        if round > 0 {
            ours.push(stages);
        }
        for (i, (build, query, answered)) in work.into_iter().enumerate() {
            if round > 0 {
                theirs[i].push((build, query));
            }
            answers[i] = answered;
        }
    }

    let count = field.samples().len() as f64;
    let of_ours = |part: fn(&Stages) -> f64| median(&mut ours.iter().map(part).collect::<Vec<_>>());
    let (hierarchy, spline) = (of_ours(|stages| stages.hierarchy), of_ours(|stages| stages.spline));
    let own = of_ours(|stages| stages.distance + stages.signs);
    println!();
    print_row(["triangles", "cells", "nodes", "hierarchy ms", "ns/node", "spline ns/node"]);
    print_row([
        &mesh.triangles.len().to_string(),
        &resolution.to_string(),
        &field.samples().len().to_string(),
        &format!("{:.1}", 1e3 * hierarchy),
        &format!("{:.0}", 1e9 * own / count),
        &format!("{:.0}", 1e9 * spline / count),
    ]);
    print_row(["peer", "hierarchy ms", "ns/node", "ratio", "with hierarchy", "max difference", "other signs"]);
    let size = mesh.bounds().size().max_element();
    for (peer, (theirs, answers)) in PEERS.iter().zip(theirs.iter().zip(&answers)) {
        let build = median(&mut theirs.iter().map(|work| work.0).collect::<Vec<_>>());
        let query = median(&mut theirs.iter().map(|work| work.1).collect::<Vec<_>>()) / nodes.len() as f64;
        let pairs = || nodes.iter().map(|&node| f64::from(field.samples()[node])).zip(answers.iter().copied());
        let error = pairs().map(|(ours, answer)| (ours.abs() - answer.abs()).abs()).fold(0.0, f64::max);
        let turned = pairs().filter(|(ours, answer)| ours * answer < 0.0 && ours.abs() > ON_SURFACE * size).count();
        print_row([
            peer.name,
            &format!("{:.1}", 1e3 * build),
            &format!("{:.0}", 1e9 * query),
            &format!("{:.1}", query * count / own),
            &format!("{:.1}", (build + query * count) / (hierarchy + own)),
            &format!("{:.1e}", error / size),
            &turned.to_string(),
        ]);
    }
}

/// Stages of one field at 128 cells, with a band of so many cells.
fn alone(mesh: &TriMesh, band_cells: f64) {
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
            pool.install(|| drop(DistanceField::new(mesh, &options, &Silent).expect("a sound mesh")));
            seconds.push(begin.elapsed().as_secs_f64());
        }
    }
    let [one, two] = seconds.map(|mut seconds| median(&mut seconds[1..]));
    print_row([
        &mesh.triangles.len().to_string(),
        &resolution.to_string(),
        &format!("{one:.3}"),
        &format!("{two:.3}"),
        &format!("{:.2}", one / two),
    ]);
}
