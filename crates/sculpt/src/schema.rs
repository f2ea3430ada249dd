//! JSON schemas of what is read and written, made from the types.

use schemars::{Schema, schema_for};

use crate::{Recipe, Report, StreamReport};

/// The schema of recipes, for TOML and JSON alike.
pub fn recipe() -> Schema {
    schema_for!(Recipe)
}

/// The schema of reports.
pub fn report() -> Schema {
    schema_for!(Report)
}

/// The schema of reports on streams of points.
pub fn stream_report() -> Schema {
    schema_for!(StreamReport)
}
