//! A disc whose colors form a Tai Chi sign once its rim turns by half a turn, with an angle that grows with the squared radius.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3, DVec4};
use isochore_mesh::TriMesh;

/// Rings of points about the middle of each face; the k-th has six times k points.
const RINGS: usize = 34;

/// Layers of the side.
const LAYERS: usize = 4;

const THICKNESS: f64 = 0.12;

/// Radius of the dots, and distance of their centers from that of the disc.
const DOT: (f64, f64) = (0.13, 0.5);

const DARK: DVec4 = DVec4::new(0.02, 0.02, 0.025, 1.0);
const LIGHT: DVec4 = DVec4::new(0.85, 0.84, 0.8, 1.0);

/// The disc of radius one in the plane of x and y.
pub(crate) fn disc() -> TriMesh {
    let mut mesh = TriMesh::default();
    let half = 0.5 * THICKNESS;
    let top = face(&mut mesh, half);
    let bottom = face(&mut mesh, -half);
    // The triangles of the second face point down.
    let count = mesh.triangles.len();
    mesh.triangles[count / 2..].iter_mut().for_each(|triangle| triangle.swap(1, 2));

    let mut above = top;
    for layer in 1..=LAYERS {
        let below = if layer == LAYERS {
            bottom
        } else {
            let start = mesh.positions.len() as u32;
            let height = half - THICKNESS * layer as f64 / LAYERS as f64;
            mesh.positions.extend(ring(RINGS, height));
            start
        };
        let points = 6 * RINGS as u32;
        for point in 0..points {
            let next = (point + 1) % points;
            let [a, b, c, d] = [above + point, above + next, below + next, below + point];
            mesh.triangles.extend([[a, d, c], [a, c, b]]);
        }
        above = below;
    }
    mesh.vertex.colors = mesh.positions.iter().map(|&position| color(position)).collect();
    mesh
}

/// Appends a face that points up, and returns the first point of its outermost ring.
fn face(mesh: &mut TriMesh, height: f64) -> u32 {
    let middle = mesh.positions.len() as u32;
    mesh.positions.push(DVec3::Z * height);
    let (mut inner, mut outer) = (middle, middle + 1);
    for count in 1..=RINGS {
        mesh.positions.extend(ring(count, height));
        let (outer_count, inner_count) = (6 * count as u32, (6 * (count as u32 - 1)).max(1));
        for sextant in 0..6 {
            let (outer_start, inner_start) = (sextant * count as u32, sextant * (count as u32 - 1));
            for step in 0..count as u32 {
                let a = outer + outer_start + step;
                let b = outer + (outer_start + step + 1) % outer_count;
                let c = inner + (inner_start + step) % inner_count;
                mesh.triangles.push([a, b, c]);
                if step + 1 < count as u32 {
                    mesh.triangles.push([b, inner + (inner_start + step + 1) % inner_count, c]);
                }
            }
        }
        (inner, outer) = (outer, outer + outer_count);
    }
    inner
}

fn ring(count: usize, height: f64) -> impl Iterator<Item = DVec3> {
    let points = 6 * count;
    (0..points).map(move |point| {
        let (sine, cosine) = libm::sincos(TAU * point as f64 / points as f64);
        let radius = count as f64 / RINGS as f64;
        DVec3::new(radius * cosine, radius * sine, height)
    })
}

/// Two halves, each with a dot of the other color that becomes round once the disc has turned.
fn color(position: DVec3) -> DVec4 {
    let plane = position.truncate();
    let (sine, cosine) = libm::sincos(PI * plane.length_squared());
    let turned = DVec2::new(cosine, sine).rotate(plane);
    // At the dots' radius the disc turns by an eighth of a turn beyond the quarter at which they lie.
    let (sine, cosine) = libm::sincos(0.5 * PI + PI * DOT.1 * DOT.1);
    let dot = DOT.1 * DVec2::new(cosine, sine);
    // Colors blend over the width of a triangle, so that outlines are smooth.
    let width = 1.0 / RINGS as f64;
    let in_dot = |middle: DVec2| ((DOT.0 - turned.distance(middle)) / width + 0.5).clamp(0.0, 1.0);
    let half = (plane.y / width + 0.5).clamp(0.0, 1.0);
    DARK.lerp(LIGHT, half * (1.0 - in_dot(dot)) + in_dot(-dot))
}
