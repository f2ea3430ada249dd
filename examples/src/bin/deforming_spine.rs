//! Frames of a spine that deforms through a planar curve with an inflection. The Frenet frame flips
//! abruptly; the rotation-minimizing frame hardly changes (figure 1.2 of Zheng's thesis, on the
//! curve of its section 3.4).

use std::error::Error;

use glam::DVec3;
use isochore_curve::{
    Bezier, Frame, FrameMethod, Spine, frenet_frames, rotation_minimizing_frames, uniform_parameters,
};
use isochore_examples::{Stations, joined, save_figure, strap, swept_body};
use isochore_mesh::TriMesh;
use isochore_picture::{Body, Camera, Options, Paint, Panel};

const SEGMENTS: usize = 400;

/// Height of the two inner control points above the plane in each picture.
const HEIGHTS: [f64; 3] = [0.1, 0.02, -0.02];

fn main() -> Result<(), Box<dyn Error>> {
    let mut bodies: Vec<(String, TriMesh, Vec<DVec3>)> = Vec::new();
    for is_frenet in [true, false] {
        let mut before: Option<Vec<Frame>> = None;
        for height in HEIGHTS {
            let curve = Bezier::s_curve(height);
            let spine = Spine::sample(&curve, SEGMENTS)?;
            let frenet = frenet_frames(&curve, &uniform_parameters(&curve, SEGMENTS))?;
            // Both start with the Frenet normal.
            let frames = if is_frenet {
                frenet
            } else {
                let method = FrameMethod::DoubleReflection;
                rotation_minimizing_frames(&spine, frenet[0].r, method, Default::default())?.stations
            };
            let name = if is_frenet { "Frenet" } else { "rotation-minimizing" };
            let moved = before.as_ref().map_or("start".to_owned(), |before| {
                let largest = before
                    .iter()
                    .zip(&frames)
                    .map(|(a, b)| libm::atan2(a.r.cross(b.r).length(), a.r.dot(b.r)))
                    .fold(0.0, f64::max);
                format!("change at most {largest:.3} rad")
            });
            let (mesh, colors) = banded(&spine, &frames);
            bodies.push((format!("{name}, height {height}\n{moved}"), mesh, colors));
            before = Some(frames);
        }
    }
    let panels: Vec<Panel> = bodies
        .iter()
        .map(|(caption, mesh, colors)| {
            Panel::new(caption.clone()).with(Body::new(mesh).with_paint(Paint::Triangles(colors)))
        })
        .collect();
    let camera = Camera { up: DVec3::Y, ..Camera::from_direction(DVec3::new(0.5, -0.35, 1.0)) };
    let options = Options { width: 2400, height: 560, ..Options::default() };
    let all = bodies.iter().fold(TriMesh::default(), |all, (_, mesh, _)| joined(all, mesh));
    save_figure("deforming_spine", &all, &panels, &camera, &options)
}

/// A swept strap with one red side.
fn banded(spine: &Spine, frames: &[Frame]) -> (TriMesh, Vec<DVec3>) {
    let stations: Stations = (0..).map(|station| spine.point(station)).zip(frames.iter().copied()).collect();
    let mesh = swept_body(&stations, &strap(0.3, 0.05), false);
    let (red, pale) = (DVec3::new(0.55, 0.06, 0.03), DVec3::new(0.62, 0.55, 0.42));
    let colors = (0..mesh.triangles.len()).map(|triangle| if (triangle / 2) % 4 == 0 { red } else { pale }).collect();
    (mesh, colors)
}
