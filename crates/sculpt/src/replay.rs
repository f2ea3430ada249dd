//! Carrying out a recipe on loaded meshes or on bare points.

use std::{collections::BTreeMap, sync::Arc};

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{Aabb, Cancelled, DistanceFieldError, Monitor, TriMesh};

use crate::{
    point_flow::PointFlow,
    recipe::{Recipe, RecipeError},
    scene::Scene,
};

/// Loaded meshes by the name that the recipe gives them, shared with whoever has loaded them.
pub type Meshes = BTreeMap<String, Arc<TriMesh>>;

/// What became of the target.
#[derive(Debug, Clone)]
pub struct Replay {
    /// The target before, and everything else that the recipe describes.
    pub scene: Scene,
    /// The deformed mesh and the account of how it came about.
    pub deformed: field::Deformed,
}

/// What became of points that are no mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct PointReplay {
    /// The points, in the order in which they came.
    pub points: Vec<DVec3>,
    /// What of the recipe does not apply to points.
    pub warnings: Vec<String>,
}

/// Deforms the target of `recipe`, whose mesh files are in `meshes` by [their names](Recipe::mesh_names), and whose curve files
/// have been [put in](Recipe::inline_curve).
///
/// # Errors
/// [`ReplayError`], naming the key of the recipe that cannot be followed.
pub fn replay(recipe: &Recipe, meshes: &Meshes, monitor: &dyn Monitor) -> Result<Replay, ReplayError> {
    let scene = Scene::build(recipe, meshes, monitor)?;
    let deformed = field::deform(&scene.target, &scene.strokes, &scene.options, monitor)?;
    Ok(Replay { scene, deformed })
}

/// Carries `points`, in world coordinates, along the strokes of `recipe`. Its target is looked at for its mask, and where it is
/// there, for the bounds by which a half-space that turns measures its time step; else those of the points do.
///
/// A point set has no surface: a stamp is refused. It has no volume: the lock is left out, so that points agree with the vertices of a mesh before its lock.
///
/// # Errors
/// [`ReplayError`], naming the key of the recipe that cannot be followed.
pub fn replay_points(
    recipe: &Recipe,
    meshes: &Meshes,
    points: &[DVec3],
    monitor: &dyn Monitor,
) -> Result<PointReplay, ReplayError> {
    let flow = PointFlow::new(recipe, meshes, Aabb::of(points.iter().copied()), monitor)?;
    let points = flow.advect(points, monitor)?;
    Ok(PointReplay { points, warnings: flow.warnings })
}

/// Why a recipe could not be carried out.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The recipe is wrong in itself or does not go with its target.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// A mesh that the recipe names was not given.
    #[error("the mesh `{name}` was not loaded")]
    MissingMesh {
        /// Its name in the recipe.
        name: String,
    },
    /// A curve that the recipe names was not [put in](Recipe::inline_curve).
    #[error("the curve `{name}` was not loaded")]
    MissingCurve {
        /// Its name in the recipe.
        name: String,
    },
    /// The distance to a tool's mesh cannot be sampled.
    #[error("tools.{name}.shape: {source}")]
    DistanceField {
        /// Name of the tool.
        name: String,
        /// Why not.
        source: DistanceFieldError,
    },
    /// A tool cannot be made.
    #[error("tools.{name}: {source}")]
    Tool {
        /// Its name in the recipe.
        name: String,
        /// Why not.
        source: field::ToolError,
    },
    /// A stroke cannot be made.
    #[error("stroke.{index}: {source}")]
    Stroke {
        /// Its number, from zero.
        index: usize,
        /// Why not.
        source: field::StrokeError,
    },
    /// A stamp cannot be pressed into the target.
    #[error("stroke.{index}: {source}")]
    Stamp {
        /// Number of the stroke, from zero.
        index: usize,
        /// Why not.
        source: field::StampError,
    },
    /// The target cannot be deformed.
    #[error("target: {0}")]
    Deform(#[source] field::DeformError),
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ReplayError {
    /// Dotted path of the recipe's key that could not be followed, where it is one.
    pub fn key(&self) -> Option<String> {
        match self {
            Self::Recipe(error) => Some(error.key.clone()),
            Self::DistanceField { name, .. } => Some(format!("tools.{name}.shape")),
            Self::Tool { name, .. } => Some(format!("tools.{name}")),
            Self::Stroke { index, .. } | Self::Stamp { index, .. } => Some(format!("stroke.{index}")),
            Self::Deform(_) => Some("target".to_owned()),
            Self::MissingMesh { .. } | Self::MissingCurve { .. } | Self::Cancelled(_) => None,
        }
    }
}

impl From<field::DeformError> for ReplayError {
    fn from(error: field::DeformError) -> Self {
        match error {
            field::DeformError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            field::DeformError::Stamp { stroke, source } => Self::Stamp { index: stroke, source },
            error => Self::Deform(error),
        }
    }
}

impl Replay {
    /// The mesh part of the way through the strokes, with the triangles of the finished one.
    ///
    /// Of `count` frames, at least two, the one with `index` 0 is at rest and the last is the finished mesh. Each stroke takes as
    /// many frames as any other, and the volume lock, where the recipe asks for it, acts in each.
    ///
    /// # Errors
    /// [`ReplayError::Cancelled`] and [`ReplayError::Deform`].
    pub fn frame(&self, index: u32, count: u32, monitor: &dyn Monitor) -> Result<TriMesh, ReplayError> {
        if index >= count.saturating_sub(1) {
            // Done again, the lock would aim at the volume of the split mesh at rest, which rounds differently.
            return Ok(self.deformed.mesh.clone());
        }
        let strokes = &self.deformed.strokes;
        let time = strokes.len() as f64 * (f64::from(index) / f64::from(count - 1));
        let whole = (time as usize).min(strokes.len());
        let mut so_far = strokes[..whole].to_vec();
        if let Some(stroke) = strokes.get(whole)
            && time > whole as f64
        {
            so_far.push(stroke.truncated(time - whole as f64));
        }
        let options = field::DeformOptions { refine: None, lock: self.scene.options.lock };
        Ok(field::deform(&self.deformed.rest, &so_far, &options, monitor)?.mesh)
    }
}
