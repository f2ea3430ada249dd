//! The `isochore` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    isochore::main(std::env::args_os())
}
