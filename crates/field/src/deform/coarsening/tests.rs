use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{NoProgress, SelfIntersections, Sphere, Topology, TriMesh, primitives};

use crate::{
    deform::{
        DeformOptions, Deformed, Rebase, RefineOptions,
        certificate::Input,
        coarsening::coarsen,
        deform,
        passage::Context,
        refine::Criteria,
        tessellation::{ChosenEdges, Tessellation},
    },
    fields::{Pose, Profile, Tool},
    flow::{Move, Stroke},
};

/// Pushes a ball into the unit sphere in several places.
fn pushes(count: usize) -> Vec<Stroke> {
    let push = |index: usize| {
        let angle = 2.4 * index as f64;
        let height = 1.0 - 2.0 * (index as f64 + 0.5) / count as f64;
        let around = (1.0 - height * height).sqrt();
        let direction = DVec3::new(around * libm::cos(angle), around * libm::sin(angle), height);
        let tool = Tool::new(Arc::new(Sphere::new(0.15).unwrap()), 0.15, Profile::Quintic).unwrap();
        let keys = vec![Pose::at(1.3 * direction), Pose::at(1.0 * direction)];
        Stroke::Move(Move::new(Arc::new(tool), keys, 0.125).unwrap())
    };
    (0..count).map(push).collect()
}

fn run(mesh: &TriMesh, strokes: &[Stroke], rebase: Rebase) -> Deformed {
    let options = DeformOptions { refine: Some(RefineOptions { rebase, ..RefineOptions::default() }), lock: true };
    deform(mesh, strokes, &options, &NoProgress).unwrap()
}

/// Splits all edges of `mesh` in the middle, and merges what nothing needs.
fn split_and_coarsen(mesh: &TriMesh, rounds: usize) -> Tessellation {
    let mut surface = Tessellation::new(mesh, &Topology::of(mesh));
    let criteria = Criteria::new(&RefineOptions::default(), &surface, Some(1.0));
    for _ in 0..rounds {
        let mut chosen = ChosenEdges::default();
        (0..3 * surface.triangles.len() as u32).for_each(|half_edge| chosen.choose(&mut surface, half_edge));
        surface.advect_followed(&[], &NoProgress).unwrap();
        surface.split(&chosen);
        surface.freeze();
    }
    let input = Input::new(mesh);
    let context = Context { input: &input, criteria: Some(&criteria), volume: Some(1.0), monitor: &NoProgress };
    coarsen(&mut surface, &criteria, 1.0, &context).unwrap();
    surface
}

#[test]
fn flat_splits_are_merged_again() {
    for mesh in [primitives::icosphere(1.0, 2), primitives::box_mesh(DVec3::ONE, [3, 4, 5])] {
        let surface = split_and_coarsen(&mesh, 2);
        assert_eq!(surface.triangles.len(), mesh.triangles.len());
        assert_eq!(surface.rest, mesh.positions);
        assert_eq!(surface.image, mesh.positions);
        let sorted = |triangle: &[u32; 3]| {
            let mut sorted = *triangle;
            sorted.sort_unstable();
            sorted
        };
        assert!(surface.triangles.iter().zip(&mesh.triangles).all(|(a, b)| sorted(a) == sorted(b)));
    }
}

/// A square sheet of 3 × 3 cells.
fn sheet() -> TriMesh {
    let at = |column: u32, row: u32| 4 * row + column;
    let positions = (0..16).map(|index| DVec3::new(f64::from(index % 4), f64::from(index / 4), 0.0)).collect();
    let cell = |(column, row): (u32, u32)| {
        let [a, b, c, d] = [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
        [[a, b, c], [a, c, d]]
    };
    let cells = (0..3).flat_map(|row| (0..3).map(move |column| (column, row)));
    TriMesh { positions, triangles: cells.flat_map(cell).collect(), ..TriMesh::default() }
}

#[test]
fn borders_and_nonmanifold_edges_keep_their_vertices() {
    let mut fin = sheet();
    fin.positions.push(DVec3::Z);
    fin.triangles.push([5, 6, 16]);
    for mesh in [sheet(), fin] {
        let surface = split_and_coarsen(&mesh, 1);
        assert!(surface.triangles.len() < 3 * mesh.triangles.len());
        let on_border = |position: &&DVec3| [position.x, position.y].iter().any(|x| [0.0, 3.0].contains(x));
        assert_eq!(surface.rest.iter().filter(on_border).count(), if mesh.positions.len() == 16 { 24 } else { 25 });
        let on_fin = surface.rest.contains(&DVec3::new(1.5, 1.0, 0.0));
        assert_eq!(on_fin, mesh.positions.len() == 17);
    }
}

#[test]
fn rebases_need_fewer_triangles_and_stay_close() {
    let sphere = primitives::icosphere(1.0, 4);
    let strokes = pushes(12);
    let [never, often] = [Rebase::Never, Rebase::Every(2)].map(|rebase| run(&sphere, &strokes, rebase));
    assert_eq!((never.receipt.rebases, often.receipt.rebases), (0, 6));
    assert!(often.mesh.triangles.len() < never.mesh.triangles.len());
    assert_eq!(often.receipt.new_crossings, 0);
    assert!(SelfIntersections::of(&often.mesh, &NoProgress).unwrap().triangles().is_empty());
    let change = often.receipt.volume_after.unwrap() / often.receipt.volume_before.unwrap() - 1.0;
    assert!(change.abs() < 1e-12, "{change:e}");
    // Vertices of the input are in both.
    let count = sphere.positions.len();
    let moved = (0..count).map(|vertex| never.mesh.positions[vertex].distance(often.mesh.positions[vertex]));
    let farthest = moved.fold(0.0, f64::max);
    let deviation = often.receipt.rebase_deviation;
    assert!(deviation > 0.0 && deviation <= 6.0 * 1.25 * 2e-3, "{deviation}");
    assert!(farthest <= 2.0 * deviation, "{farthest} {deviation}");
}

#[test]
fn pieces_cover_the_input_triangles() {
    let sphere = primitives::icosphere(1.0, 4);
    let deformed = run(&sphere, &pushes(6), Rebase::Every(1));
    let area = |mesh: &TriMesh| {
        let areas = (0..mesh.triangles.len()).map(|triangle| {
            let [a, b, c] = mesh.corners(triangle);
            0.5 * (b - a).cross(c - a).length()
        });
        areas.sum::<f64>()
    };
    assert!((area(&deformed.rest) / area(&sphere) - 1.0).abs() < 1e-12);
}

#[test]
fn the_number_of_threads_does_not_change_the_bits() {
    let sphere = primitives::icosphere(1.0, 4);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&sphere, &pushes(6), Rebase::Every(1)).mesh)
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(8));
}
