//! Tasks of the workspace: `cargo xtask NAME`.

#![allow(clippy::print_stderr, reason = "tasks speak to whoever started them")]

mod arm;
#[cfg(test)]
mod arrows;
mod bench;
mod browser;
mod capi;
mod cross;
mod data;
mod debian;
mod environment;
mod full;
mod gallery;
mod instructions;
mod oracle;
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
        "formatting, lints, all tests in Rust, C and Python, then the oracle: what must pass before a change goes in",
        test::run_all,
    ),
    (
        "oracle",
        "compare what recipes write with PyMeshLab and libigl, installed into the target folder",
        oracle::run_judges,
    ),
    (
        "bench",
        "run the programs of the folder `bench`, or those named, and write the table of the README",
        bench::measure_all,
    ),
    ("capi", "install the library for C with its header under a prefix, by default target/capi", capi::install),
    ("browser", "build the package for browsers in a folder, by default target/wasm/site/pkg", browser::build),
    ("python", "install the Python package into the target folder and run its tests", python::test_package),
    ("instructions", "count the instructions of the hot loops anew, which a test compares", instructions::count_all),
    ("full", "what is too heavy for every run: sanitizer, ARM, browser and Blender", full::run_all),
    ("sanitizer", "run the tests around unsafe code under AddressSanitizer", sanitizer::run_tests),
    ("arm", "run recipes by the command for ARM, emulated, and compare the bytes", arm::compare_bytes),
    ("pages", "build the package for browsers and run its tests and examples in Chromium", browser::test_pages),
    ("data", "make the meshes of the folder `data` and its README anew", data::write_all),
    ("gallery", "run all recipes and examples of the figures, and show them in gallery/gallery.md", gallery::draw_all),
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
