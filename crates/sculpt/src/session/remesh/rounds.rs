//! The order of the passes of a remesh.

use isochore_field::Mask;
use isochore_mesh::{Cancelled, Monitor};

use super::{
    options::RemeshOptions,
    remesher::{Remesher, Tally},
    sizing,
};
use crate::session::{LockSkipped, surface::Surface};

/// Rounds of collapses, splits, flips and relaxation. Larger: slower, with little effect. Smaller:
/// more uneven triangles.
const ROUNDS: usize = 5;

/// Whether the volume is restored exactly.
#[derive(Debug, Clone, Copy)]
pub(super) enum Locking {
    On,
    Skipped(LockSkipped),
}

/// What a remesh did.
#[derive(Debug)]
pub(super) struct Outcome {
    pub(super) tally: Tally,
    /// Signed volumes before the remesh, before the lock, and at the end, cubic model units. Without
    /// meaning for an open surface.
    pub(super) before: f64,
    pub(super) unlocked: f64,
    pub(super) after: f64,
    /// Longest displacement by the lock, model units.
    pub(super) lock: Result<f64, LockSkipped>,
}

/// Remeshes a whole surface, whose offsets are zero.
///
/// # Errors
/// [`Cancelled`], and the surface is then in an intermediate state.
pub(super) fn remesh(
    surface: &mut Surface,
    mask: Option<&Mask>,
    options: &RemeshOptions,
    allowance: f64,
    locking: Locking,
    monitor: &dyn Monitor,
) -> Result<Outcome, Cancelled> {
    let mut remesher = Remesher::new(
        surface,
        mask,
        allowance,
        options.max_triangles,
        |reference| match options.edge_length {
            Some(length) => vec![length; reference.positions.len()],
            None => sizing::adaptive(reference, allowance),
        },
        monitor,
    )?;
    let before = remesher.volume();
    for round in 0..ROUNDS {
        monitor.check("remesh", round as f64 / ROUNDS as f64)?;
        remesher.collapse(remesher.alive());
        // The first round has not moved vertices yet, and no round would follow the last one.
        if (1..ROUNDS - 1).contains(&round) {
            remesher.shorten_targets();
        }
        remesher.split(remesher.alive());
        remesher.flip(remesher.alive());
        remesher.update_tree();
        remesher.relax(monitor)?;
    }
    remesher.flip(remesher.alive());
    remesher.update_tree();
    remesher.restore_locally(monitor)?;
    let unlocked = remesher.volume();
    let lock = match locking {
        Locking::On => remesher.lock(before, monitor)?,
        Locking::Skipped(reason) => Err(reason),
    };
    remesher.place();
    Ok(Outcome { before, unlocked, after: remesher.volume(), tally: remesher.tally, lock })
}
