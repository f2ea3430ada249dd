//! Recounts the instructions of the hot loops.

use crate::shell::{TaskResult, cargo, run};

/// Writes `bench/instructions.json`, the reference of a test.
pub(crate) fn count_all() -> TaskResult {
    let mut test =
        cargo(&["test", "--workspace", "--no-default-features", "--locked", "--quiet", "--test", "instructions"]);
    run(test.env("ISOCHORE_WRITE_INSTRUCTIONS", "1"))
}
