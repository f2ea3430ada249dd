//! What is too heavy for every run of the tests: the sanitizer, an emulated ARM, a browser, and Blender.

use std::process::Command;

use crate::{
    arm, browser,
    environment::{install, interpreter},
    sanitizer,
    shell::{TaskResult, run, workspace},
};

/// Blender as a Python module, at the last version for this Python.
const BLENDER: [&str; 2] = ["bpy==5.0.1", "pytest==9.2.0"];

/// Runs tests under the sanitizer, recipes on an emulated ARM, the tests in the browser and those of the Blender add-on.
pub(crate) fn run_all() -> TaskResult {
    sanitizer::run_tests()?;
    arm::compare_bytes()?;
    browser::test_pages()?;
    let python = interpreter("blender", &BLENDER)?;
    let source = workspace().display().to_string();
    install(&python, &["--force-reinstall", "--no-deps", &source])?;
    run(Command::new(python).args(["-m", "pytest", "--quiet", "-p", "no:cacheprovider", "crates/python/blender"]))
}
