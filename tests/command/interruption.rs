//! Tests of interrupts.

use std::{
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use crate::folder::{Folder, PRESS, Run};

#[test]
#[cfg(unix)]
fn stops_early_without_outputs() {
    // The small steps and the fine mesh take minutes if nothing stops the command.
    let recipe =
        PRESS.replace("subdivisions = 3", "subdivisions = 7").replace("[output]", "[integrate]\nstep = 1e-5\n[output]");
    let folder = Folder::with(&[("press.toml", &recipe), ("out.ply", "old output")]);
    let before = folder.contents();
    for signal in ["-INT", "-TERM"] {
        let mut command = folder.command(&["run", "press.toml"]);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        while folder.contents() == before {
            assert!(child.try_wait().unwrap().is_none(), "the command ended before the work began");
            thread::sleep(Duration::from_millis(10));
        }
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        let run = Run::of(child.wait_with_output().unwrap());
        run.expect_error(130, &["interrupted", "nothing was written"]);
        assert_eq!(folder.contents(), before);
    }
}
