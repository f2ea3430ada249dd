//! `isochore completions`: completion scripts for shells.

use clap::CommandFactory;

use crate::{
    arguments::{Arguments, CompletionsArguments},
    command_error::CommandError,
    console::Console,
    outcome::Outcome,
};

pub(crate) fn completions(arguments: &CompletionsArguments, console: &Console) -> Result<Outcome, CommandError> {
    let mut command = Arguments::command();
    let name = command.get_name().to_owned();
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, name, &mut script);
    console.print(String::from_utf8_lossy(&script).trim_end());
    Ok(Outcome::Done)
}
