//! The test command of the README.

use crate::{
    capi, debian, docs, guide, oracle, package, prose, python,
    shell::{TaskResult, cargo, run},
    size,
};

/// Checks formatting, lints, prose, documentation and packages, runs all Rust tests, then the independent checks of written
/// meshes, the size of the command, the C library and the Python package.
pub(crate) fn run_all() -> TaskResult {
    run(&mut cargo(&["fmt", "--all", "--check"]))?;
    prose::check()?;
    guide::check()?;
    package::check_crates()?;
    run(&mut cargo(&["clippy", "--workspace", "--all-targets", "--locked", "--quiet", "--", "--deny", "warnings"]))?;
    docs::check()?;
    // One of the tests counts instructions with it.
    debian::require("valgrind", &["valgrind"])?;
    // The only features that are on by default and left out here are peers of the benchmarks.
    run(&mut cargo(&["test", "--workspace", "--no-default-features", "--features", FEATURES, "--locked", "--quiet"]))?;
    oracle::run_judges()?;
    size::check()?;
    capi::test_programs()?;
    python::test_package()
}

/// Features of the library in front that its examples need.
const FEATURES: &str = "isochore/io,isochore/curve,isochore/session,isochore/picture";
