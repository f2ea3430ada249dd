//! The strokes of a recipe for points that come in chunks.

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{Aabb, Monitor};

use crate::{
    recipe::{Mask, Recipe, RecipeError, RecipeProblem, Stroke},
    replay::{Meshes, ReplayError},
    scene::{Scene, place},
};

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
    /// [`ReplayError`], naming the key of the recipe that cannot be followed; a stamp, which needs a surface.
    pub fn new(recipe: &Recipe, meshes: &Meshes, bounds: Aabb, monitor: &dyn Monitor) -> Result<Self, ReplayError> {
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

    /// Where the strokes carry `points`, which are in world coordinates.
    ///
    /// # Errors
    /// [`ReplayError::Cancelled`] alone.
    pub fn advect(&self, points: &[DVec3], monitor: &dyn Monitor) -> Result<Vec<DVec3>, ReplayError> {
        field::advect_points(points, &self.strokes, monitor).map_err(|error| match error {
            field::AdvectError::Cancelled(cancelled) => ReplayError::Cancelled(cancelled),
            field::AdvectError::Stamp { stroke } => stamp_on_points(stroke).into(),
        })
    }
}

fn stamp_on_points(index: usize) -> RecipeError {
    let text = "is a stamp, which presses into a surface, and points have none; give a mesh, or remove this stroke";
    RecipeError::new(&format!("stroke.{index}"), RecipeProblem::Other(text.to_owned()))
}
