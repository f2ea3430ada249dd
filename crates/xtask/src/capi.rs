//! The C library: built, installed under a prefix, and tested as its users would use it.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::{
    debian,
    shell::{TaskResult, cargo, run, target, workspace},
};

/// Flags that turn warnings in the header into errors.
const STRICT: [&str; 4] = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"];

/// Builds the library and installs it with its header and its pkg-config file under the prefix given on the command line, by
/// default the target folder.
pub(crate) fn install() -> TaskResult {
    let prefix = std::env::args().nth(2).map_or_else(|| target().join("capi"), PathBuf::from);
    install_under(&prefix)
}

fn install_under(prefix: &Path) -> TaskResult {
    run(&mut cargo(&["build", "--release", "--locked", "--quiet", "--package", "isochore-capi"]))?;
    let [library, include] = ["lib", "include"].map(|name| prefix.join(name));
    fs::create_dir_all(library.join("pkgconfig"))?;
    fs::create_dir_all(&include)?;
    let prefix = prefix.canonicalize()?;
    for name in ["libisochore.so", "libisochore.a"] {
        fs::copy(target().join("release").join(name), library.join(name))?;
    }
    let source = workspace().join("crates/capi");
    cbindgen::generate(&source)?.write_to_file(include.join("isochore.h"));
    let description = fs::read_to_string(source.join("isochore.pc.in"))?
        .replace("@prefix@", &prefix.display().to_string())
        .replace("@version@", env!("CARGO_PKG_VERSION"));
    fs::write(library.join("pkgconfig/isochore.pc"), description)?;
    Ok(())
}

/// The example whose recipe the command also runs, with the same bytes as a result.
const PRESS: &str = "examples/press.c";

/// Installs into the target folder, builds the examples and tests with the flags of pkg-config, as C and as C++, and runs them.
/// Tests also run under valgrind.
pub(crate) fn test_programs() -> TaskResult {
    let prefix = target().join("capi");
    install_under(&prefix)?;
    let flags = pkg_config_flags(&prefix)?;
    let expected = pressed_by_command(&prefix)?;
    let programs = [
        ("cc", "-std=c11", PRESS),
        ("cc", "-std=c11", "examples/sculpt.c"),
        ("cc", "-std=c11", "tests/border.c"),
        ("cc", "-std=c11", "tests/random_calls.c"),
        ("c++", "-xc++", PRESS),
    ];
    for (compiler, language, source) in programs {
        let is_test = source.starts_with("tests");
        let program = prefix.join(format!("{}-{compiler}", source.replace(['/', '.'], "_")));
        let mut compile = Command::new(compiler);
        compile.args(STRICT).arg(language).arg(workspace().join("crates/capi").join(source));
        run(compile.arg("-xnone").arg("-o").arg(&program).args(&flags))?;
        let mesh = prefix.join("written.obj");
        run(Command::new(&program).arg(&mesh).env("LD_LIBRARY_PATH", prefix.join("lib")))?;
        if source == PRESS && fs::read(&mesh)? != expected {
            return Err(format!("{source} by {compiler} writes bytes that differ from the command's").into());
        }
        if is_test {
            debian::require("valgrind", &["valgrind"])?;
            let mut memory_check = Command::new("valgrind");
            memory_check.args([
                "--quiet",
                "--leak-check=full",
                "--show-leak-kinds=definite",
                "--errors-for-leak-kinds=definite",
                "--error-exitcode=1",
            ]);
            run(memory_check.arg(&program).arg(&mesh).env("LD_LIBRARY_PATH", prefix.join("lib")))?;
        }
    }
    Ok(())
}

/// The bytes that the command writes for the recipe in [`PRESS`], which consists of its quoted lines.
fn pressed_by_command(folder: &Path) -> TaskResult<Vec<u8>> {
    let source = fs::read_to_string(workspace().join("crates/capi").join(PRESS))?;
    let lines = source.lines().filter_map(|line| line.trim().strip_prefix('"')?.split("\\n\"").next());
    let (recipe, mesh) = (folder.join("press.toml"), folder.join("expected.obj"));
    fs::write(&recipe, lines.collect::<Vec<_>>().join("\n"))?;
    let mut command = cargo(&["run", "--release", "--locked", "--quiet", "--package", "isochore-cli", "--", "run"]);
    run(command.arg(&recipe).args(["--quiet", "--output"]).arg(&mesh))?;
    Ok(fs::read(mesh)?)
}

/// The compiler flags of pkg-config, or the same flags written out if pkg-config is not installed.
fn pkg_config_flags(prefix: &Path) -> TaskResult<Vec<String>> {
    let asked = Command::new("pkg-config")
        .args(["--cflags", "--libs", "isochore"])
        .env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"))
        .output();
    match asked {
        Ok(output) if output.status.success() => {
            Ok(String::from_utf8(output.stdout)?.split_whitespace().map(str::to_owned).collect())
        }
        Ok(output) => Err(String::from_utf8_lossy(&output.stderr).into_owned().into()),
        Err(_) => {
            let [include, library] = ["include", "lib"].map(|name| prefix.join(name).display().to_string());
            Ok(vec![format!("-I{include}"), format!("-L{library}"), "-lisochore".to_owned()])
        }
    }
}
