use std::fs;

use glam::DVec3;
use isochore_bench::{scan_of_cube, scratch};
use isochore_field::{DeformOptions, Move, Pose, Profile, RefineOptions, Stroke, Tool, advect_points, deform};
use isochore_mesh::{
    ClosedMesh, DistanceField, DistanceFieldOptions, NoProgress, SelfIntersections, Sphere, Topology, TriMesh, io,
};

use crate::{Extent, series::Series};

/// Segments of the scans: 10⁴ to 10⁷ triangles in steps of half a power of ten.
const SEGMENTS: [usize; 7] = [29, 51, 91, 162, 289, 513, 913];

/// Vertices within reach of a local stroke, on every mesh.
pub(crate) const LOCAL_VERTICES: f64 = 1000.0;

/// Reach of a stroke with a fixed size. It touches about a tenth of the vertices.
const WIDE: f64 = 0.6;

/// Largest number of triangles for splitting. Each becomes about five triangles, which take 120
/// bytes twice. Larger: the result does not fit into 6 GB. Smaller: a shorter series.
const LARGEST_SPLIT: usize = 3_200_000;

/// Measures mesh operations and deformations at increasing numbers of triangles.
pub(crate) fn measure(extent: Extent) -> [Vec<Series>; 2] {
    let mut mesh_series = [
        "read OBJ",
        "read PLY",
        "check",
        "topology",
        "closedness",
        "volume",
        "self-intersection",
        "splitting to 0.6 mean edges",
        "distance grid of 64 cells",
    ]
    .map(Series::new);
    let mut deformations = [
        "deform, 1,000 vertices touched, no refinement",
        "deform, 1,000 vertices touched, refinement",
        "deform, a tenth touched, no refinement",
        "deform, a tenth touched, refinement",
        "advection of points, a tenth touched",
    ]
    .map(Series::new);
    for segments in SEGMENTS.into_iter().filter(|segments| 12 * segments * segments <= extent.triangles) {
        let mesh = scan_of_cube(segments);
        measure_mesh(&mut mesh_series, &mesh, extent);
        measure_deformations(&mut deformations, &mesh, extent);
    }
    [mesh_series.into(), deformations.into()]
}

fn measure_mesh(series: &mut [Series; 9], mesh: &TriMesh, extent: Extent) {
    let (triangles, limit) = (mesh.triangles.len(), extent.seconds);
    let [obj, ply, check, topology, closedness, volume, self_intersection, split, grid] = series;
    for (series, ending) in [(obj, "obj"), (ply, "ply")] {
        let path = scratch().join("growth").with_extension(ending);
        io::write(&path, mesh).expect("the scratch folder can be written");
        series.measure(triangles, limit, || io::read(&path).expect("the file was written"));
        fs::remove_file(&path).expect("the file was written");
    }
    check.measure(triangles, limit, || mesh.check());
    topology.measure(triangles, limit, || Topology::of(mesh));
    closedness.measure(triangles, limit, || ClosedMesh::new(mesh).is_ok());
    volume.measure(triangles, limit, || mesh.volume());
    self_intersection.measure(triangles, limit, || SelfIntersections::of(mesh, &NoProgress).expect("a valid mesh"));
    if triangles <= LARGEST_SPLIT {
        let longest = 0.6 * mesh.edge_lengths().expect("edges").mean;
        split.measure(triangles, limit, || {
            mesh.split_to_length(longest, usize::MAX, &NoProgress).expect("a valid mesh")
        });
    }
    let options = DistanceFieldOptions::default();
    grid.measure(triangles, limit, || DistanceField::new(mesh, &options, &NoProgress).expect("a valid mesh"));
}

fn measure_deformations(series: &mut [Series; 5], mesh: &TriMesh, extent: Extent) {
    let triangles = mesh.triangles.len();
    let [local, local_refined, wide, wide_refined, advection] = series;
    let reach = reach_of(LOCAL_VERTICES, mesh);
    let center = mesh.positions[mesh.positions.len() / 2];
    for (reach, plain, refined) in [(reach, local, local_refined), (WIDE, wide, wide_refined)] {
        let strokes = [press(center, reach)];
        for (series, options) in [(plain, PLAIN), (refined, refinement())] {
            series.measure(triangles, extent.seconds, || {
                deform(mesh, &strokes, &options, &NoProgress).expect("a valid mesh")
            });
        }
    }
    let strokes = [press(center, WIDE)];
    advection.measure(triangles, extent.seconds, || {
        advect_points(&mesh.positions, &strokes, &NoProgress).expect("strokes without stamps")
    });
}

/// Reach of a stroke that touches about `vertices` vertices.
pub(crate) fn reach_of(vertices: f64, mesh: &TriMesh) -> f64 {
    // A ball of radius r around a point of the unit sphere contains r²/4 of its area. A mesh has
    // two triangles per vertex.
    (8.0 * vertices / mesh.triangles.len() as f64).sqrt()
}

/// Deformation without refinement.
pub(crate) const PLAIN: DeformOptions = DeformOptions { refine: None, lock: true };

/// Deformation with default refinement, except that the number of triangles is not limited. The
/// default limit would stop refinement early on large meshes.
pub(crate) fn refinement() -> DeformOptions {
    let refine = RefineOptions { max_triangles: usize::MAX, ..RefineOptions::default() };
    DeformOptions { refine: Some(refine), lock: true }
}

/// Presses a ball into the surface at `point` by a sixth of `reach`, the radius of its support.
pub(crate) fn press(point: DVec3, reach: f64) -> Stroke {
    let ball = Sphere::new(0.5 * reach).expect("a positive radius");
    let tool = Tool::new(std::sync::Arc::new(ball), 0.5 * reach, Profile::Quintic).expect("a positive support");
    let outward = reach * point.normalize();
    let keys = [0.5, 1.0 / 3.0].map(|height| Pose::at(point + height * outward));
    Stroke::Move(Move::new(std::sync::Arc::new(tool), keys.into(), 0.125).expect("a valid path"))
}
