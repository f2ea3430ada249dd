//! The receipt of a deformation: measures and notes.

use std::fmt;

use super::Sheets;
use crate::flow::JacobianRange;

/// Measures of a deformation. Volumes are in cubic model units, and `None` if the mesh is open.
///
/// ```
/// use glam::DVec3;
/// use isochore_field::{DeformOptions, Note, Stroke, Twist, deform};
/// use isochore_mesh::{NoProgress, primitives};
///
/// let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, 1.0)?);
/// let options = DeformOptions { refine: None, lock: true };
/// let cube = primitives::box_mesh(DVec3::ONE, [4, 4, 4]);
/// let receipt = deform(&cube, &[twist], &options, &NoProgress)?.receipt;
/// assert_eq!(receipt.inserted_vertices, 0);
/// assert_eq!(receipt.strokes[0].moved, receipt.moved_vertices);
/// for note in &receipt.notes {
///     println!("{note}");
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Receipt {
    /// Volume at rest.
    pub volume_before: Option<f64>,
    /// Volume of the flat triangles after all strokes, before the lock.
    pub volume_before_lock: Option<f64>,
    /// Volume of the result.
    pub volume_after: Option<f64>,
    /// Estimated signed volume that the flat triangles lack before the lock.
    pub facet_error: Option<f64>,
    /// Longest displacement by the lock, model units, or `None` without a lock.
    pub lock_max_shift: Option<f64>,
    /// Largest ratio of a displacement by the lock to the shortest edge at the vertex, or `None` without
    /// a lock.
    pub lock_max_shift_per_edge: Option<f64>,
    /// Longest displacement from rest to the result, model units.
    pub max_displacement: f64,
    /// Vertices, inserted ones included, whose coordinates differ in any bit from rest, before the lock.
    pub moved_vertices: usize,
    /// Vertices that refinement inserted.
    pub inserted_vertices: usize,
    /// How often the result so far became the surface from which the next strokes started.
    pub rebases: usize,
    /// Sum over the rebases of the largest distance by which each moved the surface, model units.
    pub rebase_deviation: f64,
    /// Triangles of the result that cross others although the input triangles that contain them do not.
    pub new_crossings: usize,
    /// Pairs of triangles with overlapping boxes that were tested for crossings.
    pub pairs_tested: u64,
    /// The strokes, in order.
    pub strokes: Vec<StrokeReceipt>,
    /// Wall time of the stages.
    pub seconds: StageSeconds,
    /// Conditions that the user should know, in the order of the passes.
    pub notes: Vec<Note>,
}

/// Measures of one stroke.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StrokeReceipt {
    /// Wall time, refinement included.
    pub seconds: f64,
    /// Evaluations of the fields, including those for refinement.
    pub evaluations: u64,
    /// Vertices that this stroke moved. A vertex inserted after the stroke counts if it differs from
    /// its rest position.
    pub moved: usize,
    /// Vertices that refinement inserted for this stroke.
    pub inserted: usize,
    /// Jacobian determinants of the flow map at some of the moved vertices, or `None` if the stroke
    /// moved none or is a stamp.
    pub jacobian: Option<JacobianRange>,
    /// Fraction of the stroke's time at which it ended, because the surface would have crossed itself;
    /// `None` if the stroke is complete.
    pub stopped_at: Option<f64>,
    /// The closest sheets where the surface would have crossed itself.
    pub sheets: Option<Sheets>,
    /// Signed change of the volume by this stroke, relative to the volume at rest. `None` if that is
    /// zero or the mesh is open.
    pub volume_change: Option<f64>,
}

/// Wall time of the stages of a deformation, in seconds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StageSeconds {
    /// Advection of the vertices, and stamps.
    pub advect: f64,
    /// Refinement, including the advection of new points.
    pub refine: f64,
    /// The volume lock, including the search for crossings and the refinement they call for.
    pub lock: f64,
}

/// A condition that the user should know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Note {
    /// Refinement stopped at the limit on triangles.
    TriangleLimit {
        /// Index of the stroke, from 0.
        stroke: usize,
        /// The limit.
        max_triangles: usize,
    },
    /// The time step was halved because the flow map did not preserve volume.
    StepHalved {
        /// Index of the stroke, from 0.
        stroke: usize,
        /// Number of halvings.
        times: u32,
    },
    /// The flow map of a stroke does not preserve volume at some vertices, even with finer steps.
    Jacobian {
        /// Index of the stroke, from 0.
        stroke: usize,
        /// Jacobian determinants.
        range: JacobianRange,
    },
    /// A stroke ended early, because the surface would have crossed itself.
    Stopped {
        /// Index of the stroke, from 0.
        stroke: usize,
        /// Fraction of its time.
        at: f64,
        /// The closest sheets there.
        sheets: Option<Sheets>,
    },
    /// The lock was skipped, because it would make triangles cross.
    LockCrossings {
        /// Number of triangles.
        triangles: usize,
    },
    /// The facet error is a noticeable fraction of the volume.
    FacetError {
        /// Fraction of the volume: the larger of the estimated and the measured error.
        fraction: f64,
    },
    /// The lock moved vertices by a noticeable fraction of their edges.
    LockShift {
        /// Largest ratio of a vertex' displacement to the shortest edge at it.
        ratio: f64,
    },
    /// A stamp touched nothing on its path.
    StampMissed {
        /// Index of the stroke, from 0.
        stroke: usize,
    },
    /// A stamp went through a thin sheet, which is now folded onto itself.
    StampThrough {
        /// Index of the stroke, from 0.
        stroke: usize,
    },
    /// The lock was skipped: no vertex had moved, or the displacement cannot change the volume.
    LockSkipped,
    /// The lock was skipped: the mesh is open.
    LockNeedsClosed,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TriangleLimit { stroke, max_triangles } => {
                write!(f, "refinement of stroke {stroke} stopped at the limit of {max_triangles} triangles")
            }
            Self::StepHalved { stroke, times } => {
                let times = if *times == 1 { "once".to_owned() } else { format!("{times} times") };
                write!(f, "the time step of stroke {stroke} was halved {times} to preserve volume")
            }
            Self::Jacobian { stroke, range: JacobianRange { min, max } } => {
                write!(
                    f,
                    "stroke {stroke} scales volumes by {min:.3} to {max:.3}, and finer steps do not help: \
                     its velocity is discontinuous, or its profile compresses too much"
                )
            }
            Self::Stopped { stroke, at, sheets } => {
                write!(
                    f,
                    "stroke {stroke} ended at {:.0} % of its path, before the surface would cross itself",
                    100.0 * at
                )?;
                match sheets {
                    Some(Sheets { gap, at }) => write!(
                        f,
                        ": two sheets are {gap:.1e} apart at ({:.4}, {:.4}, {:.4}); press less deeply, \
                         or allow more triangles",
                        at.x, at.y, at.z
                    ),
                    None => f.write_str("; press less deeply, or allow more triangles"),
                }
            }
            Self::LockCrossings { triangles } => {
                write!(
                    f,
                    "the lock was skipped, because it would make {triangles} triangles cross; \
                     refine more or press less deeply"
                )
            }
            Self::FacetError { fraction } => {
                write!(f, "the facet error is {:.3} % of the volume; refine more", 100.0 * fraction)
            }
            Self::LockShift { ratio } => {
                write!(
                    f,
                    "the lock moved a vertex by {ratio:.2} of the shortest edge at it; refine more before locking"
                )
            }
            Self::StampMissed { stroke } => write!(f, "the stamp of stroke {stroke} touched nothing"),
            Self::StampThrough { stroke } => write!(
                f,
                "the stamp of stroke {stroke} went through the surface and folded it onto its far side; \
                 press less deeply"
            ),
            Self::LockSkipped => f.write_str("the lock was skipped: no displacement changes the volume"),
            Self::LockNeedsClosed => f.write_str("the lock was skipped: the mesh is open and has no volume"),
        }
    }
}
