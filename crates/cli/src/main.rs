//! The `isochore` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    isochore_cli::main(std::env::args_os())
}
