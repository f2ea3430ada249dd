//! Checks of names.

use std::collections::BTreeMap;

use crate::recipe::{Tool, error::RecipeError, problem::ReferenceProblem, suggestion::Suggestion};

/// The tools of a recipe, by name.
pub(super) type Tools = BTreeMap<String, Tool>;

/// Checks that the key `tool` names one of the recipe's tools.
pub(super) fn known_tool(tools: &Tools, name: &str) -> Result<(), RecipeError<ReferenceProblem>> {
    if tools.contains_key(name) {
        return Ok(());
    }
    let suggestion = Suggestion::new(name, tools.keys().map(String::as_str));
    Err(RecipeError::new("tool", ReferenceProblem::UnknownTool { name: name.to_owned(), suggestion }))
}
