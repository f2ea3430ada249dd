//! The guide: an mdBook in `docs/`, its generated pages, and its links.

mod error_index;
mod links;
mod pictures;
mod recipe_reference;

use std::{fs, path::PathBuf, process::Command};

pub(crate) use pictures::draw_all as draw_pictures;

use crate::shell::{TaskResult, cargo, run, target, workspace};

/// The release of mdBook that the guide is built with.
const MDBOOK: &str = "0.5.4";

/// Builds the guide into `target/guide`, and fails on a generated page that is out of date or on a broken link.
pub(crate) fn build() -> TaskResult {
    check()?;
    let output = target().join("guide");
    run(Command::new(mdbook()?).arg("build").arg(workspace().join("docs")).arg("--dest-dir").arg(&output))?;
    eprintln!("the guide is in {}", output.join("index.html").display());
    Ok(())
}

/// Checks the generated pages and the links of all documents. Needs no mdBook.
pub(crate) fn check() -> TaskResult {
    recipe_reference::check()?;
    error_index::check()?;
    links::check()
}

/// Writes the generated pages: the keys of recipes from the schema, and the error messages from the sources.
pub(crate) fn write_reference() -> TaskResult {
    recipe_reference::write()?;
    error_index::write()
}

/// The path of mdBook, which is compiled into the target folder on first use.
fn mdbook() -> TaskResult<PathBuf> {
    let root = target().join("tools");
    let program = root.join("bin").join(format!("mdbook{}", std::env::consts::EXE_SUFFIX));
    if !program.is_file() {
        fs::create_dir_all(&root)?;
        let arguments =
            ["install", "mdbook", "--version", MDBOOK, "--locked", "--no-default-features", "--features", "search"];
        run(cargo(&arguments).arg("--root").arg(&root).arg("--target-dir").arg(root.join("build")))?;
    }
    Ok(program)
}
