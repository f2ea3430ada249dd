//! How far fields reach, cut open: the tool, the reach of its field, and an inner offset surface as three shells (figure 11.7
//! of Zheng's thesis); and the reach of a field that depends on a radius beside that of one that depends on the shape (figure
//! 12.2).

use std::error::Error;

use fast_surface_nets::{
    SurfaceNetsBuffer,
    ndshape::{RuntimeShape, Shape},
    surface_nets,
};
use glam::DVec3;
use isochore_examples::{save_picture, scene};
use isochore_field::{Stroke, Tool};
use isochore_mesh::{Aabb, TriMesh};
use isochore_picture::{Body, Camera, Options, Paint, Panel};
use rayon::prelude::*;

const ROSE: DVec3 = DVec3::new(0.75, 0.30, 0.33);
const GREEN: DVec3 = DVec3::new(0.22, 0.50, 0.18);
const BLUE: DVec3 = DVec3::new(0.10, 0.22, 0.62);
const PALE_BLUE: DVec3 = DVec3::new(0.35, 0.58, 0.78);

/// Cells along the longest side of the grids on which shells are found.
const CELLS: f64 = 110.0;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = scene("knight")?;
    let Some(Stroke::Move(stroke)) = scene.strokes.first() else { return Err("the knight moves".into()) };
    let tool = stroke.tool();
    // Seen in profile, cut along it.
    let camera = Camera { direction: DVec3::new(0.25, -1.0, 0.15), ..Camera::default() };
    let options = Options { width: 1100, height: 1000, ..Options::default() };

    let inner = -0.25 * tool.support();
    let [reach, body, core] = [tool.support(), 0.0, inner].map(|level| opened(&offset_surface(tool, level)));
    let caption = format!("shape, reach of the field ({:.2} beyond it), inner offset ({inner:.3})", tool.support());
    let panel = Panel::new(caption)
        .with(Body::new(&reach).with_paint(Paint::Uniform(GREEN)))
        .with(Body::new(&body).with_paint(Paint::Uniform(ROSE)))
        .with(Body::new(&core).with_paint(Paint::Uniform(BLUE)));
    save_picture("shells_knight", &[panel], &camera, &options)?;

    // Regions by a radius must hold the whole shape in their inner sphere before they reach the same support beyond.
    let bounds = tool.distance().bounds();
    let whole = offset_surface(tool, 0.0);
    let radius = whole.positions.iter().map(|&point| point.distance(tool.center())).fold(0.0, f64::max);
    let outer = radius + tool.support();
    let sphere = level_set(|point| point.distance(tool.center()) - outer, bounds.expanded(outer));
    let (sphere, sphere_volume) = (opened(&sphere), sphere.volume());
    let reach_volume = offset_surface(tool, tool.support()).volume();
    let panels = [("by radius", &sphere, sphere_volume), ("by distance from the shape", &reach, reach_volume)].map(
        |(name, shell, volume)| {
            let ratio = volume / whole.volume();
            Panel::new(format!("{name}: moves {ratio:.1} times the shape's volume"))
                .with(Body::new(shell).with_paint(Paint::Uniform(PALE_BLUE)))
                .with(Body::new(&whole).with_paint(Paint::Uniform(ROSE)))
        },
    );
    save_picture("shells_reach", &panels, &camera, &Options { width: 1600, ..options })
}

/// The surface at signed distance `level` from a tool.
fn offset_surface(tool: &Tool, level: f64) -> TriMesh {
    level_set(|point| tool.distance().sample(point).0 - level, tool.distance().bounds().expanded(level.max(0.0)))
}

/// Where `function` is zero inside `bounds`.
fn level_set(function: impl Fn(DVec3) -> f64 + Sync, bounds: Aabb) -> TriMesh {
    let cell = bounds.size().max_element() / CELLS;
    let bounds = bounds.expanded(2.0 * cell);
    let size = (bounds.size() / cell).ceil().as_uvec3() + 1;
    let shape = RuntimeShape::<u32, 3>::new(size.to_array());
    let place = |index: [f64; 3]| bounds.min + cell * DVec3::from_array(index);
    let samples: Vec<f32> = (0..shape.size())
        .into_par_iter()
        .map(|index| function(place(shape.delinearize(index).map(f64::from))).min(cell * CELLS) as f32)
        .collect();
    let mut buffer = SurfaceNetsBuffer::default();
    surface_nets(&samples, &shape, [0; 3], (size - 1).to_array(), &mut buffer);
    TriMesh {
        positions: buffer.positions.iter().map(|&index| place(index.map(f64::from))).collect(),
        triangles: buffer.indices.as_chunks().0.to_vec(),
        ..TriMesh::default()
    }
}

/// The far half of a mesh, what lies behind the plane of x and z, with its painted side inward.
fn opened(mesh: &TriMesh) -> TriMesh {
    let is_far = |triangle: &&[u32; 3]| triangle.iter().all(|&vertex| mesh.positions[vertex as usize].y >= 0.0);
    let triangles = mesh.triangles.iter().filter(is_far).map(|&[a, b, c]| [a, c, b]).collect();
    TriMesh { positions: mesh.positions.clone(), triangles, ..TriMesh::default() }
}
