//! Tools built from their descriptions.

use std::sync::Arc;

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{
    self as mesh, Aabb, Distance, DistanceFieldError, DistanceFieldOptions, Monitor, Padding, ShapeError,
    SmoothDistance, TriMesh,
};

use super::{
    error::BuildToolError,
    meshes::{Meshes, transformed},
    problem::ShapeProblem,
    profile::profile,
};
use crate::recipe::{MeshTool, RecipeError, Tool, ToolShape};

/// Grid cells across the support, at least. Larger: more memory and time. Smaller: the smooth
/// distance has fewer levels, and the kinks of the exact distance show in the field.
const CELLS_PER_SUPPORT: f64 = 10.0;

/// Builds one tool, outside any recipe, and returns it with warnings about its description.
///
/// The shape of a mesh tool is looked up in `meshes`, and its distance is sampled on a grid, which
/// takes from milliseconds to seconds.
///
/// # Errors
/// [`BuildToolError`]. Its keys are those of a recipe in which the tool is called `name`.
///
/// ```
/// use isochore_mesh::NoProgress;
/// use isochore_sculpt::{Meshes, build_tool, recipe::{Sphere, Tool, ToolShape}};
///
/// let shape = ToolShape::Sphere(Sphere { radius: 0.4 });
/// let ball = Tool { shape, support: 0.3, profile: Default::default(), free_form: 0.0 };
/// let (tool, warnings) = build_tool("ball", &ball, &Meshes::new(), &NoProgress)?;
/// assert_eq!(tool.support(), 0.3);
/// assert!(warnings.is_empty());
/// # Ok::<(), isochore_sculpt::BuildToolError>(())
/// ```
pub fn build_tool(
    name: &str,
    description: &Tool,
    meshes: &Meshes,
    monitor: &dyn Monitor,
) -> Result<(field::Tool, Vec<String>), BuildToolError> {
    description.validate().map_err(|error| error.inside(name).inside("tools"))?;
    let mut builder = ToolBuilder::new(meshes, monitor);
    let tool = builder.build(name, description, description.support)?;
    Ok((tool, builder.warnings))
}

/// Builds valid tools and collects warnings about them.
pub(super) struct ToolBuilder<'a> {
    meshes: &'a Meshes,
    monitor: &'a dyn Monitor,
    pub(super) warnings: Vec<String>,
}

impl<'a> ToolBuilder<'a> {
    pub(super) fn new(meshes: &'a Meshes, monitor: &'a dyn Monitor) -> Self {
        Self { meshes, monitor, warnings: Vec::new() }
    }

    /// `reach`: distance from the shape up to which its distance is sampled, at least the support;
    /// model units.
    pub(super) fn build(&mut self, name: &str, tool: &Tool, reach: f64) -> Result<field::Tool, BuildToolError> {
        let distance = self.distance(name, tool, tool.support, reach)?;
        field::Tool::new(distance, tool.support, profile(tool.profile))
            .and_then(|built| built.with_free_form(tool.free_form))
            .map_err(|source| BuildToolError::Tool { name: name.to_owned(), source })
    }

    /// Signed distance of the shape of `tool`, for a field that ends `support` beyond it. It is
    /// sampled up to `reach`, at least the support; model units.
    ///
    /// This is the only place that decides how the distance to a mesh is sampled and smoothed.
    pub(super) fn distance(
        &mut self,
        name: &str,
        tool: &Tool,
        support: f64,
        reach: f64,
    ) -> Result<Arc<dyn Distance>, BuildToolError> {
        Ok(match shape_source(name, tool)? {
            ShapeSource::Mesh(shape) => Arc::new(self.smooth_distance(name, shape, support, reach)?),
            ShapeSource::ClosedForm(distance) => distance,
        })
    }

    fn smooth_distance(
        &mut self,
        name: &str,
        shape: &MeshTool,
        support: f64,
        reach: f64,
    ) -> Result<SmoothDistance, BuildToolError> {
        let mesh = tool_mesh(self.meshes, shape)?;
        let least = least_resolution(&mesh, support);
        if f64::from(shape.resolution) < least {
            let resolution = shape.resolution;
            self.warn(format!(
                "tools.{name}.shape.resolution: raised from {resolution} to {least}, so that ten cells fit into the support"
            ));
        }
        // A cast to an integer saturates; the memory limit of the grid then refuses it.
        let resolution = least.max(shape.resolution.into()) as usize;
        let options = DistanceFieldOptions { resolution, padding: Padding::Reach(reach), ..Default::default() };
        let distance = SmoothDistance::new(&mesh, support, &options, self.monitor).map_err(|error| match error {
            DistanceFieldError::Cancelled(cancelled) => BuildToolError::Cancelled(cancelled),
            source => BuildToolError::DistanceField { name: name.to_owned(), source },
        })?;
        if !distance.is_closed() {
            self.warn(format!(
                "tools.{name}.shape.mesh: the mesh is open; its inside is taken to be where its winding number is above one half"
            ));
        }
        Ok(distance)
    }

    /// Adds a warning, once even if a shape is built for several supports.
    fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }
}

/// Bounds of the shape of the tool `name`, in tool coordinates.
pub(super) fn shape_bounds(name: &str, tool: &Tool, meshes: &Meshes) -> Result<Aabb, BuildToolError> {
    Ok(match shape_source(name, tool)? {
        ShapeSource::Mesh(shape) => tool_mesh(meshes, shape)?.bounds(),
        ShapeSource::ClosedForm(distance) => distance.bounds(),
    })
}

/// The mesh of `shape` in tool coordinates.
fn tool_mesh(meshes: &Meshes, shape: &MeshTool) -> Result<TriMesh, BuildToolError> {
    let mesh = meshes.get(&shape.mesh).ok_or_else(|| BuildToolError::MissingMesh { name: shape.mesh.clone() })?;
    Ok(transformed(mesh, &shape.transform))
}

/// The fewest cells along the longest side of `mesh` that resolve this support; a whole number.
fn least_resolution(mesh: &TriMesh, support: f64) -> f64 {
    (CELLS_PER_SUPPORT * mesh.bounds().size().max_element() / support).ceil()
}

/// The two kinds of shapes.
enum ShapeSource<'a> {
    Mesh(&'a MeshTool),
    ClosedForm(Arc<dyn Distance>),
}

fn shape_source<'a>(name: &str, tool: &'a Tool) -> Result<ShapeSource<'a>, RecipeError<ShapeProblem>> {
    let vector = DVec3::from_array;
    let failed = |problem: ShapeProblem| RecipeError::new(&format!("tools.{name}.shape"), problem);
    let distance: Result<Arc<dyn Distance>, ShapeError> = match &tool.shape {
        ToolShape::Mesh(shape) => return Ok(ShapeSource::Mesh(shape)),
        ToolShape::Host(_) => return Err(failed(ShapeProblem::Host)),
        ToolShape::Sphere(shape) => mesh::Sphere::new(shape.radius).map(|distance| Arc::new(distance) as _),
        ToolShape::Capsule(shape) => {
            mesh::Capsule::new(shape.radius, shape.half_length).map(|distance| Arc::new(distance) as _)
        }
        ToolShape::Box(shape) => {
            mesh::RoundedBox::new(vector(shape.half_extents), shape.rounding).map(|distance| Arc::new(distance) as _)
        }
        ToolShape::Torus(shape) => mesh::Torus::new(shape.major, shape.minor).map(|distance| Arc::new(distance) as _),
        ToolShape::Ellipsoid(shape) => {
            mesh::Ellipsoid::new(vector(shape.radii)).map(|distance| Arc::new(distance) as _)
        }
    };
    let distance = distance.map_err(|error| failed(error.into()))?;
    Ok(ShapeSource::ClosedForm(distance))
}
