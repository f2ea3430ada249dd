//! Checks that are too heavy for the test command: guide, packages, sanitizer, emulated ARM, browser and Blender.

use std::process::Command;

use crate::{
    arm, browser,
    environment::{install, interpreter},
    guide, package, sanitizer,
    shell::{TaskResult, run, workspace},
};

/// Blender as a Python module, at the last version for this Python.
const BLENDER: [&str; 2] = ["bpy==5.0.1", "pytest==9.2.0"];

/// Builds the guide and all packages, then runs tests under the sanitizer, recipes on an emulated ARM, the tests in the
/// browser and those of the Blender add-on.
pub(crate) fn run_all() -> TaskResult {
    guide::build()?;
    package::check_all()?;
    sanitizer::run_tests()?;
    arm::compare_bytes()?;
    browser::test_pages()?;
    let python = interpreter("blender", &BLENDER)?;
    let source = workspace().display().to_string();
    install(&python, &["--force-reinstall", "--no-deps", &source])?;
    run(Command::new(python).args(["-m", "pytest", "--quiet", "-p", "no:cacheprovider", "crates/python/blender"]))
}
