//! Running programs and finding folders.

use std::{
    error::Error,
    path::{Path, PathBuf},
    process::Command,
};

/// Result of a task. The error is one line that says what failed.
pub(crate) type TaskResult<T = ()> = Result<T, Box<dyn Error>>;

/// The folder of the workspace.
pub(crate) fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .expect("the task runner is two folders below the workspace")
}

/// The target folder, which holds builds and everything that tasks install or generate.
pub(crate) fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace().join("target"), PathBuf::from)
}

/// Prints a command and runs it in the workspace. A failure of the command is an error.
pub(crate) fn run(command: &mut Command) -> TaskResult {
    command.current_dir(workspace());
    let shown = format!("{command:?}").replace('"', "");
    eprintln!("$ {shown}");
    let status = command.status().map_err(|error| format!("{shown}: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{shown}: {status}").into()) }
}

/// Cargo, with these arguments.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments);
    command
}

/// Paths of the files under version control or about to be, relative to the workspace and sorted. Patterns are those of Git.
pub(crate) fn project_files(patterns: &[&str]) -> TaskResult<Vec<String>> {
    let mut list = Command::new("git");
    list.args(["ls-files", "-co", "--exclude-standard", "--"]).args(patterns).current_dir(workspace());
    let listing = String::from_utf8(list.output()?.stdout)?;
    let mut paths: Vec<String> =
        listing.lines().filter(|path| workspace().join(path).is_file()).map(str::to_owned).collect();
    paths.sort();
    Ok(paths)
}
