//! Counts the instructions of the hot loops anew.

use crate::shell::{TaskResult, cargo, run};

/// Writes `bench/instructions.json`, which a test compares with.
pub(crate) fn count_all() -> TaskResult {
    let mut test =
        cargo(&["test", "--workspace", "--no-default-features", "--locked", "--quiet", "--test", "instructions"]);
    run(test.env("ISOCHORE_WRITE_INSTRUCTIONS", "1"))
}
