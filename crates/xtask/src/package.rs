//! The packages for the registries of Rust, Python and JavaScript, checked before they are published.

use std::{collections::BTreeSet, fs, path::PathBuf, process::Command};

use crate::{
    browser,
    environment::interpreter,
    shell::{TaskResult, cargo, run, target, workspace},
};

/// Every library crate, dependencies first.
const LIBRARIES: [&str; 6] =
    ["isochore-mesh", "isochore-curve", "isochore-field", "isochore-sculpt", "isochore-picture", "isochore"];

/// Files that every package holds beside its code.
const DOCUMENTS: [&str; 3] = ["README.md", "LICENSE-APACHE", "LICENSE-MIT"];

/// Packages that build the Python package, at the versions that were tried.
const BUILDERS: [&str; 2] = ["build==1.6.1", "maturin>=1.16,<2"];

/// Packages every library crate and compares the files within with what a registry and its users need.
pub(crate) fn check_crates() -> TaskResult {
    for name in LIBRARIES {
        let listing = cargo(&["package", "--list", "--allow-dirty", "--locked", "--package", name])
            .current_dir(workspace())
            .output()?;
        if !listing.status.success() {
            return Err(String::from_utf8_lossy(&listing.stderr).into_owned().into());
        }
        expect_documents(name, &String::from_utf8(listing.stdout)?)?;
    }
    Ok(())
}

/// Builds the packages of all registries, each from its own packed files, and checks that they are complete.
pub(crate) fn check_all() -> TaskResult {
    check_crates()?;
    forget_packed_sources()?;
    let mut package = cargo(&["package", "--allow-dirty", "--locked", "--quiet"]);
    package.args(LIBRARIES.iter().flat_map(|name| ["--package", name]));
    run(&mut package)?;
    check_python()?;
    check_javascript()
}

/// Removes the sources of earlier packages from Cargo's cache. They have the same version, so Cargo would
/// build the packages of today against them.
fn forget_packed_sources() -> TaskResult {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cargo")));
    let Some(Ok(registries)) = home.map(|home| fs::read_dir(home.join("registry/src"))) else { return Ok(()) };
    for registry in registries {
        for package in fs::read_dir(registry?.path())? {
            let package = package?;
            if package.file_name().to_string_lossy().starts_with("isochore-") {
                fs::remove_dir_all(package.path())?;
            }
        }
    }
    Ok(())
}

/// Makes the source distribution for Python and builds the package from it alone.
fn check_python() -> TaskResult {
    let python = interpreter("sdist", &BUILDERS)?;
    let folder = clean_folder("sdist/output")?;
    let mut sdist = Command::new(&python);
    run(sdist.args(["-m", "build", "--sdist", "--no-isolation", "--outdir"]).arg(&folder).arg(workspace()))?;
    let archive = only_file(&folder)?;
    let listing = Command::new("tar").arg("-tzf").arg(&archive).output()?;
    expect_documents("the source distribution", &String::from_utf8(listing.stdout)?)?;
    let mut build = Command::new(&python);
    build.args(["-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir"]).arg(folder.join("wheel"));
    run(build.arg(archive))
}

/// Packs the package for browsers and checks the files that npm takes.
fn check_javascript() -> TaskResult {
    let folder = clean_folder("npm")?;
    browser::build_in(&folder)?;
    let pack = Command::new("npm").args(["pack", "--dry-run", "--json"]).current_dir(&folder).output()?;
    let listing: serde_json::Value = serde_json::from_slice(&pack.stdout)?;
    let files = listing[0]["files"].as_array().ok_or("npm lists no files")?;
    let paths: Vec<&str> = files.iter().filter_map(|file| file["path"].as_str()).collect();
    expect_documents("the npm package", &paths.join("\n"))
}

fn expect_documents(name: &str, listing: &str) -> TaskResult {
    let files: BTreeSet<&str> = listing.lines().filter_map(|path| path.rsplit('/').next()).collect();
    match DOCUMENTS.iter().find(|document| !files.contains(*document)) {
        Some(document) => Err(format!("{name} lacks {document}").into()),
        None => Ok(()),
    }
}

fn clean_folder(name: &str) -> TaskResult<PathBuf> {
    let folder = target().join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

fn only_file(folder: &std::path::Path) -> TaskResult<PathBuf> {
    let mut entries = fs::read_dir(folder)?;
    Ok(entries.next().ok_or("the folder is empty")??.path())
}
