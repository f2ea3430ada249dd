//! One move of a tool: select the triangles in reach, refine them, advect their vertices, and
//! update index and buffers.

use glam::DVec3;
use isochore_field::Mask;
use rayon::prelude::*;
use web_time::Instant;

use super::{
    InteractiveRefinement, MoveReceipt, MoveSeconds, Session, SessionError,
    path::Segment,
    refinement::{Pass, Splits},
    stroke::ActiveStroke,
    surface::Surface,
};

/// Vertices that one task advects. Larger leaves threads idle at the end of a short move; smaller
/// fills the lanes of the kernel less well.
const CHUNK: usize = 256;

/// Images of some vertices under the flow of a segment.
struct Images {
    /// The vertices that move, with their new positions.
    moved: Vec<(u32, DVec3)>,
    evaluations: u64,
}

/// Measures the stages of a move one after the other.
struct Stopwatch {
    last: Instant,
}

impl Stopwatch {
    fn start() -> Self {
        Self { last: Instant::now() }
    }

    /// Seconds since the start or the last lap.
    fn lap(&mut self) -> f64 {
        let now = Instant::now();
        (now - std::mem::replace(&mut self.last, now)).as_secs_f64()
    }
}

impl Session {
    /// Moves the tool along one segment. The receipt of the stroke includes the result, even if it
    /// is an error.
    ///
    /// # Errors
    /// [`SessionError::NoStroke`], and [`SessionError::Overflow`]: no vertex has moved, but long
    /// edges may have been split.
    pub(super) fn advect(&mut self, segment: Segment) -> Result<MoveReceipt, SessionError> {
        let Some(stroke) = &mut self.stroke else { return Err(SessionError::NoStroke) };
        let surface = &mut self.surface;
        let refine = stroke.refine.clone();
        let mask = self.mask.as_deref();
        let mut splits = Splits::default();
        let mut seconds = MoveSeconds::default();
        let mut stopwatch = Stopwatch::start();

        let mut near = surface.triangles_near(&segment);
        seconds.select += stopwatch.lap();
        if let Some(options) = &refine {
            splits += stroke.pass(surface, mask, options).split_ahead(&near, &segment);
            near.extend(&splits.triangles);
        }
        seconds.refine += stopwatch.lap();

        let mut vertices = surface.vertices_of(&near);
        vertices.extend(self.loose.iter().filter(|&&vertex| segment.reach.distance(surface.position(vertex)) == 0.0));
        seconds.select += stopwatch.lap();

        let images = surface.images(&vertices, &segment);
        let evaluations = images.iter().map(|part| part.evaluations).sum::<u64>();
        let moved = surface.move_vertices(&images);
        if moved.is_ok() {
            stroke.phase.path.segments.push(segment);
        }
        seconds.flow += stopwatch.lap();

        let moved_vertices = moved.as_deref().unwrap_or_default();
        let mut changed = surface.triangles_at(moved_vertices, &near);
        if let Some(options) = refine.as_ref().filter(|_| moved.is_ok()) {
            splits += stroke.pass(surface, mask, options).split_behind(&changed);
        }
        if !splits.triangles.is_empty() {
            let edited = [&splits.triangles[..], &changed].concat();
            changed = surface.triangles_around(&[], &edited);
        }
        seconds.refine += stopwatch.lap();

        stroke.phase.vertices.extend(moved_vertices, surface.positions.items().len());
        stroke.note(surface, &changed, &splits);

        surface.update_tree(&changed);
        seconds.index += stopwatch.lap();
        let shaded = surface.vertices_of(&changed);
        let loose = moved_vertices.iter().copied().filter(|vertex| self.loose.binary_search(vertex).is_ok());
        surface.write_buffers(&shaded, loose);
        seconds.buffers += stopwatch.lap();

        let receipt = MoveReceipt {
            moved_vertices: moved_vertices.len(),
            inserted_vertices: splits.volumes.len(),
            is_limited: splits.is_limited,
            refused_splits: splits.refused,
            evaluations: evaluations + splits.evaluations,
            is_stopped: false,
            seconds,
        };
        stroke.receipt.add(&receipt);
        moved.map(|_| receipt)
    }
}

impl Surface {
    /// Advects `vertices` along a segment without moving them. Vertices whose bits do not change
    /// are left out.
    fn images(&self, vertices: &[u32], segment: &Segment) -> Vec<Images> {
        let bits = |point: DVec3| point.to_array().map(f64::to_bits);
        let advect = |chunk: &[u32]| {
            let mut points: Vec<DVec3> = chunk.iter().map(|&vertex| self.position(vertex)).collect();
            let evaluations = segment.stroke.advect(&mut points);
            let images = chunk.iter().copied().zip(points);
            let moved = images.filter(|&(vertex, point)| bits(self.position(vertex)) != bits(point));
            Images { moved: moved.collect(), evaluations }
        };
        vertices.par_chunks(CHUNK).map(advect).collect()
    }

    /// Moves vertices to their images and returns these vertices. If a coordinate is not finite,
    /// none moves.
    fn move_vertices(&mut self, images: &[Images]) -> Result<Vec<u32>, SessionError> {
        let images = || images.iter().flat_map(|part| &part.moved).copied();
        if let Some((vertex, _)) = images().find(|(_, position)| !position.is_finite()) {
            return Err(SessionError::Overflow { vertex });
        }
        images().for_each(|(vertex, position)| self.positions.set(vertex, position));
        Ok(images().map(|(vertex, _)| vertex).collect())
    }
}

impl ActiveStroke {
    /// A pass of splits.
    pub(super) fn pass<'a>(
        &'a mut self,
        surface: &'a mut Surface,
        mask: Option<&'a Mask>,
        options: &'a InteractiveRefinement,
    ) -> Pass<'a> {
        Pass::new(surface, &mut self.phase.midpoints, &self.phase.path, mask, options, &self.tool)
    }
}
