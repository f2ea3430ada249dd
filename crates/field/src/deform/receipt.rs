//! The receipt: what a deformation did, and what it could not do.

use std::fmt;

use crate::flow::JacobianRange;

/// What a deformation did. Volumes are in cubic model units and stand only where the mesh is closed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Receipt {
    /// Volume at rest.
    pub volume_before: Option<f64>,
    /// Volume of the flat triangles after all strokes, before the lock: what the bare method gives.
    pub volume_before_lock: Option<f64>,
    /// Volume in the end.
    pub volume_after: Option<f64>,
    /// Estimated signed volume that the flat triangles lack before the lock.
    pub facet_error: Option<f64>,
    /// Longest displacement by the lock, model units; none where there was no lock.
    pub lock_max_shift: Option<f64>,
    /// Longest displacement from rest to the end, model units.
    pub max_displacement: f64,
    /// Vertices, inserted ones included, whose coordinates differ in any bit from rest, before the lock.
    pub moved_vertices: usize,
    /// Vertices that refinement inserted.
    pub inserted_vertices: usize,
    /// The strokes, in order.
    pub strokes: Vec<StrokeReceipt>,
    /// Wall time of the stages.
    pub seconds: StageSeconds,
    /// What the user should know beside the figures.
    pub notes: Vec<Note>,
}

/// What one stroke did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StrokeReceipt {
    /// Wall time, refinement included.
    pub seconds: f64,
    /// Evaluations of the fields, those for refinement included.
    pub evaluations: u64,
    /// Vertices that this stroke moved; of those inserted after it, the ones that any stroke so far moved.
    pub moved: usize,
    /// Vertices that refinement inserted for this stroke.
    pub inserted: usize,
    /// Jacobian determinants of its flow map at some of the vertices that it moved; none where it moved none, or is no flow.
    pub jacobian: Option<JacobianRange>,
    /// Signed change of the volume by this stroke, as a share of the volume at rest; none where that is zero.
    pub volume_change: Option<f64>,
}

/// Wall time of the stages of a deformation, in seconds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StageSeconds {
    /// Carrying the vertices.
    pub advect: f64,
    /// Refinement, its own carrying of points included.
    pub refine: f64,
    /// The volume lock, the search for what it makes cross included, and refinement for that.
    pub lock: f64,
}

/// Something the user should know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Note {
    /// Refinement stopped at the limit on triangles.
    TriangleLimit {
        /// Index of the stroke, from 0.
        stroke: usize,
        /// The limit.
        max_triangles: usize,
    },
    /// The time step was halved because the flow map would not have kept volumes.
    StepHalved {
        /// Index of the stroke, from 0.
        stroke: usize,
        /// How often.
        times: u32,
    },
    /// The flow map of a stroke does not keep volumes at some vertices, and finer steps did not mend it.
    Jacobian {
        /// Index of the stroke, from 0.
        stroke: usize,
        /// Its determinants.
        range: JacobianRange,
    },
    /// The lock made triangles cross, and more refinement did not mend it.
    LockCrossings {
        /// How many.
        triangles: usize,
    },
    /// The flat triangles alone are off by a noticeable share of the volume.
    FacetError {
        /// Share of the volume, the larger of estimate and measure.
        share: f64,
    },
    /// The lock had to move vertices by a noticeable part of the edges at them.
    LockShift {
        /// Largest ratio of a vertex' displacement to the shortest edge at it.
        ratio: f64,
    },
    /// A stamp went its way and met nothing.
    StampMissed {
        /// Index of the stroke, from 0.
        stroke: usize,
    },
    /// A stamp touched the surface from both sides: it went through a sheet, which then lies on itself.
    StampThrough {
        /// Index of the stroke, from 0.
        stroke: usize,
    },
    /// The lock was asked for and found nothing to hold: nothing had moved, or the displacement does not change the volume.
    LockSkipped,
    /// The lock was asked for, and the mesh is open.
    LockNeedsClosed,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TriangleLimit { stroke, max_triangles } => {
                write!(f, "refinement of stroke {stroke} stopped at the limit of {max_triangles} triangles")
            }
            Self::StepHalved { stroke, times } => {
                write!(f, "the time step of stroke {stroke} was halved {times} times to keep volumes")
            }
            Self::Jacobian { stroke, range: JacobianRange { min, max } } => {
                write!(
                    f,
                    "stroke {stroke} scales volumes by {min:.3} to {max:.3} where finer steps do not mend it: \
                     its velocity jumps there, or a profile squeezes too much"
                )
            }
            Self::LockCrossings { triangles } => {
                write!(f, "the lock made {triangles} triangles cross; refine more before locking")
            }
            Self::FacetError { share } => {
                write!(f, "the flat triangles alone are off by {:.3} % of the volume; refine more", 100.0 * share)
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
                "the stamp of stroke {stroke} went through the surface to its far side, which then lies on itself; press less deep"
            ),
            Self::LockSkipped => f.write_str("the lock was skipped: nothing moved that the volume depends on"),
            Self::LockNeedsClosed => f.write_str("the lock was skipped: the mesh is open and has no volume"),
        }
    }
}
