//! Unsafe code under AddressSanitizer: the kernels of distance grids, and sessions in ten thousand calls.

use crate::shell::{TaskResult, cargo, run, target};

/// Where the compiler's own runtime of the sanitizer is at hand.
const TARGET: &str = "x86_64-unknown-linux-gnu";

/// Builds the tests of the crates at work below the bindings with the sanitizer and runs them.
///
/// What crosses the border to C is tried under valgrind by `cargo xtask test`, which also sees memory that nobody has written to.
pub(crate) fn run_tests() -> TaskResult {
    let packages = ["test", "--locked", "--quiet", "--package", "isochore-mesh", "--package", "isochore-sculpt"];
    let mut tests = cargo(&packages);
    tests.args(["--lib", "--test", "session", "--target", TARGET, "--target-dir"]).arg(target().join("sanitizer"));
    // The sanitizer is a flag that a stable compiler has locked.
    run(tests.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=address"))
}
