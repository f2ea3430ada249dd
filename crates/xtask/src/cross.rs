//! Compiling for machines other than this one.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use crate::{
    debian,
    shell::{TaskResult, cargo, run, target, workspace},
};

/// Debian's compiler, for targets that rustup has not to give.
const DEBIAN_PACKAGES: [&str; 5] = ["rustc-web", "cargo-web", "rust-web-src", "rust-web-llvm", "lld-22"];

/// Builds a package for another target, by rustup's libraries where they are there or can be fetched, else by Debian's compiler, which
/// makes them too. The folder with what was built.
pub(crate) fn build(package: &str, triple: &str, environment: (&str, &str)) -> TaskResult<PathBuf> {
    let folder = target().join("cross");
    let arguments = ["build", "--release", "--locked", "--package", package, "--target", triple, "--target-dir"];
    if has_rustup_target(triple) {
        run(cargo(&arguments).arg(&folder).env(environment.0, environment.1))?;
    } else {
        install_from_debian()?;
        let mut debian = Command::new("/usr/bin/cargo");
        debian.args(arguments).arg(&folder).arg("-Zbuild-std=std,panic_abort").current_dir(workspace());
        // The standard library is compiled along, which takes flags that a stable compiler has locked.
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
