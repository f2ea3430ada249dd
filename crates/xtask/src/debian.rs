//! System packages.

use std::process::Command;

use crate::shell::{TaskResult, run};

/// Installs Debian packages. If the system does not allow it, the error names the command to run.
pub(crate) fn install(packages: &[&str]) -> TaskResult {
    let install = || {
        run(Command::new("apt-get").args(["update", "--quiet"]))?;
        run(Command::new("apt-get")
            .args(["install", "--yes", "--quiet", "--no-install-recommends"])
            .args(packages)
            .env("DEBIAN_FRONTEND", "noninteractive"))
    };
    let names = packages.join(" ");
    install().map_err(|error| format!("{error}; run: sudo apt-get install --yes {names}").into())
}

/// Installs the packages that provide `program`, unless it is already installed.
pub(crate) fn require(program: &str, packages: &[&str]) -> TaskResult {
    match Command::new(program).arg("--version").output() {
        Ok(_) => Ok(()),
        Err(_) => install(packages),
    }
}
