//! Strokes as a session uses them: one short way at a time, over the few points that it can touch.

use glam::DVec3;
use isochore_mesh::Aabb;
use rayon::prelude::*;

use super::Stroke;

/// Points that one task carries. Larger leaves threads idle at the end of a short way; smaller fills the lanes of the kernel less
/// well.
const CHUNK: usize = 256;

impl Stroke {
    /// Box in the world outside which the stroke moves nothing; infinite where it acts everywhere, empty for a stamp.
    pub fn reach(&self) -> Aabb {
        match self {
            Self::Move(stroke) => stroke.reach(),
            Self::Field(stroke) => stroke.reach(),
            Self::Twist(_) | Self::Bend(_) => Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY },
            Self::Stamp(_) => Aabb::EMPTY,
        }
    }

    /// Carries `points` through the stroke in place, in parallel, and returns how many times the field was evaluated. Each point
    /// gets the bits that [`advect_points`](crate::advect_points) gives it, whatever the other points. A stamp carries nothing.
    pub fn advect(&self, points: &mut [DVec3]) -> u64 {
        if points.len() <= CHUNK {
            return self.advect_chunk(points);
        }
        points.par_chunks_mut(CHUNK).map(|chunk| self.advect_chunk(chunk)).sum()
    }
}
