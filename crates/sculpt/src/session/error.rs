//! What can go wrong.

use isochore_field::StrokeError;
use isochore_mesh::{BvhError, EditMeshError, MeshError};

use crate::recipe::RecipeError;

/// Why a session cannot be opened on a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OpenError {
    /// An index is out of range or a coordinate is not finite.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The triangles are no oriented surface.
    #[error("the mesh cannot be edited: {0}")]
    Topology(#[from] EditMeshError),
    /// The triangles cannot be searched.
    #[error(transparent)]
    Search(#[from] BvhError),
    /// Attributes do not go with the triangles or vertices that they should belong to.
    #[error("the mesh has {found} {attribute} for {expected}")]
    AttributeCount {
        /// Which attribute.
        attribute: &'static str,
        /// Entries it has.
        found: usize,
        /// Entries it should have.
        expected: usize,
    },
    /// The options cannot be used.
    #[error(transparent)]
    Options(#[from] RecipeError),
}

/// Why a session refuses a call. It is then as it was before, but for one case: a move that ends in an [`Overflow`](Self::Overflow)
/// leaves edges split that it found too long, which moves nothing, and which the receipt of the stroke counts.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SessionError {
    /// There is a stroke that has not ended.
    #[error("a stroke is under way; end or cancel it first")]
    StrokeUnderWay,
    /// There is no stroke.
    #[error("no stroke is under way; begin one first")]
    NoStroke,
    /// A pose has no direction to turn about.
    #[error(transparent)]
    Pose(#[from] RecipeError),
    /// The tool's way cannot be, from the last pose to this one.
    #[error(transparent)]
    Stroke(#[from] StrokeError),
    /// Time is not finite, or runs backward.
    #[error("the time {time} is no number or lies before the last, {last}")]
    Time {
        /// The time given.
        time: f64,
        /// The one before.
        last: f64,
    },
    /// A length or share of the refinement is out of range.
    #[error("refinement: {0}")]
    Refinement(&'static str),
    /// No vertex ever had this number.
    #[error("{vertex} is none of the {count} vertices")]
    NoVertex {
        /// The number.
        vertex: u32,
        /// How many vertices there are, removed ones included.
        count: usize,
    },
    /// A coordinate would leave the range of numbers.
    #[error("vertex {vertex} would be carried out of the range of numbers")]
    Overflow {
        /// The vertex.
        vertex: u32,
    },
}
