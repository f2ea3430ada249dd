//! The lock under certificate: it displaces no vertex so that triangles cross.

use glam::DVec3;
use isochore_mesh::Cancelled;
use web_time::Instant;

use super::{
    certificate::Crossings,
    lock::{Lock, lock_with_weights},
    passage::Context,
    tessellation::Tessellation,
};

/// Most rounds. Each holds more vertices around the crossings that the round before has found. A larger
/// value locks surfaces whose sheets nearly touch everywhere; a smaller value skips more locks.
const MAX_ROUNDS: usize = 5;

/// Rings of vertices over which the weight rises from a held vertex to the full lock. A larger value
/// holds more of the surface; a smaller value makes a step beside the held vertices.
const RAMP: usize = 4;

/// The lock, computed and not yet applied.
#[derive(Debug, Default)]
pub(super) struct LockPreparation {
    /// Locked positions of the vertices, or `None` if the lock is skipped.
    pub(super) locked: Option<(Vec<DVec3>, Lock)>,
    /// New crossings by the last attempt, if the lock is skipped because of them.
    pub(super) crossing: usize,
    /// Wall time, seconds.
    pub(super) seconds: f64,
}

/// Finds the displacement to `volume`. Vertices around triangles that would cross are held, and the
/// others move by more. Without refinement none is held, because coarse triangles cross anyway, and
/// the receipt counts them.
pub(super) fn prepare_lock(
    mesh: &Tessellation,
    volume: f64,
    context: &Context<'_>,
) -> Result<LockPreparation, Cancelled> {
    let begin = Instant::now();
    let mut preparation = LockPreparation::default();
    let mut weights = vec![1.0; mesh.image.len()];
    let mut rings = Rings::new(mesh);
    // Crossings that the lock does not cause.
    let mut unlocked = None;
    for round in 1..=MAX_ROUNDS {
        let mut image = mesh.image.clone();
        let lock = lock_with_weights(&mesh.rest, &mut image, &mesh.triangles, &weights, volume);
        preparation.crossing = 0;
        let Some(lock) = lock else { break };
        if context.criteria.is_none() {
            preparation.locked = Some((image, lock));
            break;
        }
        let shifted = mesh.triangles_with(|vertex| image[vertex] != mesh.image[vertex]);
        let mut crossings = Crossings::of(mesh, &image, &shifted, context)?;
        if !crossings.is_empty() {
            let known = match &unlocked {
                Some(known) => known,
                None => unlocked.insert(Crossings::of(mesh, &mesh.image, &shifted, context)?),
            };
            crossings.pairs.retain(|pair| known.pairs.binary_search(pair).is_err());
        }
        if crossings.is_empty() {
            preparation.locked = Some((image, lock));
            break;
        }
        preparation.crossing = crossings.triangles().len();
        rings.add(&crossings);
        // Twice as many rings each round: triangles around a film can be tiny.
        rings.reduce(&mut weights, (1 << (round - 1)) - 1);
    }
    preparation.seconds = begin.elapsed().as_secs_f64();
    Ok(preparation)
}

/// Distances of vertices from those of crossing triangles, in rings of triangles.
struct Rings<'a> {
    mesh: &'a Tessellation,
    /// Vertices of triangles that have crossed.
    has_crossed: Vec<bool>,
}

impl<'a> Rings<'a> {
    fn new(mesh: &'a Tessellation) -> Self {
        Self { mesh, has_crossed: vec![false; mesh.image.len()] }
    }

    fn add(&mut self, crossings: &Crossings) {
        for index in crossings.triangles() {
            self.mesh.triangles[index as usize].iter().for_each(|&vertex| self.has_crossed[vertex as usize] = true);
        }
    }

    /// Reduces the weights within `held` rings of crossing triangles to zero, and those of the rings
    /// around them in steps.
    fn reduce(&self, weights: &mut [f64], held: usize) {
        let mut is_within = self.has_crossed.clone();
        for ring in 0..held + RAMP {
            let weight = ring.saturating_sub(held) as f64 / RAMP as f64;
            let mut next = is_within.clone();
            for triangle in &self.mesh.triangles {
                if triangle.iter().any(|&vertex| is_within[vertex as usize]) {
                    triangle.iter().for_each(|&vertex| next[vertex as usize] = true);
                }
            }
            // Inner rings come first, so their smaller weights are kept.
            is_within.iter().zip(&mut *weights).filter(|(within, _)| **within).for_each(|(_, w)| *w = w.min(weight));
            is_within = next;
        }
    }
}
