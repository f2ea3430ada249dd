//! The objects that a recipe's plain data describe.

mod error;
mod key;
pub(crate) mod mask;
mod meshes;
mod pose;
mod problem;
mod profile;
mod rates;
mod reach;
mod refinement;
mod region;
mod strip;
mod stroke;
mod target;
mod tool;

use std::{collections::BTreeMap, sync::Arc};

use isochore_field as field;
use isochore_mesh::{Aabb, ClosedMesh, Monitor, TriMesh};
use web_time::Instant;

pub use error::{BuildToolError, SceneError};
pub use meshes::Meshes;
pub use problem::{MaskProblem, SceneProblem, ShapeProblem};
pub use tool::build_tool;

pub(crate) use target::place;

use crate::recipe::{Mask, Recipe, RecipeError};
use stroke::StrokeBuilder;
use tool::ToolBuilder;

/// The objects of a recipe: a target and strokes, ready for [`field::deform`].
#[derive(Debug, Clone)]
pub struct Scene {
    /// The target in world coordinates.
    pub target: Arc<TriMesh>,
    /// The strokes, in order.
    pub strokes: Vec<field::Stroke>,
    /// Options for deforming the target.
    pub options: field::DeformOptions,
    /// Warnings about how the recipe was interpreted.
    pub warnings: Vec<String>,
    /// Wall-clock time for sampling the distances of tool meshes, seconds.
    pub distance_seconds: f64,
}

impl Scene {
    /// Builds the objects of `recipe`. `meshes` holds its mesh files, [by
    /// name](Recipe::mesh_names).
    ///
    /// # Errors
    /// [`SceneError`], with the key of the recipe at fault.
    ///
    /// ```
    /// use isochore_mesh::NoProgress;
    /// use isochore_sculpt::{Meshes, Recipe, Scene, recipe::Format};
    ///
    /// let text = "recipe = 1\ntarget = { shape = { kind = 'icosphere', radius = 1, subdivisions = 2 } }";
    /// let recipe = Recipe::parse(text, Format::Toml, &[])?;
    /// let scene = Scene::build(&recipe, &Meshes::new(), &NoProgress)?;
    /// assert_eq!(scene.target.triangles.len(), 20 * 4 * 4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn build(recipe: &Recipe, meshes: &Meshes, monitor: &dyn Monitor) -> Result<Self, SceneError> {
        recipe.validate()?;
        let target = target::build(&recipe.target, meshes)?;
        rates::check(recipe, target.bounds())?;
        check_volume_promise(recipe, &target)?;
        let start = Instant::now();
        let (mut strokes, warnings) = build_strokes(recipe, meshes, target.bounds(), monitor)?;
        if recipe.mask != Mask::default() {
            strokes = mask::masked(strokes, recipe, Some(&target), target.bounds())?;
        }
        Ok(Self {
            target,
            strokes,
            options: field::DeformOptions { refine: refinement::options(&recipe.refine), lock: recipe.volume.lock },
            warnings,
            distance_seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// Builds only the strokes of `recipe`, for points in `bounds` that do not form a mesh, and
    /// returns them with warnings.
    ///
    /// `meshes` needs the target only if the mask has a weight for each vertex.
    ///
    /// # Errors
    /// [`SceneError`], with the key of the recipe at fault.
    pub fn strokes(
        recipe: &Recipe,
        meshes: &Meshes,
        bounds: Aabb,
        monitor: &dyn Monitor,
    ) -> Result<(Vec<field::Stroke>, Vec<String>), SceneError> {
        recipe.validate()?;
        let target = target::build(&recipe.target, meshes);
        // With the bounds of the mesh, points take exactly the steps of its vertices.
        let bounds = target.as_ref().map_or(bounds, |target| target.bounds());
        let (mut strokes, warnings) = build_strokes(recipe, meshes, bounds, monitor)?;
        if recipe.mask != Mask::default() {
            let target = if recipe.mask.vertices.is_some() { Some(target?) } else { None };
            strokes = mask::masked(strokes, recipe, target.as_deref(), bounds)?;
        }
        Ok((strokes, warnings))
    }
}

fn build_strokes(
    recipe: &Recipe,
    meshes: &Meshes,
    bounds: Aabb,
    monitor: &dyn Monitor,
) -> Result<(Vec<field::Stroke>, Vec<String>), SceneError> {
    if let Some(name) = recipe.curve_names().first() {
        return Err(SceneError::MissingCurve { name: (*name).to_owned() });
    }
    let mut tool_builder = ToolBuilder::new(meshes, monitor);
    let mut tools = BTreeMap::new();
    for name in recipe.moving_tools() {
        let reach = reach::of_tool(recipe, name, meshes)?;
        tools.insert(name, Arc::new(tool_builder.build(name, &recipe.tools[name], reach)?));
    }
    let inner_tools = region::inner_tools(recipe, &mut tool_builder)?;
    let builder = StrokeBuilder { tools: &tools, inner_tools: &inner_tools, step: recipe.integrate.step, bounds };
    let strokes = recipe.strokes.iter().enumerate();
    let strokes = strokes.map(|(index, stroke)| builder.build(index, stroke)).collect::<Result<_, _>>()?;
    Ok((strokes, notes(meshes).chain(tool_builder.warnings).collect()))
}

/// Parts of the meshes that the readers left out or replaced.
fn notes(meshes: &Meshes) -> impl Iterator<Item = String> {
    meshes.iter().flat_map(|(name, mesh)| mesh.assets.notes.iter().map(move |note| format!("{name}: {note}")))
}

/// Refuses a promise about the volume of a target without one.
fn check_volume_promise(recipe: &Recipe, target: &TriMesh) -> Result<(), RecipeError<SceneProblem>> {
    if recipe.promise.volume.is_none() {
        return Ok(());
    }
    let defect = match ClosedMesh::new(target) {
        Ok(closed) if closed.volume() != 0.0 => return Ok(()),
        Ok(_) => "it is zero".to_owned(),
        Err(defect) => defect.to_string(),
    };
    Err(RecipeError::new("promise.volume", SceneProblem::NoVolume(defect)))
}
