//! Replaying a recipe on its target.

use isochore_field as field;
use isochore_mesh::{Cancelled, Monitor, TriMesh};

use crate::{
    recipe::Recipe,
    scene::{Meshes, Scene, SceneError},
};

/// Result of [`replay`].
#[derive(Debug, Clone)]
pub struct Replay {
    /// The target before the strokes, and the other objects of the recipe.
    pub scene: Scene,
    /// The deformed mesh and its receipt.
    pub deformed: field::Deformed,
}

/// Deforms the target of `recipe`.
///
/// `meshes` holds the mesh files of the recipe [by name](Recipe::mesh_names). Points must have
/// [replaced](Recipe::inline_curve) its curve files. A tool whose shape is
/// [`ToolShape::Host`](crate::recipe::ToolShape::Host) is rejected, because a recipe does not
/// contain it: replay such a log [in a session](crate::session::Session::replay), which accepts
/// tools of the host.
///
/// # Errors
/// [`ReplayError`], with the key of the recipe at fault.
///
/// ```
/// use isochore_mesh::{NoProgress, primitives};
/// use isochore_sculpt::{Meshes, Recipe, recipe::Format, replay};
///
/// let text = r#"
///     recipe = 1
///     target = { mesh = "ball" }
///     [[stroke]]
///     kind = "twist"
///     origin = [0, 0, 0]
///     axis = [0, 0, 1]
///     degrees_per_unit = 30.0
/// "#;
/// let recipe = Recipe::parse(text, Format::Toml, &[])?;
/// let ball = primitives::icosphere(1.0, 3);
/// let volume = ball.volume();
/// let meshes = Meshes::from([("ball".to_owned(), ball.into())]);
/// let replay = replay(&recipe, &meshes, &NoProgress)?;
/// assert!((replay.deformed.mesh.volume() / volume - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    /// An image of the animation: the mesh after a part of the strokes, with the triangles of the
    /// finished mesh.
    ///
    /// Of `count` images, at least two, the first (`index` 0) is the mesh at rest and the last is
    /// the finished mesh. Every stroke takes the same number of images. The volume lock, if the
    /// recipe enables it, acts in each image.
    ///
    /// # Errors
    /// [`ReplayError::Cancelled`] and [`ReplayError::Deform`].
    pub fn frame(&self, index: u32, count: u32, monitor: &dyn Monitor) -> Result<TriMesh, ReplayError> {
        if index >= count.saturating_sub(1) {
            // Computed again, the lock would restore the volume of the split mesh at rest, which
            // rounds differently.
            return Ok(self.deformed.mesh.clone());
        }
        let strokes = &self.deformed.strokes;
        let time = strokes.len() as f64 * (f64::from(index) / f64::from(count - 1));
        let whole = (time as usize).min(strokes.len());
        let mut partial = strokes[..whole].to_vec();
        if let Some(stroke) = strokes.get(whole)
            && time > whole as f64
        {
            partial.push(stroke.truncated(time - whole as f64));
        }
        let options = field::DeformOptions { refine: None, lock: self.scene.options.lock };
        Ok(field::deform(&self.deformed.rest, &partial, &options, monitor)?.mesh)
    }
}
