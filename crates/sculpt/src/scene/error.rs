//! Errors when building the objects of a recipe.

use isochore_field as field;
use isochore_mesh::{Cancelled, DistanceFieldError};

use super::problem::{SceneProblem, ShapeProblem};
use crate::recipe::{InvalidRecipe, RecipeError};

/// Errors when building one tool of a recipe.
#[derive(Debug, thiserror::Error)]
pub enum BuildToolError {
    /// A key of the tool has an invalid value.
    #[error(transparent)]
    Invalid(#[from] RecipeError<InvalidRecipe>),
    /// The shape of the tool cannot be built.
    #[error(transparent)]
    Shape(#[from] RecipeError<ShapeProblem>),
    /// The mesh that gives the tool its shape was not passed in.
    #[error("the mesh `{name}` was not loaded")]
    MissingMesh {
        /// Name of the mesh in the recipe.
        name: String,
    },
    /// The distance to the tool's mesh cannot be sampled.
    #[error("tools.{name}.shape: {source}")]
    DistanceField {
        /// Name of the tool.
        name: String,
        /// The cause.
        source: DistanceFieldError,
    },
    /// The field of the tool cannot be built.
    #[error("tools.{name}: {source}")]
    Tool {
        /// Name of the tool.
        name: String,
        /// The cause.
        source: field::ToolError,
    },
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Errors when building the target and the strokes of a recipe.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A key has an invalid value.
    #[error(transparent)]
    Invalid(#[from] RecipeError<InvalidRecipe>),
    /// A key has a value that does not fit the target or the field.
    #[error(transparent)]
    Unbuildable(#[from] RecipeError<SceneProblem>),
    /// The mesh of the target was not passed in.
    #[error("the mesh `{name}` was not loaded")]
    MissingMesh {
        /// Name of the mesh in the recipe.
        name: String,
    },
    /// A curve file is still named by its path; see [`inline_curve`](crate::Recipe::inline_curve).
    #[error("the curve `{name}` was not loaded")]
    MissingCurve {
        /// Name of the file in the recipe.
        name: String,
    },
    /// A tool cannot be built.
    #[error(transparent)]
    Tool(BuildToolError),
    /// A stroke cannot be built.
    #[error("stroke.{index}: {source}")]
    Stroke {
        /// Index of the stroke.
        index: usize,
        /// The cause.
        source: field::StrokeError,
    },
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(Cancelled),
}

impl From<BuildToolError> for SceneError {
    fn from(error: BuildToolError) -> Self {
        match error {
            // Hosts test for one variant to find out that they asked to stop.
            BuildToolError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Tool(error),
        }
    }
}

impl BuildToolError {
    /// Dotted path of the recipe's key at fault, if there is one.
    pub fn key(&self) -> Option<String> {
        match self {
            Self::Invalid(error) => Some(error.key.clone()),
            Self::Shape(error) => Some(error.key.clone()),
            Self::DistanceField { name, .. } => Some(format!("tools.{name}.shape")),
            Self::Tool { name, .. } => Some(format!("tools.{name}")),
            Self::MissingMesh { .. } | Self::Cancelled(_) => None,
        }
    }
}

impl SceneError {
    /// Dotted path of the recipe's key at fault, if there is one.
    pub fn key(&self) -> Option<String> {
        match self {
            Self::Invalid(error) => Some(error.key.clone()),
            Self::Unbuildable(error) => Some(error.key.clone()),
            Self::Tool(error) => error.key(),
            Self::Stroke { index, .. } => Some(format!("stroke.{index}")),
            Self::MissingMesh { .. } | Self::MissingCurve { .. } | Self::Cancelled(_) => None,
        }
    }
}
