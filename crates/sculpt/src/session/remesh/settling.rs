//! Checks of many vertices that have moved at once. Those that may not be where they are move back.

use glam::DVec3;
use isochore_mesh::{Aabb, Cancelled, Monitor, NONE, SurfaceWalk, patch_intersects};
use rayon::prelude::*;

use super::{
    change::{MOST_TILT, MOST_TURN, SLIVER},
    remesher::Remesher,
    shape::{area_normal, smallest_sine2},
};

/// Elements that one task checks. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 256;

/// Up to this fraction of all triangles, one over the number, crossings are searched triangle by
/// triangle. Larger: a search of the whole surface for a few triangles. Smaller: slower than that.
const FEW: usize = 4;

impl Remesher<'_> {
    /// Checks the triangles at the vertices `moved`, in ascending order, whose positions were
    /// `before`. Vertices of triangles that are not allowed move back. Returns the vertices that
    /// have moved back.
    pub(super) fn settle(
        &mut self,
        moved: &[u32],
        before: &[DVec3],
        monitor: &dyn Monitor,
    ) -> Result<Vec<u32>, Cancelled> {
        let mut is_moved = vec![false; before.len()];
        moved.iter().for_each(|&vertex| is_moved[vertex as usize] = true);
        let mut pending = self.surface.triangles_around(moved, &[]);
        loop {
            self.surface.update_tree(&pending);
            let mut bad = self.find_bad(&pending, before);
            bad.extend(self.find_far_samples(&pending));
            bad.extend(self.find_crossing(&pending, monitor)?);
            let mut back: Vec<u32> = bad
                .iter()
                .flat_map(|&triangle| self.surface.topology.triangles()[triangle as usize].vertices)
                .collect();
            back.sort_unstable();
            back.dedup();
            back.retain(|&vertex| is_moved[vertex as usize]);
            if back.is_empty() {
                break;
            }
            for &vertex in &back {
                is_moved[vertex as usize] = false;
                self.surface.positions.set(vertex, before[vertex as usize]);
            }
            pending = self.surface.triangles_around(&back, &[]);
        }
        Ok(moved.iter().copied().filter(|&vertex| !is_moved[vertex as usize]).collect())
    }

    /// Those of `triangles` that cross others, and some of the others.
    fn find_crossing(&self, triangles: &[u32], monitor: &dyn Monitor) -> Result<Vec<u32>, Cancelled> {
        if triangles.len() > self.surface.topology.alive() / FEW {
            return Ok(self.crossings(monitor)?.into_iter().flatten().collect());
        }
        monitor.check_cancelled()?;
        let crosses = |triangle: u32| {
            let Some(corners) = self.surface.corners_of(triangle) else { return false };
            let bounds = Aabb::of(corners);
            let mut surroundings = Vec::new();
            self.surface.tree.visit_box(bounds, |other| {
                let other = if other == triangle { None } else { self.surface.corners_of(other) };
                surroundings.extend(other.filter(|corners| bounds.overlaps(Aabb::of(*corners))));
            });
            patch_intersects(&[corners], &surroundings)
        };
        Ok(triangles.par_iter().with_min_len(CHUNK).copied().filter(|&triangle| crosses(triangle)).collect())
    }

    /// Triangles that are not allowed. Updates the anchors of the others.
    fn find_bad(&mut self, triangles: &[u32], before: &[DVec3]) -> Vec<u32> {
        let anchors: Vec<u32> = triangles
            .par_iter()
            .with_min_len(CHUNK)
            .map(|&triangle| self.anchor_if_allowed(triangle, before).unwrap_or(NONE))
            .collect();
        let mut bad = Vec::new();
        for (&triangle, anchor) in triangles.iter().zip(anchors) {
            if anchor == NONE {
                bad.push(triangle);
            } else {
                self.anchors[triangle as usize] = anchor;
            }
        }
        bad
    }

    /// The new anchor of a triangle that has moved, if it keeps its orientation and shape and is
    /// within the allowed deviation.
    fn anchor_if_allowed(&self, triangle: u32, before: &[DVec3]) -> Option<u32> {
        let record = &self.surface.topology.triangles()[triangle as usize];
        let corners = record.vertices.map(|vertex| self.surface.position(vertex));
        let earlier = record.vertices.map(|vertex| before[vertex as usize]);
        let (normal, was) = (area_normal(&corners), area_normal(&earlier));
        let is_upright = normal != DVec3::ZERO && normal.dot(was) >= MOST_TURN * normal.length() * was.length();
        let sine2 = smallest_sine2(&corners);
        if !is_upright || sine2 < SLIVER && sine2 < smallest_sine2(&earlier) {
            return None;
        }
        let [a, b, c] = corners;
        let start = self.anchors[triangle as usize];
        let foot = self.reference.foot(start, (a + b + c) / 3.0);
        let reference = self.reference.normals[foot.triangle as usize];
        let is_tilted = reference != DVec3::ZERO && normal.dot(reference) < MOST_TILT * normal.length();
        let is_near = foot.squared <= self.allowance2
            && (0..3).all(|side| {
                // Each edge once.
                let [one, other] = [side, (side + 1) % 3];
                (record.twins[side] != NONE && record.vertices[one] > record.vertices[other])
                    || self.reference.is_near(start, [corners[one], corners[other]], self.allowance2)
            });
        (is_near && !is_tilted).then_some(foot.triangle)
    }

    /// Triangles nearest to samples that are too far away from the surface. Assigns all samples of
    /// `triangles` to the triangles that are nearest now.
    fn find_far_samples(&mut self, triangles: &[u32]) -> Vec<u32> {
        let samples: Vec<u32> = triangles.iter().flat_map(|&triangle| self.samples.of(triangle)).collect();
        let walk = SurfaceWalk::new(self.surface.topology.triangles(), self.surface.positions.items());
        let feet: Vec<(u32, f64)> = samples
            .par_iter()
            .with_min_len(CHUNK)
            .map(|&sample| {
                let (point, home) = (self.samples.points[sample as usize], self.samples.homes[sample as usize]);
                let foot = walk.nearest(home, point, |_| false);
                (foot.triangle, foot.squared)
            })
            .collect();
        let mut far = Vec::new();
        let mut has_changed = false;
        for (&sample, (triangle, squared)) in samples.iter().zip(feet) {
            let home = &mut self.samples.homes[sample as usize];
            if squared > self.allowance2 {
                far.extend([triangle, *home]);
            }
            has_changed |= *home != triangle;
            *home = triangle;
        }
        if has_changed {
            self.samples.link_all(self.surface.topology.triangles().len());
        }
        far
    }
}
