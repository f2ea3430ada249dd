//! JSON schemas of what is read and written, made from the types.

use schemars::{Schema, schema_for};

use crate::{Recipe, Report};

/// The schema of recipes, for TOML and JSON alike.
pub fn recipe() -> Schema {
    schema_for!(Recipe)
}

/// The schema of reports.
pub fn report() -> Schema {
    schema_for!(Report)
}
