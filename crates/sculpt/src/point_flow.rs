//! Deforming points that do not form a mesh.

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{Aabb, Cancelled, Monitor};

use crate::{
    recipe::{Mask, Recipe, RecipeError, Stroke},
    scene::{Meshes, Scene, SceneError, SceneProblem, place},
};

/// Result of [`replay_points`].
#[derive(Debug, Clone, PartialEq)]
pub struct PointReplay {
    /// The deformed points, in the order of the input.
    pub points: Vec<DVec3>,
    /// Warnings, among them the parts of the recipe that do not apply to points.
    pub warnings: Vec<String>,
}

/// Problems of [`PointFlow::streamed_file`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StreamProblem {
    /// A key that applies only to meshes.
    #[error("needs a mesh, but a stream consists of points; remove it, or do not stream")]
    NeedsMesh,
    /// A target that is not a file.
    #[error("is not a file; set target.mesh to a .ply or .npy file")]
    NoFile,
}

/// Advects `points`, in world coordinates, along the strokes of `recipe`.
///
/// The target's mesh is needed only if the mask has a weight for each vertex. If it is among the
/// `meshes`, a rotating half-space derives its time step from the bounds of the mesh, otherwise
/// from those of the points.
///
/// Points have no surface, so stamps are refused. They enclose no volume, so the lock is skipped:
/// points agree with the vertices of a mesh before its lock.
///
/// # Errors
/// [`SceneError`], with the key of the recipe at fault.
pub fn replay_points(
    recipe: &Recipe,
    meshes: &Meshes,
    points: &[DVec3],
    monitor: &dyn Monitor,
) -> Result<PointReplay, SceneError> {
    let flow = PointFlow::new(recipe, meshes, Aabb::of(points.iter().copied()), monitor)?;
    let points = flow.advect(points, monitor).map_err(SceneError::Cancelled)?;
    Ok(PointReplay { points, warnings: flow.warnings })
}

/// The strokes of a recipe, ready to advect points.
///
/// The image of a point depends only on that point, so points may arrive in chunks of any size.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::{Aabb, NoProgress};
/// use isochore_sculpt::{Meshes, PointFlow, Recipe, recipe::Format};
///
/// let text = r#"
///     recipe = 1
///     target = { mesh = "points.ply" }
///     [[stroke]]
///     kind = "twist"
///     origin = [0, 0, 0]
///     axis = [0, 0, 1]
///     degrees_per_unit = 90.0
/// "#;
/// let recipe = Recipe::parse(text, Format::Toml, &[])?;
/// let flow = PointFlow::new(&recipe, &Meshes::new(), Aabb::EMPTY, &NoProgress)?;
/// let images = flow.advect(&[DVec3::new(1.0, 0.0, 1.0)], &NoProgress)?;
/// assert!(images[0].distance(DVec3::new(0.0, 1.0, 1.0)) < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PointFlow {
    strokes: Vec<field::Stroke>,
    /// Warnings, among them the parts of the recipe that do not apply to points.
    pub warnings: Vec<String>,
}

impl PointFlow {
    /// Builds the strokes of `recipe` for points in `bounds`, in world coordinates.
    ///
    /// [Some strokes](Self::needs_bounds) derive their time steps from the bounds. If the target's
    /// mesh is among the `meshes`, its bounds are used instead.
    ///
    /// # Errors
    /// [`SceneError`], with the key of the recipe at fault. A stamp is refused, because it needs a
    /// surface.
    pub fn new(recipe: &Recipe, meshes: &Meshes, bounds: Aabb, monitor: &dyn Monitor) -> Result<Self, SceneError> {
        if let Some(index) = recipe.strokes.iter().position(|stroke| matches!(stroke, Stroke::Stamp(_))) {
            let key = format!("stroke.{index}");
            return Err(RecipeError::<SceneProblem>::new(&key, SceneProblem::StampOnPoints).into());
        }
        let (strokes, mut warnings) = Scene::strokes(recipe, meshes, bounds, monitor)?;
        if recipe.volume.lock {
            warnings.push("the lock was skipped: points enclose no volume".to_owned());
        }
        Ok(Self { strokes, warnings })
    }

    /// The file of the target, whose points can be streamed.
    ///
    /// # Errors
    /// [`RecipeError`], with the key that needs a mesh, or with the target if it is not a file.
    pub fn streamed_file(recipe: &Recipe) -> Result<&str, RecipeError<StreamProblem>> {
        let needs_mesh = [
            ("mask.vertices", recipe.mask.vertices.is_some()),
            ("promise.volume", recipe.promise.volume.is_some()),
            ("output.preview", recipe.output.preview.is_some()),
            ("output.frames", recipe.output.frames.is_some()),
        ];
        if let Some((key, _)) = needs_mesh.into_iter().find(|(_, is_asked)| *is_asked) {
            return Err(RecipeError::new(key, StreamProblem::NeedsMesh));
        }
        let file = recipe.target.mesh.as_deref();
        file.ok_or_else(|| RecipeError::new("target", StreamProblem::NoFile))
    }

    /// Whether the strokes of `recipe` depend on the bounds of the points. Regions do, and so do
    /// masks of exact flows.
    pub fn needs_bounds(recipe: &Recipe) -> bool {
        recipe.mask != Mask::default() || recipe.strokes.iter().any(|stroke| matches!(stroke, Stroke::Region(_)))
    }

    /// `points` of the target's file in world coordinates.
    pub fn place(recipe: &Recipe, points: Vec<DVec3>) -> Vec<DVec3> {
        place(&recipe.target, points)
    }

    /// The images of `points`, in world coordinates.
    ///
    /// # Errors
    /// [`Cancelled`], if the monitor asks to stop.
    pub fn advect(&self, points: &[DVec3], monitor: &dyn Monitor) -> Result<Vec<DVec3>, Cancelled> {
        field::advect_points(points, &self.strokes, monitor).map_err(|error| match error {
            field::AdvectError::Cancelled(cancelled) => cancelled,
            field::AdvectError::Stamp { .. } => unreachable!("`new` refuses stamps"),
        })
    }
}
