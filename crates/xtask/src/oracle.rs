//! Outside judges of what the command writes: PyMeshLab for volume, area and closedness, libigl for exact self-intersection.
//! Both come from the Python package registry into a virtual environment inside the target folder, and are never linked.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::{
    debian,
    environment::interpreter,
    shell::{TaskResult, cargo, run, target, workspace},
};

/// What the judges need, at the versions that were tried.
const PACKAGES: [&str; 3] = ["pymeshlab==2025.7.post1", "libigl==2.6.3", "numpy<3"];

/// The system library that PyMeshLab loads.
const SYSTEM_LIBRARY: &str = "libGL.so.1";

/// Builds the command, sets up the judges and lets them judge every recipe of the project and some of their own scan.
pub(crate) fn run_judges() -> TaskResult {
    run(&mut cargo(&["build", "--release", "--locked", "--quiet"]))?;
    let python = environment()?;
    let script = workspace().join("crates/xtask/src/oracle.py");
    let output = target().join("oracle/output");
    if output.exists() {
        fs::remove_dir_all(&output)?;
    }
    fs::create_dir_all(&output)?;
    let mut judge = Command::new(python);
    judge.arg(script).arg(target().join("release/isochore")).arg(workspace().join("data/recipes")).arg(output);
    run(&mut judge)
}

/// The interpreter of the judges' environment.
fn environment() -> TaskResult<PathBuf> {
    let python = interpreter("oracle", &PACKAGES)?;
    if !can_load(&python, SYSTEM_LIBRARY) {
        debian::install(&["libgl1"])?;
    }
    Ok(python)
}

fn can_load(python: &Path, library: &str) -> bool {
    let load = format!("import ctypes; ctypes.CDLL('{library}')");
    Command::new(python).args(["-c", &load]).output().is_ok_and(|output| output.status.success())
}
