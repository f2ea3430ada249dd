//! JSON schemas of recipes and reports, generated from the types.

use schemars::{Schema, schema_for};

use crate::{Recipe, Report, StreamReport};

/// Schema of recipes, for both TOML and JSON.
///
/// ```
/// let schema = isochore_sculpt::schema::recipe();
/// assert!(schema.get("properties").is_some());
/// ```
pub fn recipe() -> Schema {
    schema_for!(Recipe)
}

/// Schema of reports.
pub fn report() -> Schema {
    schema_for!(Report)
}

/// Schema of reports of streams of points.
pub fn stream_report() -> Schema {
    schema_for!(StreamReport)
}
