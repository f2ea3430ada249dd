//! Supports of fields, cut open: the tool, the boundary of its support and an inner offset surface
//! (figure 11.7 of Zheng's thesis), and the support of a field defined by a radius beside that of a
//! field defined by the distance to the shape (figure 12.2).

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

/// Number of cells along the longest side of the grids that the surfaces are extracted from.
const CELLS: f64 = 110.0;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = scene("knight")?;
    let Some(Stroke::Move(stroke)) = scene.strokes.first() else {
        return Err("the recipe of the knight starts with a move".into());
    };
    let tool = stroke.tool();
    // View from the side, with a cut along the view.
    let camera = Camera { direction: DVec3::new(0.25, -1.0, 0.15), ..Camera::default() };
    let options = Options { width: 1100, height: 1000, ..Options::default() };

    let inner = -0.25 * tool.support();
    let [reach, body, core] = [tool.support(), 0.0, inner].map(|level| opened(&offset_surface(tool, level)));
    let caption = format!("shape, support of the field ({:.2} outward), inner offset ({inner:.3})", tool.support());
    let panel = Panel::new(caption)
        .with(Body::new(&reach).with_paint(Paint::Uniform(GREEN)))
        .with(Body::new(&body).with_paint(Paint::Uniform(ROSE)))
        .with(Body::new(&core).with_paint(Paint::Uniform(BLUE)));
    save_picture("shells_knight", &[panel], &camera, &options)?;

    // The inner sphere of a field defined by a radius must contain the whole shape; the support
    // extends beyond it.
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
            Panel::new(format!("{name}: moves {ratio:.1} times the volume of the shape"))
                .with(Body::new(shell).with_paint(Paint::Uniform(PALE_BLUE)))
                .with(Body::new(&whole).with_paint(Paint::Uniform(ROSE)))
        },
    );
    save_picture("shells_reach", &panels, &camera, &Options { width: 1600, ..options })
}

/// Surface at signed distance `level` from a tool.
fn offset_surface(tool: &Tool, level: f64) -> TriMesh {
    level_set(|point| tool.distance().sample(point).0 - level, tool.distance().bounds().expanded(level.max(0.0)))
}

/// Zero set of `function` inside `bounds`.
fn level_set(function: impl Fn(DVec3) -> f64 + Sync, bounds: Aabb) -> TriMesh {
    let cell = bounds.size().max_element() / CELLS;
    let bounds = bounds.expanded(2.0 * cell);
    let size = (bounds.size() / cell).ceil().as_uvec3() + 1;
    let shape = RuntimeShape::<u32, 3>::new(size.to_array());
    let position = |index: [f64; 3]| bounds.min + cell * DVec3::from_array(index);
    let samples: Vec<f32> = (0..shape.size())
        .into_par_iter()
        .map(|index| function(position(shape.delinearize(index).map(f64::from))).min(cell * CELLS) as f32)
        .collect();
    let mut buffer = SurfaceNetsBuffer::default();
    surface_nets(&samples, &shape, [0; 3], (size - 1).to_array(), &mut buffer);
    TriMesh {
        positions: buffer.positions.iter().map(|&index| position(index.map(f64::from))).collect(),
        triangles: buffer.indices.as_chunks().0.to_vec(),
        ..TriMesh::default()
    }
}

/// The half of a mesh behind the x-z plane, with flipped triangles so that its inside is visible.
fn opened(mesh: &TriMesh) -> TriMesh {
    let is_far = |triangle: &&[u32; 3]| triangle.iter().all(|&vertex| mesh.positions[vertex as usize].y >= 0.0);
    let triangles = mesh.triangles.iter().filter(is_far).map(|&[a, b, c]| [a, c, b]).collect();
    TriMesh { positions: mesh.positions.clone(), triangles, ..TriMesh::default() }
}
