//! The rustdoc of all crates, public and private items, with warnings denied.

use crate::shell::{TaskResult, cargo, run};

/// Builds the documentation and fails on any warning, such as a broken link.
pub(crate) fn check() -> TaskResult {
    let arguments =
        ["doc", "--workspace", "--no-deps", "--document-private-items", "--all-features", "--locked", "--quiet"];
    // Not the features of `bench`, which only add peers to compare with, nor those of xtask, which build bindings.
    let mut doc = cargo(&arguments);
    run(doc.args(["--exclude", "isochore-bench", "--exclude", "xtask"]).env("RUSTDOCFLAGS", "--deny warnings"))
}
