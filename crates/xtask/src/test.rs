//! Everything that must pass before a change goes in.

use crate::{
    capi, debian, oracle, python,
    shell::{TaskResult, cargo, run},
    size,
};

/// Checks formatting and lints, runs all tests, then the oracle and the size of the command, then the library for C and the Python
/// package.
pub(crate) fn run_all() -> TaskResult {
    run(&mut cargo(&["fmt", "--all", "--check"]))?;
    run(&mut cargo(&["clippy", "--workspace", "--all-targets", "--locked", "--quiet", "--", "--deny", "warnings"]))?;
    // One of the tests counts instructions with it.
    debian::require("valgrind", &["valgrind"])?;
    // The only features that are on by default are peers of the benchmarks.
    run(&mut cargo(&["test", "--workspace", "--no-default-features", "--locked", "--quiet"]))?;
    oracle::run_judges()?;
    size::check()?;
    capi::test_programs()?;
    python::test_package()
}
