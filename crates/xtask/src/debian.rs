//! What only the system can install.

use std::process::Command;

use crate::shell::{TaskResult, run};

/// Installs packages of Debian and its kin where the system lets us, and says how where it does not.
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

/// Installs the packages that bring `program` and what it needs, unless it is there.
pub(crate) fn require(program: &str, packages: &[&str]) -> TaskResult {
    match Command::new(program).arg("--version").output() {
        Ok(_) => Ok(()),
        Err(_) => install(packages),
    }
}
