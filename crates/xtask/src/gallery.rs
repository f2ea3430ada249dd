//! The figures: every example, run.

use std::fs;

use crate::shell::{TaskResult, cargo, run, target, workspace};

/// Runs all programs of the folder `examples` and leaves their pictures and meshes in `gallery` in the target folder.
pub(crate) fn draw_all() -> TaskResult {
    let folder = target().join("gallery");
    let mut names: Vec<String> = fs::read_dir(workspace().join("examples/src/bin"))?
        .filter_map(|entry| Some(entry.ok()?.path().file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    for name in names {
        let mut example =
            cargo(&["run", "--release", "--quiet", "--package", "isochore-examples", "--bin", &name, "--"]);
        run(example.arg(&folder))?;
    }
    Ok(())
}
