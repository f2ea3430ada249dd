//! The strokes of a recipe for points that come in chunks.

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{Aabb, Cancelled, Monitor};

use crate::{
    recipe::{Mask, Recipe, RecipeError, RecipeProblem, Stroke},
    scene::{Meshes, Scene, SceneError, place},
};

/// Result of [`replay_points`].
#[derive(Debug, Clone, PartialEq)]
pub struct PointReplay {
    /// The deformed points, in the order of the input.
    pub points: Vec<DVec3>,
    /// Warnings, among them the parts of the recipe that do not apply to points.
    pub warnings: Vec<String>,
}

/// Advects `points`, in world coordinates, along the strokes of `recipe`.
///
/// The target's mesh is needed only if the mask has a weight for each vertex. If it is among the `meshes`, a rotating
/// half-space derives its time step from the bounds of the mesh, otherwise from those of the points.
///
/// Points have no surface, so stamps are refused. They enclose no volume, so the lock is skipped: points agree with the
/// vertices of a mesh before its lock.
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

/// The strokes of a recipe, ready to carry points. Where they carry a point depends on that point alone, so that points may come
/// in chunks of any size.
#[derive(Debug, Clone)]
pub struct PointFlow {
    strokes: Vec<field::Stroke>,
    /// What of the recipe does not apply to points, and what else the user should know.
    pub warnings: Vec<String>,
}

impl PointFlow {
    /// Makes the strokes of `recipe` for points in `bounds`, in world coordinates, by which strokes measure their time steps where
    /// [they need to](Self::needs_bounds). The bounds of the target's mesh count instead where it is among the `meshes`.
    ///
    /// # Errors
    /// [`SceneError`], with the key of the recipe at fault. A stamp is refused, because it needs a surface.
    pub fn new(recipe: &Recipe, meshes: &Meshes, bounds: Aabb, monitor: &dyn Monitor) -> Result<Self, SceneError> {
        if let Some(index) = recipe.strokes.iter().position(|stroke| matches!(stroke, Stroke::Stamp(_))) {
            return Err(stamp_on_points(index).into());
        }
        let (strokes, mut warnings) = Scene::strokes(recipe, meshes, bounds, monitor)?;
        if recipe.volume.lock {
            warnings.push("points enclose no volume: the volume lock was left out".to_owned());
        }
        Ok(Self { strokes, warnings })
    }

    /// The file of the target, whose points alone are deformed, if `recipe` asks for nothing that they cannot give.
    ///
    /// # Errors
    /// [`RecipeError`], naming the key that needs a mesh.
    pub fn streamed_file(recipe: &Recipe) -> Result<&str, RecipeError> {
        let refused = |key: &str, text: &str| RecipeError::new(key, RecipeProblem::Other(text.to_owned()));
        let needs_mesh = [
            ("mask.vertices", recipe.mask.vertices.is_some()),
            ("promise.volume", recipe.promise.volume.is_some()),
            ("promise.no_new_self_intersections", recipe.promise.no_new_self_intersections),
            ("output.preview", recipe.output.preview.is_some()),
            ("output.frames", recipe.output.frames.is_some()),
        ];
        if let Some((key, _)) = needs_mesh.into_iter().find(|(_, is_asked)| *is_asked) {
            return Err(refused(
                key,
                "needs a whole mesh, and a stream knows only points; remove it, or do not stream",
            ));
        }
        let file = recipe.target.mesh.as_deref();
        file.ok_or_else(|| refused("target", "is no file; a stream needs target.mesh, .ply or .npy"))
    }

    /// Whether the strokes of `recipe` depend on the bounds of what they deform: regions do, and masks on exact flows.
    pub fn needs_bounds(recipe: &Recipe) -> bool {
        recipe.mask != Mask::default() || recipe.strokes.iter().any(|stroke| matches!(stroke, Stroke::Region(_)))
    }

    /// `points` of the target's file where the recipe places them in the world.
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

fn stamp_on_points(index: usize) -> RecipeError {
    let text = "is a stamp, which presses into a surface, and points have none; give a mesh, or remove this stroke";
    RecipeError::new(&format!("stroke.{index}"), RecipeProblem::Other(text.to_owned()))
}
