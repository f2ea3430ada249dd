//! Quality remeshing: even triangles on the same surface.
//!
//! A remesh repeats splits of long edges, collapses of short ones, flips and tangential relaxation
//! (M. Botsch, L. Kobbelt, *A Remeshing Approach to Multiresolution Modeling*, 2004). Unlike that
//! method it checks every edit: the new triangles must stay near the surface before the remesh, that
//! surface must stay near them, and they must not cross any other triangle.

mod change;
mod collapses;
mod flips;
mod lines;
mod options;
mod passes;
mod placing;
mod reference;
mod relaxation;
mod remesher;
mod restoring;
mod rounds;
mod samples;
mod settling;
mod shape;
mod sharp;
mod sizing;
mod splits;

use glam::DVec3;
use isochore_mesh::{Monitor, NONE};
use web_time::Instant;

pub use options::{RemeshOptions, RemeshReceipt};

use super::{LockSkipped, Session, SessionError, history::Step, log::Logged, surface::Surface};
use rounds::{Locking, Outcome};

impl Session {
    /// Replaces the triangles of the surface by even ones. Undo restores all bits.
    ///
    /// Long edges are split, short ones collapsed and others flipped, and vertices move along the
    /// surface. All edits keep the surface within [`RemeshOptions::deviation`] of what it was, and none
    /// makes triangles cross. Parts that cross already stay as they are. Seams, hard edges, borders
    /// between materials, the boundary, and long chains of sharp edges are kept within the same
    /// distance. New vertices take their attributes from the point of the mesh as opened that was at
    /// their place. Frozen edges stay, and so do vertices that the mask holds.
    ///
    /// The surface then moves along its normals so that it encloses the same volume again. The
    /// displacements by the locks of earlier strokes become part of the surface from which later
    /// strokes start.
    ///
    /// A remesh is not logged, because a replay refines by its own rules.
    ///
    /// # Errors
    /// [`SessionError::StrokeUnderWay`], [`SessionError::Remesh`], [`SessionError::Cancelled`]. Nothing
    /// changes then.
    ///
    /// ```
    /// # use isochore_mesh::{NoProgress, primitives::icosphere};
    /// # use isochore_sculpt::session::{RemeshOptions, Session, SessionOptions};
    /// let mut session = Session::open(icosphere(1.0, 4), SessionOptions::default())?;
    /// let receipt = session.remesh(&RemeshOptions::default(), &NoProgress)?;
    /// assert!(receipt.triangles_after < receipt.triangles_before);
    /// assert!(receipt.volume_change.unwrap().abs() < 1e-12 * session.volume().unwrap());
    ///
    /// assert!(session.undo()?);
    /// assert_eq!(session.triangle_count(), receipt.triangles_before);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn remesh(&mut self, options: &RemeshOptions, monitor: &dyn Monitor) -> Result<RemeshReceipt, SessionError> {
        if self.stroke.is_some() {
            return Err(SessionError::StrokeUnderWay);
        }
        let start = Instant::now();
        let allowance = options.allowance(self.opened_bounds.size().max_element())?;
        let triangles_before = self.triangle_count();
        let flow_volume = self.volume();
        let shown_volume = self.opened_volume.map(|volume| volume + self.shown_volume_change());
        let locking = match (self.opened_volume, self.options.lock) {
            (None, _) => Locking::Skipped(LockSkipped::NeedsClosed),
            (_, false) => Locking::Skipped(LockSkipped::Off),
            (Some(_), true) => Locking::On,
        };
        let alive = self.surface.begin();
        self.surface.bake_offsets();
        let outcome =
            match rounds::remesh(&mut self.surface, self.mask.as_deref(), options, allowance, locking, monitor) {
                Ok(outcome) => outcome,
                Err(cancelled) => {
                    let mut delta = self.surface.finish(alive);
                    self.surface.swap(&mut delta);
                    return Err(cancelled.into());
                }
            };
        let with_triangles = |&vertex: &u32| self.surface.topology.outgoing(vertex) != NONE;
        let vertices: Vec<u32> = self.vertices().filter(with_triangles).collect();
        self.surface.write_buffers(&vertices, std::iter::empty());
        let delta = self.surface.finish(alive);

        let Outcome { tally, before, unlocked, after, lock } = outcome;
        // Without offsets, the volume of the flow is the one that the host sees.
        let since = |volume: Option<f64>| volume.map(|volume| after - volume);
        let logged =
            Logged { path: None, volume_change: since(flow_volume), shown_change: since(shown_volume).unwrap_or(0.0) };
        let step = Step { logged, delta };
        let undo_bytes = step.bytes();
        let forgotten_strokes = self.steps.push(step, self.options.undo_bytes);
        Ok(RemeshReceipt {
            triangles_before,
            triangles_after: self.triangle_count(),
            splits: tally.splits,
            collapses: tally.collapses,
            flips: tally.flips,
            is_limited: tally.is_limited,
            allowance,
            unlocked_volume_change: self.opened_volume.map(|_| unlocked - before),
            volume_change: self.opened_volume.map(|_| after - before),
            lock_max_shift: lock.ok(),
            lock_skipped: lock.err(),
            seconds: start.elapsed().as_secs_f64(),
            undo_bytes,
            forgotten_strokes,
        })
    }
}

impl Surface {
    /// Makes the positions that the host sees those of the flow.
    fn bake_offsets(&mut self) {
        for vertex in 0..self.positions.items().len() as u32 {
            if self.offsets.get(vertex) != DVec3::ZERO {
                let shown = self.shown(vertex);
                self.positions.set(vertex, shown);
                self.offsets.set(vertex, DVec3::ZERO);
            }
        }
    }
}
