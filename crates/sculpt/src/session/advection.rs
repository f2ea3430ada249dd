//! What one move does: it finds what the tool touches, refines it, carries it along, and brings index and buffers up to date.

use glam::DVec3;
use rayon::prelude::*;
use web_time::Instant;

use super::{MoveReceipt, Session, SessionError, refinement::Pass, stroke::Segment, surface::Surface};

/// Points that one task carries. Larger leaves threads idle at the end of a short way; smaller fills the lanes of the kernel less
/// well.
const CHUNK: usize = 256;

/// What the flow does to some vertices.
struct Carried {
    /// Those that move, with where to.
    moved: Vec<(u32, DVec3)>,
    evaluations: u64,
}

impl Session {
    /// Carries what the tool touches along one segment, and refines there.
    pub(super) fn advect(&mut self, segment: Segment, done: &mut MoveReceipt) -> Result<(), SessionError> {
        let Some(stroke) = &mut self.stroke else { return Err(SessionError::NoStroke) };
        let surface = &mut self.surface;
        let mut last = Instant::now();
        let mut lap = || {
            let now = Instant::now();
            (now - std::mem::replace(&mut last, now)).as_secs_f64()
        };
        let refine = stroke.refine.clone();
        let mask = self.mask.as_deref();
        let mut edited = Vec::new();

        let mut near = surface.triangles_near(&segment);
        done.seconds.select += lap();
        if let Some(options) = &refine {
            let mut pass = Pass { surface, stroke, mask, edited: &mut edited, done };
            pass.resolve(&near, options, &segment);
            near.extend(&edited);
        }
        done.seconds.refine += lap();

        let mut vertices = surface.vertices_of(&near);
        vertices.extend(self.loose.iter().filter(|&&vertex| segment.reach.distance(surface.position(vertex)) == 0.0));
        done.seconds.select += lap();

        let carried = surface.carried(&vertices, &segment);
        done.evaluations += carried.iter().map(|part| part.evaluations).sum::<u64>();
        let carried = || carried.iter().flat_map(|part| &part.moved).copied();
        let overflow = carried().find(|(_, position)| !position.is_finite()).map(|(vertex, _)| vertex);
        let mut moved = Vec::new();
        if overflow.is_none() {
            for (vertex, position) in carried() {
                surface.positions.set(vertex, position);
                moved.push(vertex);
            }
            stroke.way.push(segment);
        }
        done.moved_vertices = moved.len();
        done.seconds.flow += lap();

        let mut changed = surface.triangles_at(&moved, &near);
        stroke.note_moved(&changed, surface.corners.items().len());
        if let Some(options) = refine.as_ref().filter(|_| overflow.is_none()) {
            let mut pass = Pass { surface, stroke, mask, edited: &mut edited, done };
            pass.improve(&changed, options);
        }
        if !edited.is_empty() {
            edited.extend(&changed);
            changed = surface.triangles_around(&[], &edited);
        }
        done.seconds.refine += lap();

        surface.update_tree(&changed);
        done.seconds.index += lap();
        let shaded = surface.vertices_of(&changed);
        let loose = moved.iter().copied().filter(|vertex| self.loose.binary_search(vertex).is_ok());
        surface.write_buffers(&shaded, loose);
        done.seconds.buffers += lap();
        overflow.map_or(Ok(()), |vertex| Err(SessionError::Overflow { vertex }))
    }
}

impl Surface {
    /// Where the flow of a segment takes those of `vertices` that it moves by any bit.
    fn carried(&self, vertices: &[u32], segment: &Segment) -> Vec<Carried> {
        let bits = |point: DVec3| point.to_array().map(f64::to_bits);
        let carry = |chunk: &[u32]| {
            let mut points: Vec<DVec3> = chunk.iter().map(|&vertex| self.position(vertex)).collect();
            let evaluations = segment.stroke.advect(&mut points);
            let carried = chunk.iter().copied().zip(points);
            let moved = carried.filter(|&(vertex, point)| bits(self.position(vertex)) != bits(point));
            Carried { moved: moved.collect(), evaluations }
        };
        vertices.par_chunks(CHUNK).map(carry).collect()
    }
}
