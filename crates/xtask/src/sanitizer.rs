//! Unsafe code under AddressSanitizer: the kernels of distance grids, and ten thousand calls of sessions.

use crate::shell::{TaskResult, cargo, run, target};

/// A target for which the compiler ships the runtime of the sanitizer.
const TARGET: &str = "x86_64-unknown-linux-gnu";

/// Builds the tests of the library crates with the sanitizer and runs them.
///
/// The C border is tested under valgrind by `cargo xtask test`, which also detects reads of uninitialized memory.
pub(crate) fn run_tests() -> TaskResult {
    let packages = ["test", "--locked", "--quiet", "--package", "isochore-mesh", "--package", "isochore-sculpt"];
    let mut tests = cargo(&packages);
    tests.args(["--lib", "--test", "session", "--target", TARGET, "--target-dir"]).arg(target().join("sanitizer"));
    // A stable compiler accepts the unstable sanitizer flag only with this variable.
    run(tests.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=address"))
}
