//! The distance up to which the shape of a moving tool must be sampled.

use super::{error::BuildToolError, meshes::Meshes, pose, tool::shape_bounds};
use crate::recipe::{Recipe, Stroke, ToolShape};

/// Distance from the shape of the tool `name` up to which the strokes evaluate it, model units: the
/// support at least, and farther for a bone.
///
/// Closed-form shapes have no limit, so only the support is returned for them.
pub(super) fn of_tool(recipe: &Recipe, name: &str, meshes: &Meshes) -> Result<f64, BuildToolError> {
    let tool = &recipe.tools[name];
    let mut reach = tool.support;
    if !matches!(tool.shape, ToolShape::Mesh(_)) {
        return Ok(reach);
    }
    for stroke in &recipe.strokes {
        if let Stroke::Pose(pose) = stroke
            && pose.bones.iter().any(|bone| bone.tool == name)
        {
            let extent = |name: &str| {
                let tool = &recipe.tools[name];
                Ok::<_, BuildToolError>((shape_bounds(name, tool, meshes)?, tool.support))
            };
            reach = reach.max(pose::least_reach(pose, extent)?);
        }
    }
    Ok(reach)
}
