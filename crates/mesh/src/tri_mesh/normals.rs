//! Angle-weighted normals (Thürmer and Wüthrich, "Computing vertex normals from polygonal facets", 1998).

use glam::DVec3;

use crate::TriMesh;
use crate::measure::{angle_between, triangle_normal};

impl TriMesh {
    /// Unit normals by vertex: the sum of the adjacent triangles' normals, each weighted by its angle at the vertex.
    ///
    /// Zero for vertices without a triangle of positive area, and where the normals cancel.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn vertex_normals(&self) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; self.positions.len()];
        for triangle in 0..self.triangles.len() {
            let weighted = self.weighted_corner_normals(triangle);
            for (&vertex, normal) in self.triangles[triangle].iter().zip(weighted) {
                normals[vertex as usize] += normal;
            }
        }
        normals.into_iter().map(DVec3::normalize_or_zero).collect()
    }

    /// Computes the shading normals of a deformed mesh anew, where it has any, and keeps its hard edges.
    ///
    /// The corners at a vertex that shared a normal before share one afterwards: the angle-weighted mean of their
    /// triangles' normals. A corner whose triangles have no area keeps what it had.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn update_normals(&mut self) {
        if self.corner.normals.is_empty() {
            return;
        }
        let old = std::mem::take(&mut self.corner.normals);
        let key = |corner: u32| {
            let (triangle, side) = (corner as usize / 3, corner as usize % 3);
            (self.triangles[triangle][side], old[triangle][side].to_array().map(f64::to_bits))
        };
        let mut corners: Vec<u32> = (0..3 * old.len() as u32).collect();
        corners.sort_unstable_by_key(|&corner| (key(corner), corner));

        let weighted: Vec<_> = (0..old.len()).map(|triangle| self.weighted_corner_normals(triangle)).collect();
        let mut new = old.clone();
        for group in corners.chunk_by(|&a, &b| key(a) == key(b)) {
            let at = |corner: u32| (corner as usize / 3, corner as usize % 3);
            let sum: DVec3 = group.iter().map(|&corner| weighted[at(corner).0][at(corner).1]).sum();
            if let Some(normal) = sum.try_normalize() {
                group.iter().for_each(|&corner| new[at(corner).0][at(corner).1] = normal);
            }
        }
        self.corner.normals = new;
    }

    /// The triangle's unit normal times its angle at each corner; zero for a triangle without area.
    fn weighted_corner_normals(&self, triangle: usize) -> [DVec3; 3] {
        let [a, b, c] = self.corners(triangle);
        let normal = triangle_normal([a, b, c]);
        [(b - a, c - a), (c - b, a - b), (a - c, b - c)].map(|(u, v)| normal * angle_between(u, v))
    }
}
