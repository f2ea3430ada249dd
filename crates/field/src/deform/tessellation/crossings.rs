//! Triangles whose images cross. Only the moved part of the surface is searched.

use glam::DVec3;
use isochore_mesh::{Aabb, Cancelled, Monitor, SelfIntersectionError, SelfIntersections, TriMesh};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::Tessellation;

/// Marks a vertex that is not in the searched part.
const NONE: u32 = u32::MAX;

impl Tessellation {
    /// Triangles that cross others at the positions `image` although the input triangles that contain
    /// them do not cross in the base; in ascending order.
    pub(crate) fn new_crossings(&self, image: &[DVec3], monitor: &dyn Monitor) -> Result<Vec<u32>, Cancelled> {
        let box_of = |triangle: &[u32; 3]| Aabb::of(triangle.map(|vertex| image[vertex as usize]));
        let has_moved: Vec<bool> = image.iter().zip(&self.base).map(|(image, base)| image != base).collect();
        // In a pair that newly crosses, one triangle has moved and the other overlaps the box of all
        // moved triangles.
        let is_moved = |triangle: &[u32; 3]| triangle.iter().any(|&vertex| has_moved[vertex as usize]);
        let moved = self.triangles.par_iter().filter(|triangle| is_moved(triangle));
        let bounds = moved.map(box_of).reduce(|| Aabb::EMPTY, Aabb::union);
        let is_near = |&index: &u32| box_of(&self.triangles[index as usize]).overlaps(bounds);
        let near: Vec<u32> = (0..self.triangles.len() as u32).into_par_iter().filter(is_near).collect();
        let found = self.crossing_pairs(image, &near, monitor)?;
        if found.is_empty() {
            return Ok(Vec::new());
        }
        let parents: FxHashSet<u32> = found.iter().flat_map(|&pair| self.parents(pair)).collect();
        let same: Vec<u32> =
            (0..self.triangles.len() as u32).filter(|&index| parents.contains(&self.parent(index as usize))).collect();
        let in_base: FxHashSet<[u32; 2]> =
            self.crossing_pairs(&self.base, &same, monitor)?.into_iter().map(|pair| self.parents(pair)).collect();
        let mut crossing: Vec<u32> =
            found.into_iter().filter(|&pair| !in_base.contains(&self.parents(pair))).flatten().collect();
        crossing.sort_unstable();
        crossing.dedup();
        Ok(crossing)
    }

    /// The input triangles that contain these two, in ascending order.
    fn parents(&self, pair: [u32; 2]) -> [u32; 2] {
        let [a, b] = pair.map(|triangle| self.parent(triangle as usize));
        [a.min(b), a.max(b)]
    }

    /// Pairs among `triangles` that cross at the given positions of the vertices.
    fn crossing_pairs(
        &self,
        positions: &[DVec3],
        triangles: &[u32],
        monitor: &dyn Monitor,
    ) -> Result<Vec<[u32; 2]>, Cancelled> {
        if triangles.is_empty() {
            return Ok(Vec::new());
        }
        let mut number = vec![NONE; positions.len()];
        let mut part = TriMesh::default();
        for &index in triangles {
            part.triangles.push(self.triangles[index as usize].map(|vertex| {
                let number = &mut number[vertex as usize];
                if *number == NONE {
                    *number = part.positions.len() as u32;
                    part.positions.push(positions[vertex as usize]);
                }
                *number
            }));
        }
        match SelfIntersections::of(&part, monitor) {
            Ok(found) => Ok(found.pairs().iter().map(|pair| pair.map(|index| triangles[index as usize])).collect()),
            Err(SelfIntersectionError::Cancelled(cancelled)) => Err(cancelled),
            // The check of the input reports a mesh that cannot be searched. Nothing can be split then.
            Err(_) => Ok(Vec::new()),
        }
    }
}
