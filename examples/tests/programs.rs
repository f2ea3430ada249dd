//! Runs the small example programs and checks what they print and write.

use std::{path::Path, process::Command};

/// Runs a program in a temporary folder. Expects all of `parts` in its output and all of `files` in
/// the folder.
#[track_caller]
fn run(program: &str, parts: &[&str], files: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(program).arg(folder.path()).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    for part in parts {
        assert!(text.contains(part), "`{part}` is missing in {text}");
    }
    for file in files {
        assert!(exists(folder.path(), file), "{file} is missing");
    }
    text
}

fn exists(folder: &Path, file: &str) -> bool {
    folder.join(file).metadata().is_ok_and(|metadata| metadata.len() > 0)
}

/// The number that follows `label`.
#[track_caller]
fn number(text: &str, label: &str) -> f64 {
    let rest = text.split_once(label).unwrap_or_else(|| panic!("`{label}` is missing in {text}")).1;
    let number = rest.split_whitespace().next().unwrap_or_default().trim_end_matches(',');
    number.parse().unwrap_or_else(|_| panic!("`{number}` is not a number"))
}

#[test]
fn press_a_tool() {
    let files = ["press_a_tool.obj", "press_a_tool.png"];
    let text = run(env!("CARGO_BIN_EXE_press_a_tool"), &["triangles: 20480 before"], &files);
    assert!(number(&text, "change of volume: ").abs() < 1e-9);
    assert!(number(&text, "by at most ") > 0.1);
}

#[test]
fn run_a_session() {
    let parts = ["stroke 1, frame 5", "undo and redo restore every bit: true"];
    run(env!("CARGO_BIN_EXE_run_a_session"), &parts, &["run_a_session.obj", "run_a_session.toml"]);
}

#[test]
fn custom_field() {
    let text = run(env!("CARGO_BIN_EXE_custom_field"), &[], &["custom_field.obj"]);
    assert!(number(&text, "net flux through a sphere: ") < 1e-4);
    for label in ["between ", " and "] {
        assert!((number(&text, label) - 1.0).abs() < 1e-3);
    }
    assert!(number(&text, "change of volume: ").abs() < 1e-3);
}

#[test]
fn build_a_recipe() {
    let kept = "\"no_new_self_intersections\": true";
    run(
        env!("CARGO_BIN_EXE_build_a_recipe"),
        &["move: ", "twist: ", kept],
        &["build_a_recipe.obj", "build_a_recipe.toml"],
    );
}

#[test]
fn mask_and_mirror() {
    let text = run(env!("CARGO_BIN_EXE_mask_and_mirror"), &["of these moved: 0"], &["mask_and_mirror.obj"]);
    assert!(number(&text, "pinned vertices: ") > 0.0);
    assert!(number(&text, "mirror symmetry: ") < 1e-12);
    assert!(number(&text, "change of volume: ").abs() < 1e-9);
}

#[test]
fn frames_along_a_curve() {
    let text = run(env!("CARGO_BIN_EXE_frames_along_a_curve"), &[], &["frames_along_a_curve.obj"]);
    assert!((number(&text, "256 segments: error ") - 2.03e-5).abs() < 0.01e-5, "published by Wang et al. 2008");
    let order = text.lines().find(|line| line.starts_with("512")).map(|line| number(line, "order "));
    assert!((order.unwrap() - 4.0).abs() < 0.05);
    assert!(number(&text, "rad before, ") < 1e-12);
}
