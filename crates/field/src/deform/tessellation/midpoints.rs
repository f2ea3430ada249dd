//! The midpoints of edges of the base, followed through the flow.

use glam::DVec3;
use isochore_mesh::{Aabb, Cancelled, Monitor};

use super::{Tessellation, blocks::Blocks, middle};
use crate::{
    deform::curved_triangle::CurvedTriangle,
    flow::{Stroke, advection::advect},
};

/// The midpoint of the edge is not followed.
pub(super) const UNFOLLOWED: u32 = u32::MAX;

/// Midpoints of edges of the base, and their images.
#[derive(Debug, Clone)]
pub(super) struct Midpoints {
    /// Index of the midpoint for each half-edge, or [`UNFOLLOWED`]; equal along an edge.
    pub(super) of_half_edge: Vec<u32>,
    pub(super) base: Vec<DVec3>,
    pub(super) image: Vec<DVec3>,
    /// Boxes around blocks of images.
    pub(super) bounds: Blocks<Aabb>,
    /// One half-edge at each midpoint that has no image yet.
    pending: Vec<u32>,
    /// Indices that can be reused.
    pub(super) unused: Vec<u32>,
}

impl Midpoints {
    /// No midpoints; `of_half_edge` holds [`UNFOLLOWED`] for each half-edge.
    pub(super) fn none(of_half_edge: Vec<u32>) -> Self {
        Self {
            of_half_edge,
            base: Vec::new(),
            image: Vec::new(),
            bounds: Blocks::NONE,
            pending: Vec::new(),
            unused: Vec::new(),
        }
    }
}

impl Tessellation {
    /// Starts to follow the midpoint of an edge and returns its index. Its image is set by the next
    /// [`advect_followed`](Self::advect_followed).
    pub(super) fn follow(&mut self, half_edge: u32) -> u32 {
        let known = self.midpoints.of_half_edge[half_edge as usize];
        if known != UNFOLLOWED {
            return known;
        }
        let middle = middle(self.ends(half_edge), &self.base);
        let midpoints = &mut self.midpoints;
        let number = midpoints.unused.pop().unwrap_or_else(|| {
            midpoints.base.push(DVec3::ZERO);
            midpoints.image.push(DVec3::ZERO);
            midpoints.base.len() as u32 - 1
        });
        midpoints.bounds.invalidate(number as usize);
        midpoints.base[number as usize] = middle;
        midpoints.image[number as usize] = middle;
        midpoints.pending.push(half_edge);
        self.edges.around(half_edge).for_each(|half_edge| midpoints.of_half_edge[half_edge as usize] = number);
        number
    }

    /// Starts to follow the midpoints of the edges of a triangle.
    pub(crate) fn follow_edges_of(&mut self, triangle: u32) {
        (0..3).for_each(|side| _ = self.follow(3 * triangle + side));
    }

    /// Advects the newly followed midpoints through the `strokes` since the base, and records the
    /// triangles at those that move as changed. Returns the evaluations of the fields.
    pub(crate) fn advect_followed(&mut self, strokes: &[Stroke], monitor: &dyn Monitor) -> Result<u64, Cancelled> {
        let midpoints = &mut self.midpoints;
        let pending = std::mem::take(&mut midpoints.pending);
        let number = |half_edge: u32| midpoints.of_half_edge[half_edge as usize] as usize;
        let mut points: Vec<DVec3> = pending.iter().map(|&half_edge| midpoints.base[number(half_edge)]).collect();
        let evaluations = advect(&mut points, strokes, monitor)?;
        let mut changed = Vec::new();
        for (&half_edge, point) in pending.iter().zip(points) {
            let number = midpoints.of_half_edge[half_edge as usize] as usize;
            midpoints.image[number] = point;
            if point != midpoints.base[number] {
                changed.extend(self.edges.around(half_edge).map(|half_edge| half_edge / 3));
            }
        }
        self.report_changed(&changed);
        Ok(evaluations)
    }

    /// Moves the images of the newly followed midpoints to their bases, as on a frozen mesh.
    pub(crate) fn move_followed_to_base(&mut self) {
        for half_edge in std::mem::take(&mut self.midpoints.pending) {
            let number = self.midpoints.of_half_edge[half_edge as usize] as usize;
            self.midpoints.image[number] = self.midpoints.base[number];
        }
    }

    /// The image of a triangle with its midpoints, or `None` unless all are followed.
    pub(crate) fn curved(&self, triangle: usize) -> Option<CurvedTriangle> {
        let midpoints = self.midpoints_of(triangle);
        let image = |midpoint: u32| self.midpoints.image[midpoint as usize];
        (!midpoints.contains(&UNFOLLOWED))
            .then(|| CurvedTriangle { corners: self.image_of(triangle), midpoints: midpoints.map(image) })
    }

    /// The midpoints of the edges 01, 12 and 20 of a triangle.
    pub(super) fn midpoints_of(&self, triangle: usize) -> [u32; 3] {
        std::array::from_fn(|side| self.midpoints.of_half_edge[3 * triangle + side])
    }
}
