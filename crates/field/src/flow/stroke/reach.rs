//! The reach of a stroke, and advection of points in place, as an interactive session uses them.

use glam::DVec3;
use isochore_mesh::Aabb;
use rayon::prelude::*;

use super::Stroke;

/// Points of one task. A larger value leaves threads idle at the end of a short stroke; a smaller value
/// fills the lanes of the kernel less well.
const CHUNK: usize = 256;

impl Stroke {
    /// Box in the world outside which the stroke moves nothing. Infinite for a stroke that acts
    /// everywhere, and empty for a stamp.
    pub fn reach(&self) -> Aabb {
        match self {
            Self::Move(stroke) => stroke.reach(),
            Self::Field(stroke) => stroke.reach(),
            Self::Twist(_) | Self::Bend(_) => Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY },
            Self::Stamp(_) => Aabb::EMPTY,
        }
    }

    /// Advects `points` through the stroke in place, in parallel, and returns the number of evaluations
    /// of the field. Each point gets the same bits as from [`advect_points`](crate::advect_points). A
    /// stamp moves no points.
    pub fn advect(&self, points: &mut [DVec3]) -> u64 {
        if points.len() <= CHUNK {
            return self.advect_chunk(points);
        }
        points.par_chunks_mut(CHUNK).map(|chunk| self.advect_chunk(chunk)).sum()
    }
}
