//! The volume lock at the end of a stroke: a small displacement of the moved vertices, stored
//! separately from the flow.
//!
//! The lock is under certificate: it makes no triangles cross that the host sees. Where it would,
//! vertices are held, and the others move farther.

mod part;

use super::{LockSkipped, certificate::Pair, stroke::ActiveStroke, surface::Surface};
use part::Part;

/// Most rounds. Each holds more vertices around the crossings that the round before has found.
/// Larger locks surfaces whose sheets nearly touch everywhere; smaller skips more locks.
const MAX_ROUNDS: usize = 5;

/// Result of the lock of a stroke.
pub(super) struct Locked {
    /// Longest displacement, model units, or the reason why the lock was skipped.
    pub(super) max_shift: Result<f64, LockSkipped>,
    /// Change of the shown volume by the stroke, after the lock.
    pub(super) shown_change: f64,
}

impl ActiveStroke {
    /// Adjusts the offsets of the vertices that the stroke has moved so that the shown volume is
    /// `size` again. `excess` is its deviation at the beginning of the stroke. Takes time
    /// proportional to the part that the stroke touched.
    pub(super) fn lock(&self, surface: &mut Surface, excess: f64, size: f64) -> Locked {
        let mut part = Part::new(surface, self.touched.items());
        let known = self.known_crossings(surface);
        let mut skipped = LockSkipped::NoHold;
        for round in 0..MAX_ROUNDS {
            part.reset(surface);
            let Some(max_shift) = part.shift(surface, excess, size) else {
                skipped = LockSkipped::NoHold;
                break;
            };
            // A host that keeps all triangles wants exactly these, even if they cross.
            let crossing = if self.refine.is_some() { part.crossings(surface, &known) } else { Vec::new() };
            if crossing.is_empty() {
                return Locked { max_shift: Ok(max_shift), shown_change: part.finish(surface) };
            }
            part.hold(surface, &crossing, (1 << round) - 1);
            skipped = LockSkipped::Crossings;
        }
        part.reset(surface);
        // A host that keeps all triangles has no use for offsets that make them cross either.
        part.release(surface, &known);
        Locked { max_shift: Err(skipped), shown_change: part.finish(surface) }
    }

    /// Crossings that the lock does not cause.
    fn known_crossings(&self, surface: &mut Surface) -> Vec<Pair> {
        if !self.has_crossings {
            return Vec::new();
        }
        surface.new_crossings(self.touched.items(), Surface::position)
    }
}
