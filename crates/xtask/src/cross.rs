//! Cross-compilation.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use crate::{
    debian,
    shell::{TaskResult, cargo, run, target, workspace},
};

/// Debian's compiler, for targets that rustup cannot provide.
const DEBIAN_PACKAGES: [&str; 5] = ["rustc-web", "cargo-web", "rust-web-src", "rust-web-llvm", "lld-22"];

/// Builds a package for another target and returns the folder with the results. Uses rustup's standard library if it is installed or
/// can be fetched, and otherwise Debian's compiler, which builds the standard library too.
pub(crate) fn build(package: &str, triple: &str, environment: (&str, &str)) -> TaskResult<PathBuf> {
    let folder = target().join("cross");
    let arguments = ["build", "--release", "--locked", "--package", package, "--target", triple, "--target-dir"];
    if has_rustup_target(triple) {
        run(cargo(&arguments).arg(&folder).env(environment.0, environment.1))?;
    } else {
        install_from_debian()?;
        let mut debian = Command::new("/usr/bin/cargo");
        debian.args(arguments).arg(&folder).arg("-Zbuild-std=std,panic_abort").current_dir(workspace());
        // Building the standard library needs unstable flags, which a stable compiler accepts only with this variable.
        debian.env("RUSTC", "/usr/bin/rustc").env("RUSTC_BOOTSTRAP", "1").env("CARGO_PROFILE_RELEASE_PANIC", "abort");
        run(debian.env(environment.0, environment.1).env_remove("RUSTUP_TOOLCHAIN"))?;
    }
    Ok(folder.join(triple).join("release"))
}

fn has_rustup_target(triple: &str) -> bool {
    let has = || {
        let output = Command::new("rustc").args(["--print", "target-libdir", "--target", triple]).output();
        output.is_ok_and(|output| Path::new(String::from_utf8_lossy(&output.stdout).trim()).exists())
    };
    has() || (Command::new("rustup").args(["target", "add", triple]).output().is_ok() && has())
}

fn install_from_debian() -> TaskResult {
    if ["lld-22", "cargo"].iter().all(|name| Path::new("/usr/bin").join(name).exists()) {
        return Ok(());
    }
    debian::install(&DEBIAN_PACKAGES)
}
