//! The Python package: built, installed and tested as its users would use it.

use std::process::Command;

use crate::{
    environment::{install, interpreter},
    shell::{TaskResult, run, workspace},
};

/// Packages that the tests need, at the versions that were tried.
const PACKAGES: [&str; 5] = ["numpy==2.4.6", "pytest==9.2.0", "trimesh==5.2.0", "distributed==2026.8.0", "mypy==2.4.1"];

/// Installs the package of the workspace, compares it with its stubs, and runs its tests and its example.
pub(crate) fn test_package() -> TaskResult {
    let python = interpreter("python", &PACKAGES)?;
    let source = workspace().display().to_string();
    install(&python, &["--force-reinstall", "--no-deps", &source])?;
    let stubs = ["-m", "mypy.stubtest", "isochore", "--mypy-config-file", "pyproject.toml"];
    run(Command::new(&python).args(stubs))?;
    run(Command::new(&python)
        .args(["-m", "pytest", "--quiet", "-p", "no:cacheprovider"])
        .arg("crates/python/tests")
        .current_dir(workspace()))
}
