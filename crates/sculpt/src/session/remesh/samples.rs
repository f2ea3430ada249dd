//! Points of the surface before a remesh, each assigned to the nearest triangle of the present
//! surface, to measure how far the present surface is from them.

use glam::DVec3;
use isochore_mesh::NONE;

/// The points, in one list for each triangle.
#[derive(Debug, Clone, Default)]
pub(super) struct Samples {
    pub(super) points: Vec<DVec3>,
    /// The triangle of each point.
    pub(super) homes: Vec<u32>,
    /// The first point of each triangle.
    first: Vec<u32>,
    /// The next point of the same triangle.
    following: Vec<u32>,
}

impl Samples {
    /// Assigns points to `homes`, which are triangles below `triangles`.
    pub(super) fn new(points: Vec<DVec3>, homes: Vec<u32>, triangles: usize) -> Self {
        let mut samples = Self { following: vec![NONE; points.len()], points, homes, first: Vec::new() };
        samples.link_all(triangles);
        samples
    }

    /// Builds the lists from `homes`.
    pub(super) fn link_all(&mut self, triangles: usize) {
        self.first.clear();
        self.first.resize(triangles, NONE);
        for sample in 0..self.points.len() {
            let first = &mut self.first[self.homes[sample] as usize];
            self.following[sample] = *first;
            *first = sample as u32;
        }
    }

    /// The points of a triangle.
    pub(super) fn of(&self, triangle: u32) -> impl Iterator<Item = u32> + '_ {
        let some = |sample: u32| (sample != NONE).then_some(sample);
        let first = self.first.get(triangle as usize).copied().and_then(some);
        std::iter::successors(first, move |&sample| some(self.following[sample as usize]))
    }

    /// Removes all points of a triangle from its list.
    pub(super) fn clear(&mut self, triangle: u32) {
        if let Some(first) = self.first.get_mut(triangle as usize) {
            *first = NONE;
        }
    }

    /// Assigns a point, which is in no list, to a triangle.
    pub(super) fn assign(&mut self, sample: u32, triangle: u32) {
        if triangle as usize >= self.first.len() {
            self.first.resize(triangle as usize + 1, NONE);
        }
        self.homes[sample as usize] = triangle;
        self.following[sample as usize] = self.first[triangle as usize];
        self.first[triangle as usize] = sample;
    }
}
