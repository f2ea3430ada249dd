//! Shading normals at triangle corners: smooth across gentle bends, separate at creases.

use glam::DVec3;
use isochore_mesh::TriMesh;
use rayon::prelude::*;

/// Unit shading normals of the three corners of each triangle.
///
/// The normal of a corner is the mean of the normals of the faces at its vertex, weighted by their
/// corner angles. Only faces whose normal differs from that of the corner's own face by at most
/// `crease_angle` (degrees) count. Faces with zero area have a zero normal.
pub(crate) fn corner_normals(mesh: &TriMesh, crease_angle: f64) -> Vec<[DVec3; 3]> {
    let faces: Vec<Face> = mesh.triangles.par_iter().map(|triangle| Face::of(mesh, triangle)).collect();
    let around = CornersAround::of(mesh);
    let threshold = libm::cos(crease_angle.clamp(0.0, 180.0).to_radians());
    mesh.triangles
        .par_iter()
        .zip(&faces)
        .map(|(triangle, face)| {
            triangle.map(|vertex| {
                let sum = around.at(vertex).iter().fold(DVec3::ZERO, |sum, &corner| {
                    let other = &faces[corner as usize / 3];
                    if other.normal.dot(face.normal) >= threshold {
                        sum + other.angles[corner as usize % 3] * other.normal
                    } else {
                        sum
                    }
                });
                sum.try_normalize().unwrap_or(face.normal)
            })
        })
        .collect()
}

struct Face {
    normal: DVec3,
    angles: [f64; 3],
}

impl Face {
    fn of(mesh: &TriMesh, triangle: &[u32; 3]) -> Self {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        let angle = |at: DVec3, to: DVec3, from: DVec3| {
            let cosine = (to - at).normalize_or_zero().dot((from - at).normalize_or_zero());
            libm::acos(cosine.clamp(-1.0, 1.0))
        };
        Self {
            normal: (b - a).cross(c - a).normalize_or_zero(),
            angles: [angle(a, b, c), angle(b, c, a), angle(c, a, b)],
        }
    }
}

/// The corners at each vertex; corner `c` is corner `c % 3` of triangle `c / 3`.
struct CornersAround {
    first: Vec<u32>,
    corners: Vec<u32>,
}

impl CornersAround {
    fn of(mesh: &TriMesh) -> Self {
        let mut first = vec![0_u32; mesh.positions.len() + 1];
        for &vertex in mesh.triangles.as_flattened() {
            first[vertex as usize + 1] += 1;
        }
        for vertex in 1..first.len() {
            first[vertex] += first[vertex - 1];
        }
        let mut next = first.clone();
        let mut corners = vec![0; 3 * mesh.triangles.len()];
        for (corner, &vertex) in mesh.triangles.as_flattened().iter().enumerate() {
            corners[next[vertex as usize] as usize] = corner as u32;
            next[vertex as usize] += 1;
        }
        Self { first, corners }
    }

    fn at(&self, vertex: u32) -> &[u32] {
        &self.corners[self.first[vertex as usize] as usize..self.first[vertex as usize + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roof(height: f64) -> TriMesh {
        TriMesh {
            positions: vec![DVec3::ZERO, DVec3::Y, DVec3::new(-1.0, 0.5, -height), DVec3::new(1.0, 0.5, -height)],
            triangles: vec![[0, 1, 2], [1, 0, 3]],
            ..TriMesh::default()
        }
    }

    #[test]
    fn gentle_ridge_is_smooth_and_sharp_ridge_is_a_crease() {
        // The normals of the two faces differ by 2 atan(height): 11.4 and 90 degrees.
        let gentle = corner_normals(&roof(0.1), 40.0);
        assert!(gentle[0][0].distance(DVec3::Z) < 1e-12);
        assert!(gentle[0][0].distance(gentle[1][1]) < 1e-12);
        let sharp = corner_normals(&roof(1.0), 40.0);
        let half = core::f64::consts::FRAC_1_SQRT_2;
        assert!(sharp[0][0].distance(DVec3::new(-half, 0.0, half)) < 1e-12);
        assert!(sharp[1][1].distance(DVec3::new(half, 0.0, half)) < 1e-12);
    }
}
