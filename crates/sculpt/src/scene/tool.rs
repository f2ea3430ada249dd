//! One tool alone, without a recipe around it.

use std::collections::BTreeMap;

use isochore_field as field;
use isochore_mesh::{Aabb, Monitor};

use super::{Scene, Workshop};
use crate::{
    recipe::{Icosphere, Recipe, Target, TargetShape, Tool},
    replay::{Meshes, ReplayError},
};

impl Scene {
    /// Makes the tool `name` that `description` tells of, and what the user should know about it.
    ///
    /// # Errors
    /// [`ReplayError`], with the key as in a recipe that calls the tool `name`.
    pub fn tool(
        name: &str,
        description: &Tool,
        meshes: &Meshes,
        monitor: &dyn Monitor,
    ) -> Result<(field::Tool, Vec<String>), ReplayError> {
        // A recipe that is complete but for strokes; its target plays no part.
        let shape = TargetShape::Icosphere(Icosphere { radius: 1.0, subdivisions: 0 });
        let recipe = Recipe {
            recipe: 1,
            target: Target { shape: Some(shape), ..Target::default() },
            tools: BTreeMap::from([(name.to_owned(), description.clone())]),
            strokes: Vec::new(),
            integrate: Default::default(),
            refine: Default::default(),
            promise: Default::default(),
            volume: Default::default(),
            mask: Default::default(),
            output: Default::default(),
        };
        recipe.validate()?;
        let mut workshop = Workshop { recipe: &recipe, meshes, monitor, bounds: Aabb::EMPTY, warnings: Vec::new() };
        let tool = workshop.tool(name, description)?;
        Ok((tool, workshop.warnings))
    }
}
