//! The results of all passes over a mesh, collected into its receipt.

use glam::DVec3;
use isochore_mesh::{TriMesh, signed_volume};

use super::{
    Lock, Note, Receipt, StageSeconds, StrokeReceipt,
    certificate::Crossings,
    locking::LockPreparation,
    passage::{Action, Context, Passage, StrokePass},
    tessellation::{Tessellation, count_different},
};
use crate::flow::JacobianRange;

/// A lock that moves a vertex by more than this fraction of its shortest edge may fold triangles.
/// A larger value misses folds; a smaller value warns about harmless shifts.
const NOTABLE_LOCK_SHIFT: f64 = 0.1;

/// A facet error, estimated or measured, beyond this fraction of the volume causes a note. A larger
/// value hides visible errors; a smaller value warns about errors that the lock corrects unseen.
const NOTABLE_FACET_ERROR: f64 = 5e-3;

/// The results of all passes, in order.
pub(super) struct Passes<'a> {
    pub(super) context: Context<'a>,
    pub(super) is_lock_asked: bool,
    pub(super) passage: Passage,
    pub(super) unlocked: Unlocked,
    pub(super) lock: Option<Locked>,
    /// New crossings of the result.
    pub(super) crossings: Crossings,
}

/// Measures of the surface before the lock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unlocked {
    moved_vertices: usize,
    inserted_vertices: usize,
    /// Volume of the flat triangles, or `None` for an open mesh.
    volume: Option<f64>,
}

/// Result of the lock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Locked {
    /// The displacement, or `None` if the lock found nothing to correct.
    shift: Option<Lock>,
    /// Triangles that it would make cross, which is why it was skipped.
    crossing: usize,
    seconds: f64,
}

impl Unlocked {
    pub(super) fn measure(surface: &mut Tessellation, mesh: &TriMesh, volume: Option<f64>) -> Self {
        Self {
            moved_vertices: count_different(&surface.rest, &surface.image),
            inserted_vertices: surface.rest.len() - mesh.positions.len(),
            volume: volume.map(|_| surface.image_volume()),
        }
    }
}

impl Locked {
    /// Moves the vertices to their locked positions.
    pub(super) fn apply(prepared: LockPreparation, surface: &mut Tessellation) -> Self {
        let LockPreparation { crossing, locked, seconds } = prepared;
        let shift = locked.map(|(image, lock)| {
            surface.image = image;
            lock
        });
        Self { shift, crossing, seconds }
    }
}

impl Passes<'_> {
    /// The receipt of the deformation that led to `surface`.
    pub(super) fn receipt(&self, surface: &Tessellation) -> Receipt {
        let volume_before = self.context.volume;
        let facet_error = self.passage.facet_error;
        Receipt {
            volume_before,
            volume_before_lock: self.unlocked.volume,
            volume_after: volume_before.map(|_| signed_volume(&surface.image, &surface.triangles)),
            facet_error: volume_before.map(|_| facet_error),
            lock_max_shift: self.lock.and_then(|lock| lock.shift).map(|shift| shift.max_shift),
            lock_max_shift_per_edge: self.lock.and_then(|lock| lock.shift).map(|shift| shift.max_shift_per_edge),
            max_displacement: max_distance(&surface.rest, &surface.image),
            moved_vertices: self.unlocked.moved_vertices,
            inserted_vertices: self.unlocked.inserted_vertices,
            rebases: self.passage.rebases,
            rebase_deviation: self.passage.rebase_deviation,
            new_crossings: self.crossings.triangles().len(),
            pairs_tested: self.passage.pairs_tested + self.crossings.pairs_tested,
            strokes: self.stroke_receipts(),
            seconds: self.seconds(),
            notes: self.notes(facet_error),
        }
    }

    fn stroke_receipts(&self) -> Vec<StrokeReceipt> {
        let mut receipts: Vec<StrokeReceipt> = Vec::with_capacity(self.passage.strokes.len());
        for pass in &self.passage.strokes {
            // The change by one stroke is the change since rest less the changes by the strokes before it.
            let volume_so_far: f64 = receipts.iter().filter_map(|stroke| stroke.volume_change).sum();
            let change = self.context.volume.zip(pass.volume).and_then(|(rest, image)| relative_change(rest, image));
            receipts.push(StrokeReceipt {
                seconds: pass.seconds.advect + pass.seconds.refine,
                evaluations: pass.refinement.evaluations,
                moved: pass.moved,
                inserted: pass.refinement.inserted,
                jacobian: pass.jacobian(),
                stopped_at: pass.rewound.map(|rewound| rewound.stopped_at),
                sheets: pass.rewound.and_then(|rewound| rewound.sheets),
                volume_change: change.map(|change| change - volume_so_far),
            });
        }
        receipts
    }

    fn seconds(&self) -> StageSeconds {
        let strokes = &self.passage.strokes;
        StageSeconds {
            advect: strokes.iter().map(|pass| pass.seconds.advect).sum(),
            refine: strokes.iter().map(|pass| pass.seconds.refine).sum::<f64>() + self.passage.finishing,
            lock: self.lock.map_or(0.0, |lock| lock.seconds),
        }
    }

    /// The notes, in the order of the passes.
    fn notes(&self, facet_error: f64) -> Vec<Note> {
        let max_triangles = self.context.criteria.map_or(usize::MAX, |criteria| criteria.max_triangles());
        let strokes = self.passage.strokes.iter().enumerate();
        let mut notes: Vec<Note> = strokes.flat_map(|(index, pass)| pass.notes(index, max_triangles)).collect();
        notes.extend(self.facet_note(facet_error));
        notes.extend(self.lock_note());
        notes
    }

    fn facet_note(&self, facet_error: f64) -> Option<Note> {
        let volume = self.context.volume?;
        let change = relative_change(volume, self.unlocked.volume?)?;
        let fraction = change.abs().max((facet_error / volume).abs());
        (fraction > NOTABLE_FACET_ERROR).then_some(Note::FacetError { fraction })
    }

    fn lock_note(&self) -> Option<Note> {
        if !self.is_lock_asked {
            return None;
        }
        let Some(lock) = &self.lock else { return Some(Note::LockNeedsClosed) };
        let Some(shift) = &lock.shift else {
            return Some(match lock.crossing {
                0 => Note::LockSkipped,
                triangles => Note::LockCrossings { triangles },
            });
        };
        let ratio = shift.max_shift_per_edge;
        (ratio > NOTABLE_LOCK_SHIFT).then_some(Note::LockShift { ratio })
    }
}

impl StrokePass {
    fn jacobian(&self) -> Option<JacobianRange> {
        match self.action {
            Action::Flow(step) => step.jacobian,
            Action::Stamp { .. } => None,
        }
    }

    /// The notes on the stroke with this index.
    fn notes(&self, stroke: usize, max_triangles: usize) -> impl Iterator<Item = Note> {
        let limit = self.refinement.is_limited.then_some(Note::TriangleLimit { stroke, max_triangles });
        let stopped =
            self.rewound.map(|rewound| Note::Stopped { stroke, at: rewound.stopped_at, sheets: rewound.sheets });
        let action_notes = match self.action {
            Action::Flow(step) => {
                let halved = (step.halvings > 0).then_some(Note::StepHalved { stroke, times: step.halvings });
                [halved, step.excess().map(|range| Note::Jacobian { stroke, range }), limit]
            }
            Action::Stamp { has_touched, is_through } => [
                limit,
                (!has_touched).then_some(Note::StampMissed { stroke }),
                is_through.then_some(Note::StampThrough { stroke }),
            ],
        };
        action_notes.into_iter().chain([stopped]).flatten()
    }
}

/// Signed change of a volume as a fraction of its size, which a mesh inside out has too; `None` if the volume is zero.
fn relative_change(before: f64, after: f64) -> Option<f64> {
    (before != 0.0).then(|| (after - before) / before.abs())
}

fn max_distance(rest: &[DVec3], image: &[DVec3]) -> f64 {
    rest.iter().zip(image).map(|(rest, image)| rest.distance(*image)).fold(0.0, f64::max)
}
