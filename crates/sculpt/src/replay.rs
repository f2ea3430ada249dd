//! Carrying out a recipe on loaded meshes or on bare points.

use isochore_field as field;
use isochore_mesh::{Cancelled, Monitor, TriMesh};

use crate::{
    recipe::Recipe,
    scene::{Meshes, Scene, SceneError},
};

/// What became of the target.
#[derive(Debug, Clone)]
pub struct Replay {
    /// The target before, and everything else that the recipe describes.
    pub scene: Scene,
    /// The deformed mesh and the account of how it came about.
    pub deformed: field::Deformed,
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

/// Errors of [`replay`].
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The objects of the recipe cannot be built.
    #[error(transparent)]
    Scene(SceneError),
    /// A stamp cannot be pressed into the target.
    #[error("stroke.{index}: {source}")]
    Stamp {
        /// Index of the stroke.
        index: usize,
        /// The cause.
        source: field::PressError,
    },
    /// The target cannot be deformed.
    #[error("target: {0}")]
    Deform(#[source] field::DeformError),
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ReplayError {
    /// Dotted path of the recipe's key at fault, if there is one.
    pub fn key(&self) -> Option<String> {
        match self {
            Self::Scene(error) => error.key(),
            Self::Stamp { index, .. } => Some(format!("stroke.{index}")),
            Self::Deform(_) => Some("target".to_owned()),
            Self::Cancelled(_) => None,
        }
    }
}

impl From<SceneError> for ReplayError {
    fn from(error: SceneError) -> Self {
        match error {
            // Hosts test for one variant to find out that they asked to stop.
            SceneError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Scene(error),
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
