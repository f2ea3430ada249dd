//! Invalid input: exit code 2, one line that names the input, and no output.

use std::{fs, io::Write};

use crate::folder::{Folder, PRESS, Run, TETRAHEDRON};

/// Runs `PRESS` with `from` replaced by `to`, in a folder with `files` and an old output. Expects
/// an error.
#[track_caller]
fn expect_rejected(from: &str, to: &str, files: &[(&str, &str)], parts: &[&str]) {
    assert!(PRESS.contains(from), "{from}");
    let folder = Folder::with(files);
    fs::write(folder.path("press.toml"), PRESS.replace(from, to)).unwrap();
    fs::write(folder.path("out.ply"), "old output").unwrap();
    let before = folder.contents();
    folder.run(&["run", "press.toml"]).expect_error(2, parts);
    assert_eq!(folder.contents(), before);
}

/// Runs `PRESS` with the target `name` that contains `text`. Expects an error.
#[track_caller]
fn expect_target_rejected(name: &str, text: &str, parts: &[&str]) {
    let mesh = format!("mesh = \"{name}\"");
    expect_rejected("shape = { kind = \"icosphere\", radius = 1.0, subdivisions = 3 }", &mesh, &[(name, text)], parts);
}

#[test]
fn rejects_missing_files() {
    Folder::with(&[]).run(&["run", "none.toml"]).expect_error(2, &["none.toml", "No such file"]);
    Folder::with(&[]).run(&["inspect", "none.obj"]).expect_error(2, &["none.obj", "No such file"]);
}

#[test]
fn rejects_invalid_meshes() {
    let target = "target.obj";
    expect_target_rejected(target, &TETRAHEDRON.replace("2 3 4", "2 3 9"), &[target, "line 8", "9", "out of range"]);
    expect_target_rejected(target, &TETRAHEDRON.replace("v 0 1 0", "v 0 nan 0"), &[target, "line 3", "nan"]);
    expect_target_rejected(target, "", &[target, "no triangles"]);
    expect_target_rejected(target, "v 0 0 0\nv 1 0 0\nv 0 1 0\n", &[target, "no triangles"]);
    expect_target_rejected("target.xyz", "", &["target.xyz", "supported are .obj"]);
    expect_target_rejected("target.glb", "glTF", &["target.glb"]);
}

#[test]
fn rejects_truncated_glb() {
    let folder = Folder::with(&[("press.toml", PRESS)]);
    folder.run(&["run", "press.toml", "--output", "whole.glb"]).expect(0);
    let whole = folder.read("whole.glb");
    for length in [0, 4, 11, 12, 20, 100, whole.len() / 2, whole.len() - 1] {
        fs::write(folder.path("cut.glb"), &whole[..length]).unwrap();
        folder.run(&["inspect", "cut.glb"]).expect_error(2, &["cut.glb"]);
    }
}

#[test]
fn rejects_invalid_recipes() {
    expect_rejected(
        "support = 0.3",
        "support = -0.3",
        &[],
        &["press.toml: line 8: tools.ball.support", "-0.3", "above 0"],
    );
    expect_rejected("support = 0.3", "suport = 0.3", &[], &["line 8: tools.ball.suport: unknown key", "`support`"]);
    expect_rejected("\"quintic\"", "\"quintik\"", &[], &["line 9: tools.ball.profile", "`quintik`", "`quintic`"]);
    expect_rejected("{ at = [0, 0, 1.8] }, ", "", &[], &["line 14: stroke.0.keys", "at least 2"]);
    expect_rejected("30.0]", "180.0]", &[], &["stroke.0.keys.1.rotate", "add a key between"]);
    expect_rejected("[0, 0, 1, 30.0]", "[0, 0, 0, 30.0]", &[], &["stroke.0.keys.1.rotate", "zero"]);
    let twist = "kind = \"twist\"\norigin = [0, 0, 0]\naxis = [0, 0, 0]\ndegrees_per_unit = 1\n";
    expect_rejected("[output]", &format!("[[stroke]]\n{twist}[output]"), &[], &["stroke.1.axis", "zero"]);
    expect_rejected("recipe = 1", "recipe = ", &[], &["press.toml: line 1: "]);
    expect_rejected("out.ply", "out.doc", &[], &["out.doc", "supported are .obj"]);
    expect_rejected("mesh = \"out.ply\"", "", &[], &["press.toml", "output.mesh", "--output"]);
    expect_rejected(
        "subdivisions = 3",
        "subdivisions = 14",
        &[],
        &["target.shape.subdivisions", "5368709120 triangles"],
    );
}

#[test]
fn rejects_invalid_masks() {
    let mask = "[mask]\nvertices = \"mask.csv\"\n[output]";
    let expect_weights_rejected =
        |text: &str, parts: &[&str]| expect_rejected("[output]", mask, &[("mask.csv", text)], parts);
    expect_weights_rejected("0\n1\n1.5\n", &["mask.csv: row 3: 1.5 is not a weight"]);
    expect_weights_rejected("weight\n0\nhalf\n", &["mask.csv: row 3, column 1: `half` is not a number"]);
    expect_weights_rejected("0\n1\n", &["press.toml: mask.vertices: 2 weights are given for 642 vertices"]);
    let target = "mesh = \"a.obj\"\n";
    let shape = "shape = { kind = \"icosphere\", radius = 1.0, subdivisions = 3 }";
    let masked = format!("{target}[mask]\nvertices = \"mask.csv\"");
    let expect_rows_rejected = |text: &str, parts: &[&str]| {
        expect_rejected(shape, &masked, &[("a.obj", TETRAHEDRON), ("mask.csv", text)], parts);
    };
    expect_rows_rejected(
        "0\n1\n0\n",
        &["mask.csv: row 3: this weight is the last: 3 weights for the 4 vertices of the target"],
    );
    expect_rows_rejected("0\n1\n0\n1\n0\n", &["mask.csv: row 5: this weight has no vertex"]);
}

#[test]
fn rejects_invalid_tool_meshes() {
    let tool = |resolution: u32| format!("{{ kind = \"mesh\", mesh = \"tool.obj\", resolution = {resolution} }}");
    let sphere = "{ kind = \"sphere\", radius = 0.4 }";
    let files = &[("tool.obj", TETRAHEDRON)];
    expect_rejected(sphere, &tool(1), files, &["line 7: tools.ball.shape.resolution", "is 1", "at least"]);
    expect_rejected(sphere, &tool(1024), files, &["tools.ball.shape", "bytes", "lower the resolution"]);
    let inside_out = TETRAHEDRON.replace("f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4", "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3");
    expect_rejected(sphere, &tool(16), &[("tool.obj", &inside_out)], &["tools.ball.shape", "inside out"]);
    expect_rejected("tool = \"ball\"", "tool = \"bell\"", &[], &["line 13: stroke.0.tool", "`bell`", "`ball`"]);
}

#[test]
fn rejects_a_volume_promise_for_an_open_target() {
    let open = TETRAHEDRON.replace("f 2 3 4\n", "");
    let mesh = "mesh = \"open.obj\"\n[promise]\nvolume = 0.1";
    let shape = "shape = { kind = \"icosphere\", radius = 1.0, subdivisions = 3 }";
    expect_rejected(
        shape,
        mesh,
        &[("open.obj", &open)],
        &["promise.volume", "no volume", "edge", "remove this promise"],
    );

    let sheet = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n";
    expect_rejected(shape, mesh, &[("open.obj", sheet)], &["promise.volume", "no volume", "it is zero"]);
}

#[test]
fn rejects_invalid_settings() {
    let folder = Folder::with(&[("press.toml", PRESS)]);
    let set = |setting: &str| folder.run(&["run", "press.toml", "--set", setting]);
    set("tools.ball.suport=1").expect_error(2, &["--set tools.ball.suport=1", "`support`"]);
    set("tools.ball.support").expect_error(2, &["KEY=VALUE"]);
    set("stroke.4.tool=ball").expect_error(2, &["stroke.4", "the list has 1"]);
}

#[test]
fn rejects_invalid_command_lines() {
    let folder = Folder::with(&[]);
    folder.run(&[]).expect_error(2, &["isochore --help"]);
    folder.run(&["run"]).expect_error(2, &["RECIPE"]);
    folder.run(&["dance"]).expect_error(2, &["dance"]);
    folder.run(&["run", "a.toml", "--fast"]).expect_error(2, &["--fast"]);
}

#[test]
fn rejects_invalid_numbers_of_options() {
    let folder = Folder::with(&[]);
    let run = |arguments: &str, error: &str| {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        folder.run(&arguments).expect_error(2, &[&format!("error: {error}\n")]);
    };
    let threads = "give a whole number, 1 or more; without this option, all cores are used";
    run("run a.toml --threads 0", &format!("--threads 0: {threads}"));
    run("--threads -1 inspect a.obj", &format!("--threads -1: {threads}"));
    run("run a.toml --threads=", &format!("--threads: {threads}"));
    let samples = "frames a.csv -o b.csv --method ph --samples-per-segment 0";
    run(samples, "--samples-per-segment 0: give a whole number, 1 or more");
    run("distance a.obj -o a.npy --resolution 2.5", "--resolution 2.5: give a whole number of cells, such as 64");
    run("distance a.obj -o a.npy --resolution 9 --padding nan", "--padding nan: give a finite length, 0 or more");
    run("frames a.csv -o b.csv --r0 1,0", "--r0 1,0: give three numbers, such as 0,0,1");
    run("frames a.csv -o b.csv --twist half", "--twist half: give none, minimal or a whole number of turns");
}

#[test]
fn rejects_invalid_distance_grids() {
    let folder = Folder::with(&[("a.obj", TETRAHEDRON)]);
    let before = folder.contents();
    let distance = |arguments: &[&str]| folder.run(&[&["distance", "a.obj"], arguments].concat());
    distance(&["--resolution", "1", "--output", "a.npy"]).expect_error(2, &["a.obj", "resolution of 1"]);
    distance(&["--resolution", "1500", "--output", "a.npy"])
        .expect_error(2, &["a.obj", "bytes", "lower the resolution"]);
    distance(&["--resolution", "16", "--padding", "-1", "--output", "a.npy"])
        .expect_error(2, &["--padding -1", "0 or more"]);
    distance(&["--resolution", "16", "--output", "a.txt"]).expect_error(2, &["a.txt", ".npy"]);
    distance(&["--resolution", "16", "--output", "none/a.npy"]).expect_error(2, &["none", "does not exist"]);
    assert_eq!(folder.contents(), before);
}

#[test]
fn rejects_unusable_output_paths() {
    let folder = Folder::with(&[("press.toml", PRESS)]);
    fs::create_dir(folder.path("taken.ply")).unwrap();
    let before = folder.contents();
    let run = |arguments: &[&str]| folder.run(&[&["run", "press.toml"], arguments].concat());
    run(&["--output", "none/out.ply"]).expect_error(2, &["none", "does not exist"]);
    run(&["--report", "none/report.json"]).expect_error(2, &["none", "does not exist"]);
    run(&["--output", "taken.ply"]).expect_error(2, &["taken.ply", "not a regular file"]);
    run(&["--report", "out.ply"]).expect_error(2, &["out.ply", "two outputs"]);
    assert_eq!(folder.contents(), before);
}

#[test]
fn prints_errors_as_json() {
    let folder = Folder::with(&[("press.toml", &PRESS.replace("support = 0.3", "support = 0"))]);
    let run = folder.run(&["run", "press.toml", "--json"]).expect(2);
    assert_eq!(run.stdout, "");
    let error: serde_json::Value = serde_json::from_str(&run.stderr).unwrap();
    assert_eq!(error["file"], "press.toml");
    assert_eq!(error["line"], 8);
    assert_eq!(error["key"], "tools.ball.support");
    assert!(error["error"].as_str().unwrap().contains("above 0"));
    let settings = ["--set", "tools.ball.support=1", "--set", "integrate.step=1e-300"];
    let run = folder.run(&[&["run", "press.toml", "--json"], &settings[..]].concat()).expect(2);
    assert_eq!(serde_json::from_str::<serde_json::Value>(&run.stderr).unwrap()["key"], "stroke.0");
    let run = folder.run(&["--json", "dance"]).expect(2);
    assert!(
        serde_json::from_str::<serde_json::Value>(&run.stderr).unwrap()["error"].as_str().unwrap().contains("dance")
    );
}

/// A limit on the size of files makes writing fail partway, as a full disk does.
#[test]
#[cfg(unix)]
fn restores_outputs_at_a_file_size_limit() {
    let folder = Folder::with(&[("press.toml", PRESS), ("out.ply", "old output")]);
    let before = folder.contents();
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$0\" run press.toml";
    let shell = std::process::Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_isochore")])
        .current_dir(folder.path(""))
        .output();
    Run::of(shell.unwrap()).expect_error(2, &["out.ply", "too large"]);
    assert_eq!(folder.contents(), before);
}

#[test]
#[cfg(target_os = "linux")]
fn restores_outputs_on_a_full_disk() {
    use std::process::Command;
    let folder = Folder::with(&[("press.toml", PRESS)]);
    let disk = folder.path("disk");
    fs::create_dir(&disk).unwrap();
    let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"]).arg(&disk).output();
    if !mount.is_ok_and(|output| output.status.success()) {
        // The test with a limit on file size covers the same code.
        let _ = writeln!(std::io::stderr(), "skipped: mounting a small disk is not permitted");
        return;
    }
    fs::write(disk.join("out.obj"), "old output").unwrap();
    let before = folder.contents();
    let run = folder.run(&["run", "press.toml", "--output", "disk/out.obj"]);
    let after = folder.contents();
    let unmount = Command::new("umount").arg(&disk).status().unwrap();
    run.expect_error(2, &["disk/out.obj", "No space left"]);
    assert_eq!(after, before);
    assert!(unmount.success());
}
