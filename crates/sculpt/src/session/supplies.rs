//! Objects that the host supplies to a replay.

use std::{collections::BTreeMap, sync::Arc};

use isochore_field as field;

use crate::scene::Meshes;

/// Objects that a recipe names but does not contain.
#[derive(Debug, Clone, Default)]
pub struct Supplies {
    /// Loaded meshes by their names in the recipe.
    pub meshes: Meshes,
    /// Tools of the host by their names in the recipe. They are used for entries whose shape is
    /// [`ToolShape::Host`](crate::recipe::ToolShape::Host); all other tools are built from their
    /// descriptions.
    pub tools: BTreeMap<String, Arc<field::Tool>>,
}
