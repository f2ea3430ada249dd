//! Errors of sessions.

use isochore_field::StrokeError;
use isochore_mesh::{BvhError, Cancelled, EditMeshError, MeshError};

use crate::{
    recipe::{InvalidRecipe, NumberProblem, RecipeError},
    scene::MaskProblem,
};

/// Errors of [`Session::open`](super::Session::open).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OpenError {
    /// An index is out of range or a coordinate is not finite.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The triangles do not form an oriented manifold surface.
    #[error("the mesh cannot be edited: {0}")]
    Topology(#[from] EditMeshError),
    /// The search tree cannot be built.
    #[error(transparent)]
    Search(#[from] BvhError),
    /// The number of attributes differs from the number of triangles or vertices.
    #[error("the mesh has {found} {attribute} instead of {expected}")]
    AttributeCount {
        /// Name of the attribute.
        attribute: &'static str,
        /// Number of entries.
        found: usize,
        /// Required number of entries.
        expected: usize,
    },
    /// An option is invalid.
    #[error(transparent)]
    Options(#[from] RecipeError<InvalidRecipe>),
    /// The mask does not fit the mesh.
    #[error(transparent)]
    Mask(#[from] RecipeError<MaskProblem>),
}

/// Errors of [`SessionTool::from_tool`](super::SessionTool::from_tool).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HostToolError {
    /// The bounds of the tool's distance are infinite or NaN.
    #[error(
        "tools.{name}.shape: the bounds of the distance are not finite; intersect the shape with a box around the \
         model, and return that box as the bounds"
    )]
    Unbounded {
        /// Name of the tool.
        name: String,
    },
}

/// Errors of a session. A failed call leaves the session unchanged, with one exception: a move that
/// fails with [`Overflow`](Self::Overflow) may have split long edges. This moves no vertex, and the
/// receipt of the stroke includes it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SessionError {
    /// A stroke has begun and not ended.
    #[error("a stroke is under way; end or cancel it first")]
    StrokeUnderWay,
    /// No stroke has begun.
    #[error("no stroke is under way; begin one first")]
    NoStroke,
    /// A key contains NaN or infinity, or its rotation has a zero axis.
    #[error(transparent)]
    Pose(#[from] RecipeError<NumberProblem>),
    /// The tool cannot move from the last pose to this one.
    #[error(transparent)]
    Stroke(#[from] StrokeError),
    /// The time is not finite, or it decreases.
    #[error("the time {time} is not finite or earlier than the previous time {last}")]
    Time {
        /// The rejected time.
        time: f64,
        /// The previous time; −∞ for the first pose.
        last: f64,
    },
    /// A length or fraction of the refinement is out of range.
    #[error("refinement: {0}")]
    Refinement(&'static str),
    /// A length or fraction of a remesh is out of range.
    #[error("remesh: {0}")]
    Remesh(&'static str),
    /// The monitor stopped the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The vertex does not exist.
    #[error("vertex {vertex} is out of range: the mesh has {count} vertices")]
    NoVertex {
        /// Number of the vertex.
        vertex: u32,
        /// Number of vertices, removed ones included.
        count: usize,
    },
    /// A coordinate would overflow.
    #[error("the move would overflow the coordinates of vertex {vertex}; scale the model down")]
    Overflow {
        /// Number of the vertex.
        vertex: u32,
    },
}
