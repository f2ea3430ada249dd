//! Presses a ball into a sphere with a pin that keeps a spot in place and a mirror plane that
//! repeats the dent.

#![expect(clippy::print_stdout, reason = "the measurements are the result")]

use std::{error::Error, sync::Arc};

use glam::DVec3;
use isochore_examples::save_mesh;
use isochore_field::{DeformOptions, Mask, MirrorPlane, Move, Pin, Pose, Profile, Stroke, Tool, advect_points, deform};
use isochore_mesh::{NoProgress, Sphere, primitives};

fn main() -> Result<(), Box<dyn Error>> {
    let sphere = primitives::icosphere(1.0, 4);
    let tool = Arc::new(Tool::new(Arc::new(Sphere::new(0.35)?), 0.3, Profile::Quintic)?);
    let keys = [DVec3::new(0.5, 0.0, 1.6), DVec3::new(0.46, 0.0, 1.12)].map(Pose::at).to_vec();
    let press = Stroke::Move(Move::new(tool, keys, 0.125)?);

    let pin = Pin::new(DVec3::new(0.45, 0.0, 0.893), 0.05, 0.25)?;
    let mirror = MirrorPlane::new(DVec3::ZERO, DVec3::X)?;
    let mask = Arc::new(Mask::new(vec![pin], None, vec![mirror])?);
    let masked = press.masked(&mask, sphere.bounds(), 0.125)?;

    // The flow acts on points, so the mask is checked without a mesh.
    let reflect = |point: &DVec3| DVec3::new(-point.x, point.y, point.z);
    let reflected: Vec<DVec3> = sphere.positions.iter().map(reflect).collect();
    let strokes = [masked];
    let moved = advect_points(&sphere.positions, &strokes, &NoProgress)?;
    let moved_reflected = advect_points(&reflected, &strokes, &NoProgress)?;
    let asymmetry = moved.iter().zip(&moved_reflected).map(|(a, b)| reflect(a).distance(*b)).fold(0.0, f64::max);
    let held: Vec<usize> = (0..moved.len()).filter(|&vertex| mask.is_held(sphere.positions[vertex])).collect();
    let has_moved = |&vertex: &usize| moved[vertex] != sphere.positions[vertex];
    println!("vertices moved: {} of {}", (0..moved.len()).filter(has_moved).count(), moved.len());
    println!("pinned vertices: {}, of these moved: {}", held.len(), held.iter().copied().filter(has_moved).count());
    println!("largest deviation from mirror symmetry: {asymmetry:.1e}");

    let deformed = deform(&sphere, &strokes, &DeformOptions::default(), &NoProgress)?;
    println!("relative change of volume: {:+.1e}", deformed.mesh.volume() / sphere.volume() - 1.0);
    save_mesh("mask_and_mirror", &deformed.mesh)
}
