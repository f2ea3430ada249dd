use std::fs;

use glam::DVec3;
use isochore_bench::{scan_of_cube, scratch};
use isochore_field::{DeformOptions, Move, Pose, Profile, RefineOptions, Stroke, Tool, advect_points, deform};
use isochore_mesh::{
    ClosedMesh, DistanceField, DistanceFieldOptions, NoProgress, SelfIntersections, Sphere, Topology, TriMesh, io,
};

use crate::{Extent, series::Series};

/// Segments of the scans: from 10⁴ triangles to 10⁷ by half powers of ten.
const SEGMENTS: [usize; 7] = [29, 51, 91, 162, 289, 513, 913];

/// Vertices that a local stroke reaches, whatever the mesh.
pub(crate) const LOCAL_VERTICES: f64 = 1000.0;

/// Reach of a stroke that grows with nothing: it touches about a tenth of the vertices.
const WIDE: f64 = 0.6;

/// Splitting makes about five triangles of each, which take 120 bytes each twice: more of them than from this many triangles
/// do not fit into 6 GB.
const LARGEST_SPLIT: usize = 3_200_000;

/// What is done to a mesh, and its deformations, at growing numbers of triangles.
pub(crate) fn measure(extent: Extent) -> [Vec<Series>; 2] {
    let mut mesh_series = [
        "reading OBJ",
        "reading PLY",
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
        "flow of points, a tenth touched",
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
        series.measure(triangles, limit, || io::read(&path).expect("it was written"));
        fs::remove_file(&path).expect("it was written");
    }
    check.measure(triangles, limit, || mesh.check());
    topology.measure(triangles, limit, || Topology::of(mesh));
    closedness.measure(triangles, limit, || ClosedMesh::new(mesh).is_ok());
    volume.measure(triangles, limit, || mesh.volume());
    self_intersection.measure(triangles, limit, || SelfIntersections::of(mesh, &NoProgress).expect("a sound mesh"));
    if triangles <= LARGEST_SPLIT {
        let longest = 0.6 * mesh.edge_lengths().expect("edges").mean;
        split.measure(triangles, limit, || {
            mesh.split_to_length(longest, usize::MAX, &NoProgress).expect("a sound mesh")
        });
    }
    let options = DistanceFieldOptions::default();
    grid.measure(triangles, limit, || DistanceField::new(mesh, &options, &NoProgress).expect("a sound mesh"));
}

fn measure_deformations(series: &mut [Series; 5], mesh: &TriMesh, extent: Extent) {
    let triangles = mesh.triangles.len();
    let [local, local_refined, wide, wide_refined, flow] = series;
    let reach = reach_of(LOCAL_VERTICES, mesh);
    let middle = mesh.positions[mesh.positions.len() / 2];
    for (reach, plain, refined) in [(reach, local, local_refined), (WIDE, wide, wide_refined)] {
        let strokes = [press(middle, reach)];
        for (series, options) in [(plain, PLAIN), (refined, refinement())] {
            series.measure(triangles, extent.seconds, || {
                deform(mesh, &strokes, &options, &NoProgress).expect("a sound mesh")
            });
        }
    }
    let strokes = [press(middle, WIDE)];
    flow.measure(triangles, extent.seconds, || {
        advect_points(&mesh.positions, &strokes, &NoProgress).expect("no stamp")
    });
}

/// Reach of a stroke that touches about this number of vertices.
pub(crate) fn reach_of(vertices: f64, mesh: &TriMesh) -> f64 {
    // A ball of radius r around a point of the unit sphere holds r²/4 of its area, and there are two triangles a vertex.
    (8.0 * vertices / mesh.triangles.len() as f64).sqrt()
}

/// The mesh keeps its triangles.
pub(crate) const PLAIN: DeformOptions = DeformOptions { refine: None, lock: true };

/// The mesh is refined as by default, but without a limit on triangles, which would end it early on large meshes.
pub(crate) fn refinement() -> DeformOptions {
    let refine = RefineOptions { max_triangles: usize::MAX, ..RefineOptions::default() };
    DeformOptions { refine: Some(refine), lock: true }
}

/// A ball whose field ends at `reach` is pushed into the surface at `point`, by a sixth of that.
pub(crate) fn press(point: DVec3, reach: f64) -> Stroke {
    let ball = Sphere::new(0.5 * reach).expect("a radius");
    let tool = Tool::new(std::sync::Arc::new(ball), 0.5 * reach, Profile::Quintic).expect("a support");
    let outward = reach * point.normalize();
    let keys = [0.5, 1.0 / 3.0].map(|height| Pose::at(point + height * outward));
    Stroke::Move(Move::new(std::sync::Arc::new(tool), keys.into(), 0.125).expect("a way"))
}
