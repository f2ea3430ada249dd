//! Tools built from their descriptions.

use std::sync::Arc;

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{
    self as mesh, Aabb, Distance, DistanceField, DistanceFieldError, DistanceFieldOptions, Monitor, Padding, TriMesh,
};

use super::{
    error::BuildToolError,
    meshes::{Meshes, transformed},
    profile::profile,
};
use crate::recipe::{MeshTool, RecipeError, RecipeProblem, Tool, ToolShape};

/// Grid cells across the support, at least. With fewer, the kinks of the interpolant show in the field.
const CELLS_PER_SUPPORT: f64 = 6.0;

/// Builds one tool, outside any recipe, and returns it with warnings about its description.
///
/// The shape of a mesh tool is looked up in `meshes`, and its distance is sampled on a grid, which takes from milliseconds
/// to seconds.
///
/// # Errors
/// [`BuildToolError`]. Its keys are those of a recipe in which the tool is called `name`.
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

    /// `reach`: distance from the shape up to which its distance is sampled, at least the support; model units.
    pub(super) fn build(&mut self, name: &str, tool: &Tool, reach: f64) -> Result<field::Tool, BuildToolError> {
        let distance: Arc<dyn Distance> = match &tool.shape {
            ToolShape::Mesh(shape) => Arc::new(self.distance_field(name, shape, tool.support, reach)?),
            shape => {
                analytic_distance(shape).map_err(|problem| RecipeError::new(&format!("tools.{name}.shape"), problem))?
            }
        };
        field::Tool::new(distance, tool.support, profile(tool.profile))
            .and_then(|built| built.with_free_form(tool.free_form))
            .map_err(|source| BuildToolError::Tool { name: name.to_owned(), source })
    }

    fn distance_field(
        &mut self,
        name: &str,
        shape: &MeshTool,
        support: f64,
        reach: f64,
    ) -> Result<DistanceField, BuildToolError> {
        let mesh = tool_mesh(self.meshes, shape)?;
        let least = least_resolution(&mesh, support);
        if f64::from(shape.resolution) < least {
            let resolution = shape.resolution;
            self.warnings.push(format!(
                "tools.{name}.shape.resolution: raised from {resolution} to {least}, so that six cells fit into the support"
            ));
        }
        // A cast to an integer saturates; the memory limit of the grid then refuses it.
        let resolution = least.max(shape.resolution.into()) as usize;
        let options = DistanceFieldOptions { resolution, padding: Padding::Reach(reach), ..Default::default() };
        let field = DistanceField::new(&mesh, &options, self.monitor).map_err(|error| match error {
            DistanceFieldError::Cancelled(cancelled) => BuildToolError::Cancelled(cancelled),
            source => BuildToolError::DistanceField { name: name.to_owned(), source },
        })?;
        if !field.is_closed() {
            self.warnings.push(format!(
                "tools.{name}.shape.mesh: the mesh is open; its inside is taken to be where its winding number is above one half"
            ));
        }
        Ok(field)
    }
}

/// Bounds of a tool's shape in tool coordinates.
pub(super) fn shape_bounds(tool: &Tool, meshes: &Meshes) -> Result<Aabb, BuildToolError> {
    Ok(match &tool.shape {
        ToolShape::Mesh(shape) => tool_mesh(meshes, shape)?.bounds(),
        shape => analytic_distance(shape).map_err(|problem| RecipeError::new("tools", problem))?.bounds(),
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

/// Reason why a recipe alone cannot build the tool of a host.
const HOST_SHAPE: &str = "is a shape of the program that logged it, which a recipe does not contain; replay it in a session of \
                          that program, which supplies the tool";

/// Closed-form distance of every shape except those of meshes and hosts.
fn analytic_distance(shape: &ToolShape) -> Result<Arc<dyn Distance>, RecipeProblem> {
    let vector = DVec3::from_array;
    let distance: Result<Arc<dyn Distance>, mesh::ShapeError> = match shape {
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
        ToolShape::Mesh(_) => return Err(RecipeProblem::Other("a mesh has no distance in closed form".to_owned())),
        ToolShape::Host(_) => return Err(RecipeProblem::Other(HOST_SHAPE.to_owned())),
    };
    distance.map_err(|error| RecipeProblem::Other(error.to_string()))
}
