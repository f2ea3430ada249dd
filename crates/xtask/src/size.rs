//! How large the command is.

use crate::shell::{TaskResult, cargo, run, target};

/// Bytes that the command may have. Larger, and a dependency that doubles it goes unnoticed; smaller leaves no room to grow.
const MOST_BYTES: u64 = 15_000_000;

/// Builds the command for release and fails where it is too large.
pub(crate) fn check() -> TaskResult {
    run(&mut cargo(&["build", "--release", "--locked", "--quiet", "--package", "isochore-cli"]))?;
    let size = target().join("release").join(format!("isochore{}", std::env::consts::EXE_SUFFIX)).metadata()?.len();
    if size > MOST_BYTES {
        return Err(format!("the command has {size} bytes, more than {MOST_BYTES}").into());
    }
    Ok(())
}
