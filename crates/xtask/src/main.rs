//! Tasks of the workspace: `cargo xtask NAME`.

#![allow(clippy::print_stderr, reason = "tasks report to the terminal")]

mod arm;
#[cfg(test)]
mod arrows;
mod bench;
mod browser;
mod capi;
mod cross;
mod data;
mod debian;
mod docs;
mod environment;
mod full;
mod gallery;
mod guide;
mod instructions;
mod marked_table;
mod oracle;
mod package;
mod prose;
mod python;
mod sanitizer;
mod shell;
mod size;
mod test;

use std::process::ExitCode;

use shell::TaskResult;

type Task = (&'static str, &'static str, fn() -> TaskResult);

const TASKS: &[Task] = &[
    (
        "test",
        "check formatting, lints, prose, documentation and packages, and run all tests in Rust, C and Python and the oracle",
        test::run_all,
    ),
    (
        "oracle",
        "check written meshes with PyMeshLab and libigl; with --write, write their table into the documents",
        oracle::run_judges,
    ),
    (
        "bench",
        "run the programs of the folder `bench`, or those named, and write bench/RESULTS.md and the README's rows",
        bench::measure_all,
    ),
    ("capi", "install the C library and its header under a prefix, by default target/capi", capi::install),
    ("browser", "build the JavaScript package in a folder, by default target/wasm/site/pkg", browser::build),
    ("docs", "build the rustdoc of all crates, private items too, and fail on warnings", docs::check),
    ("guide", "build the guide with mdBook into target/guide, its links checked", guide::build),
    ("reference", "write the generated pages of the guide: recipe keys and error messages", guide::write_reference),
    (
        "pictures",
        "draw the pictures of the README and the guide, and write the table beside them",
        guide::draw_pictures,
    ),
    ("packages", "build and check the packages for crates.io, PyPI and npm", package::check_all),
    ("prose", "count hard-to-read idioms per file, and fail above the limits", prose::check),
    ("python", "install the Python package into the target folder and run its tests", python::test_package),
    (
        "instructions",
        "count the instructions of the hot loops and write the counts that a test compares",
        instructions::count_all,
    ),
    ("full", "run the heavy checks: guide, packages, sanitizer, ARM, browser and Blender", full::run_all),
    ("sanitizer", "run the tests of unsafe code under AddressSanitizer", sanitizer::run_tests),
    ("arm", "run recipes with the emulated ARM command and compare the bytes", arm::compare_bytes),
    ("pages", "build the JavaScript package and run its tests and examples in Chromium", browser::test_pages),
    ("data", "generate the meshes of the folder `data` and its README", data::write_all),
    ("gallery", "run all recipes and examples of the figures, and write gallery/gallery.md", gallery::draw_all),
];

fn main() -> ExitCode {
    let name = std::env::args().nth(1).unwrap_or_default();
    let Some((_, _, run)) = TASKS.iter().find(|(task, ..)| *task == name) else {
        eprintln!("usage: cargo xtask TASK");
        for (task, what, _) in TASKS {
            eprintln!("  {task:<12} {what}");
        }
        return ExitCode::from(2);
    };
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
