//! The command for ARM, which uses other SIMD kernels, under an emulator. It must write the same bytes.

use std::{fs, process::Command};

use crate::{
    cross, debian,
    shell::{TaskResult, cargo, run, target, workspace},
};

const TRIPLE: &str = "aarch64-unknown-linux-gnu";
const LINKER: &str = "aarch64-linux-gnu-gcc";

/// Recipes with an analytic and with a sampled tool. Together they run all kernels that are compiled for several vector widths.
const RECIPES: [&str; 2] = ["sphere", "knight"];

/// Runs recipes natively and emulated, and compares the files.
pub(crate) fn compare_bytes() -> TaskResult {
    debian::require(LINKER, &["gcc-aarch64-linux-gnu", "libc6-dev-arm64-cross"])?;
    debian::require("qemu-aarch64", &["qemu-user"])?;
    let environment = ("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", LINKER);
    let command = cross::build("isochore-cli", TRIPLE, environment)?.join("isochore");
    let folder = target().join("arm");
    fs::create_dir_all(&folder)?;
    for name in RECIPES {
        let recipe = workspace().join(format!("data/recipes/{name}.toml"));
        let [native, emulated] = ["native", "arm"].map(|machine| folder.join(format!("{name}.{machine}.obj")));
        let run_recipe =
            |mut runner: Command, output| run(runner.arg("run").arg(&recipe).args(["--quiet", "--output"]).arg(output));
        run_recipe(cargo(&["run", "--release", "--locked", "--quiet", "--"]), &native)?;
        let mut emulator = Command::new("qemu-aarch64");
        emulator.args(["-L", "/usr/aarch64-linux-gnu"]).arg(&command);
        run_recipe(emulator, &emulated)?;
        if fs::read(&native)? != fs::read(&emulated)? {
            return Err(format!("{} and {} differ", native.display(), emulated.display()).into());
        }
    }
    Ok(())
}
