//! Problems with values that are valid by themselves, but do not fit the target or the field.

use isochore_field as field;
use isochore_mesh::ShapeError;

/// Problems when building the target and the strokes of a valid recipe.
#[derive(Debug, thiserror::Error)]
pub enum SceneProblem {
    /// A promise about the volume of a target without one, with the reason.
    #[error("the target encloses no volume ({0}); close it, or remove this promise")]
    NoVolume(String),
    /// A twist or a bend that shears the target too strongly.
    #[error(
        "is {found}, which winds the target up more finely than refinement can follow; give {most:.0} or less, or set \
         refine.enabled = false"
    )]
    Shear {
        /// Degrees per unit of the stroke.
        found: f64,
        /// The maximum.
        most: f64,
    },
    /// The mask cannot be built.
    #[error(transparent)]
    Mask(#[from] MaskProblem),
    /// The inner part of a region cannot be built.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A region cannot be built.
    #[error(transparent)]
    Region(#[from] field::ToolError),
    /// A jointed tool cannot be built.
    #[error(transparent)]
    JointedTool(#[from] field::JointedToolError),
    /// A stamp on points.
    #[error("is a stamp, which presses into a surface, and points have none; pass a mesh, or remove this stroke")]
    StampOnPoints,
}

/// Problems when building a valid mask.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MaskProblem {
    /// The field of the mask cannot be built.
    #[error(transparent)]
    Mask(#[from] field::MaskError),
    /// A file is still named by its path.
    #[error("the file `{0}` was not loaded; replace its name by its numbers")]
    WeightsNotLoaded(String),
}

/// Problems when building the shape of a valid tool.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ShapeProblem {
    /// The shape is impossible.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// Only the program that logged the tool can build it.
    #[error(
        "is a shape of the program that logged it, which a recipe does not contain; replay it in a session of that \
         program, which supplies the tool"
    )]
    Host,
}
