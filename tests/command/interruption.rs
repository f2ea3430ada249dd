//! Tests of interrupts.

use std::{
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use crate::folder::{Folder, PRESS, Run};

/// The command stops within one second. The rest allows for a machine that is busy with other tests.
const PROMPT: Duration = Duration::from_millis(2500);

#[test]
#[cfg(unix)]
fn stops_within_a_second_without_outputs() {
    // The small steps and the fine mesh would take minutes.
    let recipe =
        PRESS.replace("subdivisions = 3", "subdivisions = 7").replace("[output]", "[integrate]\nstep = 1e-5\n[output]");
    let folder = Folder::with(&[("press.toml", &recipe), ("out.ply", "old output")]);
    let before = folder.contents();
    for signal in ["-INT", "-TERM"] {
        let mut command = folder.command(&["run", "press.toml"]);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        thread::sleep(Duration::from_millis(1500));
        assert_ne!(folder.contents(), before, "the work has begun");
        let start = Instant::now();
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        let run = Run::of(child.wait_with_output().unwrap());
        assert!(start.elapsed() < PROMPT, "{:?}", start.elapsed());
        run.expect_error(130, &["interrupted", "nothing was written"]);
        assert_eq!(folder.contents(), before);
    }
}
