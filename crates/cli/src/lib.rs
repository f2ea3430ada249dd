//! The command `isochore`: deforms meshes by recipes, prints mesh statistics, samples signed
//! distances, and computes frames and swept surfaces along curves.
//!
//! The computations are in the libraries. This crate handles arguments, files, messages and exit
//! codes. It parses a command line in two stages: [`arguments`] holds it as plain data, and the
//! module of each subcommand turns that data into objects.
//!
//! | exit code | meaning |
//! |---|---|
//! | 0 | success; all promises of the recipe were kept |
//! | 1 | a promise was missed; the outputs are written and the report names the promise |
//! | 2 | invalid input or usage; nothing is written |
//! | 130 | interrupted; nothing is written |
//!
//! Data goes to stdout and messages go to stderr. An error is one line that starts with `error: `.

pub mod arguments;
mod command_error;
mod completions;
mod console;
mod demo;
mod distance;
mod frames;
mod inspect;
mod interrupt;
mod job;
mod man;
mod mesh_file;
mod outcome;
mod outputs;
mod preview;
mod run;
mod schema;
mod spine_file;
mod spine_options;
mod staging;
mod stream;
mod sweep;

use std::{ffi::OsString, process::ExitCode};

use clap::Parser;

use arguments::{Arguments, Command};
use command_error::CommandError;
use console::Console;
use outcome::Outcome;

/// Runs a command line. Its first item is the name of the program.
///
/// ```
/// use std::process::ExitCode;
///
/// let arguments = ["isochore", "--version"].map(Into::into);
/// assert_eq!(isochore_cli::main(arguments), ExitCode::SUCCESS);
/// ```
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    // A usage error is reported before `Arguments` exist, so the flag is searched for here.
    let is_json = arguments.iter().any(|argument| argument == "--json");
    let result = match Arguments::try_parse_from(&arguments) {
        Ok(arguments) => execute(&arguments),
        Err(error) if !error.use_stderr() => {
            // Printing help or the version fails only if stdout is closed, and then nobody reads
            // it.
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
        Err(error) => Err(CommandError::usage(&error)),
    };
    match result {
        Ok(outcome) => outcome.into(),
        Err(error) => {
            error.print(is_json);
            ExitCode::from(error.exit_code())
        }
    }
}

fn execute(arguments: &Arguments) -> Result<Outcome, CommandError> {
    if let Some(threads) = arguments.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.get())
            .build_global()
            .map_err(|error| CommandError::Usage(format!("cannot start {threads} threads: {error}")))?;
    }
    let console = Console::new(arguments.quiet, arguments.json)?;
    let result = match &arguments.command {
        Command::Run(arguments) => run::run(arguments, &console),
        Command::Inspect(arguments) => inspect::inspect(arguments, &console),
        Command::Distance(arguments) => distance::distance(arguments, &console),
        Command::Frames(arguments) => frames::frames(arguments, &console),
        Command::Sweep(arguments) => sweep::sweep(arguments, &console),
        Command::Demo(arguments) => demo::demo(arguments, &console),
        Command::Schema(arguments) => schema::schema(arguments, &console),
        Command::Completions(arguments) => completions::completions(arguments, &console),
        Command::Man(arguments) => man::man(arguments, &console),
    };
    console.finish();
    // An error after an interrupt is usually a consequence of it.
    if console.interrupt().is_raised() { result.map_err(|_| CommandError::Interrupted) } else { result }
}
