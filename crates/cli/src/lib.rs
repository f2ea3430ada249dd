//! The command `isochore`: deforms meshes from recipes, inspects them, samples their distance, and
//! carries frames and profiles along curves.
//!
//! Everything that it does is in the libraries; here are arguments, files, words and exit codes. A command line is read in
//! two stages: [`arguments`] holds it as plain data, and each subcommand's own module makes objects of it.
//!
//! | exit code | meaning |
//! |---|---|
//! | 0 | done, and every promise of the recipe was kept |
//! | 1 | a promise was missed; the outputs are written and the report names it |
//! | 2 | bad input or usage; nothing is written |
//! | 130 | interrupted; nothing is written |
//!
//! Data goes to stdout; words go to stderr, errors as one line `error: …`.

pub mod arguments;
mod command_error;
mod console;
mod csv_table;
mod demo;
mod distance;
mod frames;
mod inspect;
mod interrupt;
mod job;
mod preview;
mod run;
mod schema;
mod spine_file;
mod staging;
mod stream;
mod sweep;

use std::{ffi::OsString, process::ExitCode};

use clap::Parser;

use arguments::{Arguments, Command};
use command_error::CommandError;
use console::Console;

/// How a command that did its work ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Done,
    PromiseMissed,
}

/// Runs the command line `arguments`, the program's name first.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    // Usage errors are reported before there are parsed arguments that could tell how.
    let is_json = arguments.iter().any(|argument| argument == "--json");
    let result = match Arguments::try_parse_from(&arguments) {
        Ok(arguments) => execute(&arguments),
        Err(error) if !error.use_stderr() => {
            // The only failure is a closed stdout, and then there is no one to tell.
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
        Err(error) => Err(CommandError::usage(&error)),
    };
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::PromiseMissed) => ExitCode::from(1),
        Err(error) => {
            console::print_error(&error, is_json);
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
    };
    console.finish();
    // Whatever went wrong after an interrupt may be its consequence.
    if console.interrupt().is_raised() { result.map_err(|_| CommandError::Interrupted) } else { result }
}
