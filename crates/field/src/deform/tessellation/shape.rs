//! Boxes, volumes and areas of blocks of triangles.

use std::ops::Range;

use isochore_mesh::{Aabb, VolumeFrame};

use super::{Tessellation, area, blocks::Blocks, midpoints::UNFOLLOWED, sum};
use crate::flow::advection::CHUNK;

/// Bounds, volume and area of the images of a block of triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    /// Box around the corners and the followed midpoints.
    bounds: Aabb,
    /// Six times the volume between them and the center of the frame.
    six_volumes: f64,
    /// Area of the triangles that have moved from the base.
    moved_area: f64,
}

impl Tessellation {
    /// The triangles of all blocks whose bounds overlap a box, in ascending order.
    pub(crate) fn triangles_in(&mut self, bounds: Aabb) -> Vec<u32> {
        let count = self.triangles.len();
        let blocks = self.update_shapes().enumerate().filter(|(_, shape)| shape.bounds.overlaps(bounds));
        let triangles = |block: usize| (block * CHUNK) as u32..count.min((block + 1) * CHUNK) as u32;
        blocks.flat_map(|(block, _)| triangles(block)).collect()
    }

    /// Signed volume inside the images of the triangles.
    pub(crate) fn image_volume(&mut self) -> f64 {
        let bounds = self.update_shapes().fold(Aabb::EMPTY, |bounds, shape| bounds.union(shape.bounds));
        // A center far from the image would lose digits of the sum to cancellation.
        if !self.frame.is_centered_in(bounds) {
            self.frame = VolumeFrame::of(&self.image);
            self.shapes.clear();
        }
        let six_volumes = sum(self.update_shapes().map(|shape| shape.six_volumes));
        self.frame.volume(six_volumes)
    }

    /// Area of the images of the triangles that have moved from the base.
    pub(crate) fn moved_area(&mut self) -> f64 {
        sum(self.update_shapes().map(|shape| shape.moved_area))
    }

    fn update_shapes(&mut self) -> impl Iterator<Item = Shape> {
        let mut shapes = std::mem::replace(&mut self.shapes, Blocks::NONE);
        let compute = |triangles: Range<usize>| {
            let midpoints = triangles.clone().flat_map(|index| self.midpoints_of(index));
            let midpoints = midpoints.filter(|&midpoint| midpoint != UNFOLLOWED);
            let midpoints = midpoints.map(|midpoint| self.midpoints.image[midpoint as usize]);
            let corners = triangles.clone().flat_map(|index| self.image_of(index));
            Shape {
                bounds: Aabb::of(corners.chain(midpoints)),
                six_volumes: sum(triangles.clone().map(|index| self.frame.six_volumes(self.image_of(index)))),
                moved_area: sum(triangles
                    .filter(|&index| self.has_moved(index))
                    .map(|index| area(self.image_of(index)))),
            }
        };
        shapes.fill(self.triangles.len(), compute);
        self.shapes = shapes;
        self.shapes.iter()
    }
}
