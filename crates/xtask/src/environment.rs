//! Virtual environments of Python inside the target folder.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::shell::{TaskResult, run, target};

/// The interpreter of the environment `name`, which is created with `packages` if it does not exist yet.
pub(crate) fn interpreter(name: &str, packages: &[&str]) -> TaskResult<PathBuf> {
    let folder = target().join(name).join("environment");
    let python = folder.join("bin/python");
    let stamp = folder.join("installed.txt");
    let requested = packages.join("\n");
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == requested) {
        return Ok(python);
    }
    run(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    install(&python, packages)?;
    fs::write(stamp, requested)?;
    Ok(python)
}

/// Installs `packages`, names or folders, into the environment of this interpreter.
pub(crate) fn install(python: &Path, packages: &[&str]) -> TaskResult {
    run(Command::new(python).args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(packages))
}
