//! Smoothness of the fields of mesh tools.
//!
//! The distance to a concave shape has kinks outside. Tools use a smoothed distance, so that their
//! velocity does not jump there. The measure is the largest change of velocity over 0.02 R, the
//! fraction 0.02 of the support, relative to the speed of the tool. For a ball of radius 0.5 and
//! support 0.3 it is 0.14.
//!
//! A test measures few points on coarse grids. The full measure takes minutes and prints its figures:
//!
//! ```text
//! cargo test --release -p isochore-sculpt --test smooth_tools -- --ignored --nocapture
//! ```

#![expect(clippy::print_stdout, reason = "the full measure prints its figures")]

use std::path::Path;

use glam::DVec3;
use isochore_field::{BodyTwist, RigidField, Tool, VelocityBlock};
use isochore_mesh::{
    Aabb, Distance, DistanceField, DistanceFieldOptions, LANES, NoProgress, Padding, PointBlock, TriMesh, io,
};
use isochore_sculpt::{
    Meshes, build_tool,
    recipe::{self, MeshTool, ToolShape, Transform},
};

/// A tool of the folder `data/recipes`: mesh, scale and support.
type Shape = (&'static str, f64, f64);

const SHAPES: [Shape; 5] =
    [("hare", 0.5, 0.3), ("knight", 0.55, 0.35), ("rocker_arm", 0.5, 0.3), ("hand", 0.42, 0.25), ("coin", 0.7, 0.3)];

fn data_mesh(name: &str) -> TriMesh {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    io::read(data.join(name).with_extension("obj")).unwrap()
}

fn tool((name, scale, support): Shape, resolution: u32) -> Tool {
    let transform = Transform { scale, ..Transform::default() };
    let shape = ToolShape::Mesh(MeshTool { mesh: name.to_owned(), resolution, transform });
    let description = recipe::Tool { shape, support, profile: Default::default(), free_form: 0.0 };
    let meshes = Meshes::from([(name.to_owned(), data_mesh(name).into())]);
    build_tool(name, &description, &meshes, &NoProgress).unwrap().0
}

/// The exact distance of a shape on the same grid.
fn exact((name, scale, support): Shape, resolution: usize) -> DistanceField {
    let mut mesh = data_mesh(name);
    mesh.positions.iter_mut().for_each(|position| *position *= scale);
    let options = DistanceFieldOptions { resolution, padding: Padding::Reach(support), ..Default::default() };
    DistanceField::new(&mesh, &options, &NoProgress).unwrap()
}

/// Points in a box and unit vectors, both spread evenly: a lattice of irrational steps.
fn scattered(bounds: Aabb) -> impl Iterator<Item = (DVec3, DVec3)> {
    (1..).map(move |index| {
        let index = f64::from(index);
        let part = (index * DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478)).fract();
        let (height, turn) = (2.0 * (index * 0.754_877_666).fract() - 1.0, (index * 0.569_840_296).fract());
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
        let flat = (1.0 - height * height).sqrt();
        (bounds.min + bounds.size() * part, DVec3::new(flat * cos, flat * sin, height))
    })
}

/// Largest change of velocity over 0.02 R, relative to the speed of the tool, at `count` points of
/// the support, for a motion along each axis.
fn jumps(tool: &Tool, count: usize) -> [f64; 3] {
    let (support, distance) = (tool.support(), tool.distance());
    let around = distance.bounds().expanded(support);
    let points = scattered(around).filter(|&(point, _)| {
        let value = distance.sample(point).0;
        value > 0.0 && value < support
    });
    let points: Vec<(DVec3, DVec3)> = points.take(count).collect();
    DVec3::AXES.map(|axis| {
        let field = RigidField::new(tool, BodyTwist { linear: axis, angular: DVec3::ZERO });
        let velocities = |points: Vec<DVec3>| {
            let none = [0.0; LANES];
            let mut out = VelocityBlock { relative: PointBlock::ZERO, distance: none, is_outside: [true; LANES] };
            field.evaluate_into(&PointBlock::gather(&points), &mut out);
            out.relative
        };
        let block = |block: &[(DVec3, DVec3)]| {
            let start = velocities(block.iter().map(|(point, _)| *point).collect());
            let end = velocities(block.iter().map(|(point, way)| point + 0.02 * support * way).collect());
            (0..block.len()).map(|lane| start.get(lane).distance(end.get(lane))).fold(0.0, f64::max)
        };
        points.chunks(LANES).map(block).fold(0.0, f64::max)
    })
}

/// Deviations of the smooth distance of a tool from the exact one.
#[derive(Debug)]
struct Deviation {
    /// Smallest ratio of the two distances, more than a cell from the surface.
    ratio: f64,
    /// Smallest cosine of the two gradients, more than a cell from the surface.
    cosine: f64,
    /// Largest exact distance of a point of the support, in supports.
    reach: f64,
    /// Largest distance from zero at a point of the exact surface, in supports.
    shift: f64,
}

fn deviation(tool: &Tool, exact: &DistanceField, count: usize) -> Deviation {
    let support = tool.support();
    let mut deviation = Deviation { ratio: 1.0, cosine: 1.0, reach: 0.0, shift: 0.0 };
    for (mut point, _) in scattered(tool.support_bounds()).take(count) {
        let ((smooth, smooth_slope), (value, slope)) = (tool.distance().sample(point), exact.sample(point));
        if smooth < support && value > exact.grid().cell {
            deviation.ratio = deviation.ratio.min(smooth / value);
            deviation.cosine = deviation.cosine.min(smooth_slope.dot(slope) / (smooth_slope.length() * slope.length()));
            deviation.reach = deviation.reach.max(value / support);
        } else if value.abs() < 0.3 * exact.grid().cell {
            for _ in 0..4 {
                let (value, slope) = exact.sample(point);
                point -= value / slope.length_squared() * slope;
            }
            let error = tool.distance().sample(point).0 - exact.sample(point).0;
            deviation.shift = deviation.shift.max(error.abs() / support);
        }
    }
    deviation
}

#[test]
fn the_velocity_of_mesh_tools_does_not_jump() {
    for shape in SHAPES {
        let [x, y, z] = jumps(&tool(shape, 64), 10_000);
        assert!(z < 0.2 && x.max(y) < 0.4, "{}: {x} {y} {z}", shape.0);
    }
}

#[test]
fn the_exact_distance_does_jump() {
    let shape = SHAPES[0];
    let exact = exact(shape, 64);
    let kinked = Tool::new(std::sync::Arc::new(exact), shape.2, Default::default()).unwrap();
    assert!(jumps(&kinked, 10_000)[2] > 0.4);
}

#[test]
#[ignore = "takes minutes; see the top of this file"]
fn full_measure() {
    println!("shape, cells, jumps along x, y and z; deviations from the exact distance");
    for shape in SHAPES {
        let mut before: Option<[f64; 3]> = None;
        for resolution in [64, 128] {
            let tool = tool(shape, resolution);
            let found = jumps(&tool, 150_000);
            let deviation = deviation(&tool, &exact(shape, resolution as usize), 150_000);
            println!("{} {resolution} {found:.3?} {deviation:.5?}", shape.0);
            if let Some(before) = before {
                println!("{} ratio of the grids {:.3?}", shape.0, [0, 1, 2].map(|axis| found[axis] / before[axis]));
            }
            before = Some(found);
        }
    }
}
