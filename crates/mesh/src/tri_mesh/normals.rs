//! Angle-weighted normals (Thürmer and Wüthrich, "Computing vertex normals from polygonal facets",
//! 1998).

use glam::DVec3;

use crate::TriMesh;
use crate::measure::{angle_between, triangle_normal};

impl TriMesh {
    /// Unit normals by vertex: the sum of the adjacent triangles' normals, each weighted by its
    /// angle at the vertex.
    ///
    /// The normal is zero at vertices without a triangle of positive area, and if the sum vanishes.
    ///
    /// # Panics
    /// If an index is out of range.
    ///
    /// ```
    /// let ball = isochore_mesh::primitives::icosphere(2.0, 3);
    /// let normals = ball.vertex_normals();
    /// assert!(normals.iter().zip(&ball.positions).all(|(n, p)| n.dot(p.normalize()) > 0.999));
    /// ```
    pub fn vertex_normals(&self) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let weighted = weighted_normals(&self.positions, triangle);
            for (&vertex, normal) in triangle.iter().zip(weighted) {
                normals[vertex as usize] += normal;
            }
        }
        normals.into_iter().map(DVec3::normalize_or_zero).collect()
    }

    /// Rotates the shading normals, if any, of a mesh that was deformed from the positions `rest`.
    ///
    /// Corners at a vertex with equal normals rotate together, by the smallest rotation from the
    /// angle-weighted mean of their triangles' normals at rest to the current mean. Hard edges
    /// therefore stay hard, and authored normals keep their offset from the mean. If no triangle at
    /// a corner moved, its normal keeps its bits.
    ///
    /// # Panics
    /// If an index is out of range, or `rest` has fewer positions than the mesh.
    pub fn turn_normals(&mut self, rest: &[DVec3]) {
        let normals = &self.corner.normals;
        let has_moved = |vertex: u32| self.positions[vertex as usize] != rest[vertex as usize];
        let key = |corner: u32| {
            let (triangle, side) = (corner as usize / 3, corner as usize % 3);
            (self.triangles[triangle][side], normals[triangle][side].to_array().map(f32::to_bits))
        };
        // Only vertices next to a moved one need new normals.
        let mut is_near = vec![false; self.positions.len()];
        for triangle in self.triangles.iter().filter(|triangle| triangle.iter().any(|&vertex| has_moved(vertex))) {
            triangle.iter().for_each(|&vertex| is_near[vertex as usize] = true);
        }
        let is_affected = |&corner: &u32| is_near[self.triangles[corner as usize / 3][corner as usize % 3] as usize];
        let mut corners: Vec<u32> = (0..3 * normals.len() as u32).filter(is_affected).collect();
        corners.sort_unstable_by_key(|&corner| (key(corner), corner));

        let mut rotated = normals.clone();
        for group in corners.chunk_by(|&a, &b| key(a) == key(b)) {
            let triangles = group.iter().map(|corner| &self.triangles[*corner as usize / 3]);
            if !triangles.flatten().any(|&vertex| has_moved(vertex)) {
                continue;
            }
            let mean = |positions: &[DVec3]| {
                let weighted = |&corner: &u32| {
                    weighted_normals(positions, &self.triangles[corner as usize / 3])[corner as usize % 3]
                };
                group.iter().map(weighted).sum::<DVec3>().try_normalize()
            };
            if let (Some(from), Some(to)) = (mean(rest), mean(&self.positions)) {
                for &corner in group {
                    let normal = &mut rotated[corner as usize / 3][corner as usize % 3];
                    *normal = rotate(normal.as_dvec3(), from, to).as_vec3();
                }
            }
        }
        self.corner.normals = rotated;
    }
}

/// The triangle's unit normal times its angle at each corner; zero for a triangle without area.
fn weighted_normals(positions: &[DVec3], triangle: &[u32; 3]) -> [DVec3; 3] {
    let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
    let normal = triangle_normal([a, b, c]);
    [(b - a, c - a), (c - b, a - b), (a - c, b - c)].map(|(u, v)| normal * angle_between(u, v))
}

/// Two directions are opposite if one plus the cosine of their angle is below this value; the axis
/// of the rotation is then undefined. With a larger value normals that rotate far jump; with a
/// smaller one the division loses all digits.
const OPPOSITE: f64 = 1e-8;

/// `normal` rotated by the smallest rotation that takes the unit vector `from` to `to` (Rodrigues'
/// formula).
fn rotate(normal: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    let cosine = from.dot(to);
    if 1.0 + cosine < OPPOSITE {
        return to;
    }
    let axis = from.cross(to);
    (cosine * normal + axis.cross(normal) + axis * (axis.dot(normal) / (1.0 + cosine))).normalize_or(to)
}
