//! Outside judges of what the command writes: PyMeshLab for volume, area and closedness, libigl for exact self-intersection.
//! Both come from the Python package registry into a virtual environment inside the target folder, and are never linked.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::{
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
        install_system_library()?;
    }
    Ok(python)
}

fn can_load(python: &Path, library: &str) -> bool {
    let load = format!("import ctypes; ctypes.CDLL('{library}')");
    Command::new(python).args(["-c", &load]).output().is_ok_and(|output| output.status.success())
}

/// Installs the library where the system lets us, and says how where it does not.
fn install_system_library() -> TaskResult {
    let by_hand = "sudo apt-get install --yes libgl1";
    let install = || {
        run(Command::new("apt-get").args(["update", "--quiet"]))?;
        run(Command::new("apt-get").args(["install", "--yes", "--quiet", "--no-install-recommends", "libgl1"]))
    };
    install().map_err(|error| {
        format!("PyMeshLab needs {SYSTEM_LIBRARY}, which could not be installed ({error}); run: {by_hand}").into()
    })
}
