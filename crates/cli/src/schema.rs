//! `isochore schema`: JSON schemas of recipes and reports, for editors and other programs.

use crate::{
    arguments::{Document, SchemaArguments},
    command_error::CommandError,
    console::Console,
    outcome::Outcome,
};

pub(crate) fn schema(arguments: &SchemaArguments, console: &Console) -> Result<Outcome, CommandError> {
    console.print_json(&match arguments.document {
        Document::Recipe => isochore_sculpt::schema::recipe(),
        Document::Report => isochore_sculpt::schema::report(),
        Document::StreamReport => isochore_sculpt::schema::stream_report(),
    });
    Ok(Outcome::Done)
}
