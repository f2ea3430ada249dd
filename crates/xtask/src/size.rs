//! The size of the command.

use crate::shell::{TaskResult, cargo, run, target};

/// Largest size of the command in bytes. A larger limit lets a dependency double it unnoticed; a smaller one leaves no margin.
const MOST_BYTES: u64 = 15_000_000;

/// Builds the command for release and fails if it is too large.
pub(crate) fn check() -> TaskResult {
    run(&mut cargo(&["build", "--release", "--locked", "--quiet", "--package", "isochore-cli"]))?;
    let size = target().join("release").join(format!("isochore{}", std::env::consts::EXE_SUFFIX)).metadata()?.len();
    if size > MOST_BYTES {
        return Err(format!("the command has {size} bytes, more than {MOST_BYTES}").into());
    }
    Ok(())
}
