//! Measures of remeshed surfaces.

use glam::DVec3;
use isochore_mesh::{Bvh, NoProgress, SelfIntersections, TriMesh};

pub(crate) fn crossing_triangles(mesh: &TriMesh) -> usize {
    SelfIntersections::of(mesh, &NoProgress).unwrap().triangles().len()
}

/// Fraction of the triangles with an angle below `degrees`.
pub(crate) fn fraction_below(mesh: &TriMesh, degrees: f64) -> f64 {
    let is_below = |&triangle: &usize| smallest_angle(&mesh.corners(triangle)) < degrees;
    (0..mesh.triangles.len()).filter(is_below).count() as f64 / mesh.triangles.len() as f64
}

/// Smallest angle, degrees.
pub(crate) fn smallest_angle(corners: &[DVec3; 3]) -> f64 {
    let angle = |corner: usize| {
        let [a, b, c] = [0, 1, 2].map(|step| corners[(corner + step) % 3]);
        let (ab, ac) = (b - a, c - a);
        libm::atan2(ab.cross(ac).length(), ab.dot(ac)).to_degrees()
    };
    angle(0).min(angle(1)).min(angle(2))
}

/// Largest distance from points of either surface to the other: vertices, middles of edges, and
/// points inside the triangles.
pub(crate) fn hausdorff(one: &TriMesh, other: &TriMesh) -> f64 {
    one_sided(one, other).max(one_sided(other, one))
}

pub(crate) fn one_sided(from: &TriMesh, to: &TriMesh) -> f64 {
    const STEPS: usize = 6;
    let bvh = Bvh::new(&to.positions, &to.triangles).unwrap();
    let mut largest: f64 = 0.0;
    for triangle in 0..from.triangles.len() {
        let [a, b, c] = from.corners(triangle);
        for i in 0..=STEPS {
            for j in 0..=STEPS - i {
                let [u, v] = [i, j].map(|step| step as f64 / STEPS as f64);
                let point = a + u * (b - a) + v * (c - a);
                largest = largest.max(bvh.closest_point(point).distance);
            }
        }
    }
    largest
}
