//! Results of valid input.

use std::fs;
use std::process::Command;

use serde_json::Value;

use crate::folder::{Folder, PRESS, Run, TETRAHEDRON};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

#[test]
fn writes_all_requested_outputs() {
    let outputs = "preview = \"out.png\"\nframes = { count = 3, directory = \"frames\" }\nreport = \"report.json\"\n";
    let folder = Folder::with(&[("press.toml", &format!("{PRESS}{outputs}"))]);
    let run = folder.run(&["run", "press.toml"]).expect(0);
    assert_eq!(run.stdout, "");
    let names: Vec<String> = folder.contents().into_keys().collect();
    let frames = ["frames/", "frames/frame_0000.ply", "frames/frame_0001.ply", "frames/frame_0002.ply"];
    assert_eq!(names, [&frames[..], &["out.ply", "out.png", "press.toml", "report.json"]].concat());
    assert!(folder.read("out.png").starts_with(b"\x89PNG"));
    assert_eq!(folder.read("frames/frame_0002.ply"), folder.read("out.ply"), "the last frame is the result");
    assert_ne!(folder.read("frames/frame_0001.ply"), folder.read("out.ply"));

    let report = folder.json("report.json");
    for side in ["before", "after"] {
        for key in [
            "vertices",
            "triangles",
            "closed",
            "volume",
            "area",
            "bounds",
            "self_intersecting_triangles",
            "self_intersecting_area",
            "angle_below_5_degrees",
        ] {
            assert!(!report[side][key].is_null(), "{side}.{key}");
        }
    }
    // The lock leaves rounding errors: a few hundred ulps of a sum over thousands of triangles.
    assert!(number(&report["volume_change"]).abs() <= 1e-12, "{}", report["volume_change"]);
    assert!(number(&report["volume_change_before_lock"]).abs() > 1e-9);
    assert!(number(&report["lock_max_shift"]) > 0.0);
    assert!(number(&report["moved_vertices"]) > 0.0 && number(&report["max_displacement"]) > 0.1);
    assert_eq!(number(&report["inserted_vertices"]), number(&report["after"]["vertices"]) - 642.0);
    assert_eq!(report["promises"], kept_promises());
    assert_eq!(number(&report["certificate"]["new_crossings"]), 0.0);
    assert_eq!(number(&report["certificate"]["after_rounding"]), 0.0);
    assert!(number(&report["certificate"]["pairs_tested"]) > 1000.0);
    assert_eq!(report["strokes"][0]["kind"], "move");
    for key in ["seconds", "evaluations", "moved", "inserted", "volume_change"] {
        assert!(report["strokes"][0][key].is_number(), "{key}");
    }
    for key in ["read", "distance", "advect", "refine", "lock", "check", "write"] {
        assert!(report["seconds"][key].is_number(), "{key}");
    }
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(report["recipe_sha256"].as_str().unwrap().len(), 64);
}

#[test]
fn a_broken_promise_exits_with_1_and_writes_the_output() {
    let recipe = format!("{PRESS}[promise]\nvolume = 1e-9\n[volume]\nlock = false\n[refine]\nenabled = false\n");
    let folder = Folder::with(&[("press.toml", &recipe)]);
    let run = folder.run(&["run", "press.toml", "--report", "report.json", "--quiet"]).expect(1);
    assert_eq!(
        run.stderr.lines().filter(|line| line.starts_with("promise missed: volume")).count(),
        1,
        "{}",
        run.stderr
    );
    assert!(folder.path("out.ply").exists());
    let report = folder.json("report.json");
    assert_eq!(report["promises"]["volume"], false);
    assert!(number(&report["volume_change"]).abs() > 1e-9);
    assert!(report["lock_max_shift"].is_null());

    folder.run(&["run", "press.toml", "--report", "report.json", "--set", "promise.volume=0.1"]).expect(0);
    let report = folder.json("report.json");
    assert_eq!(report["promises"]["volume"], true);
    assert_eq!(report["overrides"][0], "promise.volume=0.1");
}

#[test]
fn output_does_not_depend_on_the_number_of_threads() {
    let recipe = PRESS.replace("subdivisions = 3", "subdivisions = 4");
    let folder = Folder::with(&[("press.toml", &recipe), ("king.obj", TETRAHEDRON)]);
    let king =
        "tools.ball.shape={ kind = \"mesh\", mesh = \"king.obj\", resolution = 24, transform = { scale = 0.8 } }";
    for (shape, output) in [(king, "a.obj"), (king, "a.glb"), ("tools.ball.support=0.3", "a.stl")] {
        let bytes = ["1", "2", "8", "8"].map(|threads| {
            let preview = "output.preview=a.png";
            let arguments =
                ["run", "press.toml", "--threads", threads, "--output", output, "--set", shape, "--set", preview];
            folder.run(&arguments).expect(0);
            (folder.read(output), folder.read("a.png"))
        });
        assert!(bytes.iter().all(|other| *other == bytes[0]), "{output}");
    }
}

#[test]
fn output_does_not_depend_on_the_vector_width() {
    let folder = Folder::with(&[("press.toml", PRESS), ("king.obj", TETRAHEDRON)]);
    let king =
        "tools.ball.shape={ kind = \"mesh\", mesh = \"king.obj\", resolution = 24, transform = { scale = 0.8 } }";
    for shape in [king, "tools.ball.support=0.3"] {
        let arguments = ["run", "press.toml", "--output", "out.ply", "--set", shape];
        folder.run(&arguments).expect(0);
        let wide = folder.read("out.ply");
        // Valgrind emulates a processor without 512-bit registers.
        let command = folder.command(&arguments);
        let mut valgrind = Command::new("valgrind");
        valgrind.current_dir(folder.path("")).args(["--tool=none", "--quiet"]);
        valgrind.arg(command.get_program()).args(command.get_args());
        Run::of(valgrind.output().expect("the package valgrind is installed")).expect(0);
        assert!(folder.read("out.ply") == wide, "{shape}");
    }
}

#[test]
fn warns_about_open_tool_meshes() {
    let open = TETRAHEDRON.replace("f 2 3 4\n", "");
    let folder = Folder::with(&[("press.toml", PRESS), ("open.obj", &open)]);
    let shape = "tools.ball.shape={ kind = \"mesh\", mesh = \"open.obj\", resolution = 40 }";
    let run = folder.run(&["run", "press.toml", "--set", shape]).expect(0);
    assert!(run.stderr.contains("warning: tools.ball.shape.mesh: the mesh is open"), "{}", run.stderr);
    assert!(folder.path("out.ply").exists());

    let run = folder.run(&["run", "press.toml", "--set", shape, "--json"]).expect(0);
    let warning: Value = serde_json::from_str(&run.stderr).unwrap();
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    assert!(warning["warning"].as_str().unwrap().contains("the mesh is open"));
    assert_eq!(report["warnings"][0], warning["warning"]);
}

#[test]
fn reports_no_volume_for_open_targets() {
    let open = TETRAHEDRON.replace("f 2 3 4\n", "");
    let folder = Folder::with(&[("press.toml", PRESS), ("open.obj", &open)]);
    let target = "target={ mesh = \"open.obj\" }";
    let run = folder.run(&["run", "press.toml", "--set", target, "--report", "report.json"]).expect(0);
    assert!(run.stderr.contains("the lock was skipped"), "{}", run.stderr);
    let report = folder.json("report.json");
    for value in [&report["before"]["volume"], &report["volume_change"], &report["lock_max_shift"]] {
        assert!(value.is_null());
    }
    assert_eq!(report["after"]["closed"], false);
}

#[test]
fn warns_when_it_refines_a_coarse_tool_grid() {
    let folder = Folder::with(&[("press.toml", PRESS), ("king.obj", TETRAHEDRON)]);
    let shape = "tools.ball.shape={ kind = \"mesh\", mesh = \"king.obj\", resolution = 8 }";
    let run = folder.run(&["run", "press.toml", "--set", shape]).expect(0);
    // Ten cells across a support of 0.3, for a mesh of side 1.
    assert!(run.stderr.contains("raised from 8 to 34"), "{}", run.stderr);
}

#[test]
fn json_prints_the_report() {
    let folder = Folder::with(&[("press.toml", PRESS)]);
    let run = folder.run(&["run", "press.toml", "--report", "report.json", "--json"]).expect(0);
    assert_eq!(serde_json::from_str::<Value>(&run.stdout).unwrap(), folder.json("report.json"));
}

#[test]
fn json_recipes_give_the_same_result() {
    let folder = Folder::with(&[("press.toml", PRESS)]);
    folder.run(&["run", "press.toml"]).expect(0);
    let toml = folder.read("out.ply");
    let json = serde_json::json!({
        "recipe": 1,
        "target": { "shape": { "kind": "icosphere", "radius": 1.0, "subdivisions": 3 } },
        "tools": { "ball": { "shape": { "kind": "sphere", "radius": 0.4 }, "support": 0.3, "profile": "quintic" } },
        "stroke": [{
            "kind": "move",
            "tool": "ball",
            "keys": [{ "at": [0, 0, 1.8] }, { "at": [0, 0, 1.1], "rotate": [0, 0, 1, 30.0] }],
        }],
        "output": { "mesh": "out.ply" },
    });
    fs::write(folder.path("press.json"), json.to_string()).unwrap();
    folder.run(&["run", "press.json"]).expect(0);
    assert_eq!(folder.read("out.ply"), toml);
}

#[test]
fn reads_spines_from_files() {
    let strip = "kind = \"strip\"\nmode = \"along\"\nradius = 0.2\nsupport = 0.3\ndistance = 0.1\n";
    let recipe = |spine: &str| PRESS.replace("[output]", &format!("[[stroke]]\n{strip}spine = {spine}\n\n[output]"));
    let folder = Folder::with(&[
        ("listed.toml", &recipe("[[-1.5, 0, 0.8], [0, 0.1, 0.8], [1.5, 0, 0.8]]")),
        ("named.toml", &recipe("\"spine.csv\"")),
        ("spine.csv", "x,y,z\n-1.5,0,0.8\n0,0.1,0.8\n1.5,0,0.8\n"),
    ]);
    folder.run(&["run", "listed.toml"]).expect(0);
    let listed = folder.read("out.ply");
    folder.run(&["run", "named.toml"]).expect(0);
    assert_eq!(folder.read("out.ply"), listed);
    fs::write(folder.path("spine.csv"), "0,0,0\n1,0,nan\n").unwrap();
    folder.run(&["run", "named.toml"]).expect_error(2, &["spine.csv: row 2, column 3: NaN is not a finite number"]);
    fs::remove_file(folder.path("spine.csv")).unwrap();
    folder.run(&["run", "named.toml"]).expect_error(2, &["spine.csv"]);
}

#[test]
fn vertices_outside_the_support_keep_their_bits() {
    let folder = Folder::with(&[
        ("press.toml", PRESS),
        ("far.obj", &TETRAHEDRON.replace("v 0", "v 50.1").replace("v 1", "v 51")),
    ]);
    let target = "target={ mesh = \"far.obj\" }";
    folder.run(&["run", "press.toml", "--set", target, "--output", "still.obj", "--report", "report.json"]).expect(0);
    assert_eq!(folder.json("report.json")["moved_vertices"], 0);
    let positions = |name: &str| {
        let text = String::from_utf8(folder.read(name)).unwrap();
        let lines = text.lines().filter_map(|line| line.strip_prefix("v ").map(str::to_owned));
        let numbers = |line: String| line.split(' ').map(|word| word.parse().unwrap()).collect::<Vec<f64>>();
        lines.map(numbers).collect::<Vec<_>>()
    };
    assert_eq!(positions("still.obj"), positions("far.obj"));
}

#[test]
fn inspect_prints_all_statistics() {
    let folder = Folder::with(&[("a.obj", TETRAHEDRON), ("open.obj", &TETRAHEDRON.replace("f 2 3 4\n", ""))]);
    let facts: Value = serde_json::from_str(&folder.run(&["inspect", "a.obj", "--json"]).expect(0).stdout).unwrap();
    let names = [
        "vertices",
        "triangles",
        "components",
        "closed",
        "oriented",
        "volume",
        "area",
        "bounds",
        "boundary_edges",
        "degenerate_triangles",
        "self_intersecting_triangles",
    ];
    let mut found: Vec<&String> = facts.as_object().unwrap().keys().collect();
    found.sort();
    let mut expected = names;
    expected.sort_unstable();
    assert_eq!(found, expected);
    assert_eq!(facts["vertices"], 4);
    // Exact except for the rounding of a sum of four terms.
    assert!((number(&facts["volume"]) - 1.0 / 6.0).abs() < 1e-15);
    assert!((number(&facts["area"]) - (1.5 + 0.75_f64.sqrt())).abs() < 1e-14);
    let open: Value = serde_json::from_str(&folder.run(&["inspect", "open.obj", "--json"]).expect(0).stdout).unwrap();
    assert_eq!((&open["closed"], &open["boundary_edges"]), (&Value::from(false), &Value::from(3)));
    assert!(open["volume"].is_null());
    let text = folder.run(&["inspect", "open.obj"]).expect(0).stdout;
    assert_eq!(text.lines().count(), names.len(), "{text}");
}

#[test]
fn distance_writes_an_array_and_its_metadata() {
    let folder = Folder::with(&[("a.obj", TETRAHEDRON)]);
    folder.run(&["distance", "a.obj", "--resolution", "10", "--output", "a.npy"]).expect(0);
    let metadata = folder.json("a.json");
    assert_eq!(
        metadata["dims"],
        serde_json::json!([15, 15, 15]),
        "10 cells, 2 cells of padding on each side, and one more sample than cells"
    );
    assert_eq!(number(&metadata["cell"]), 0.1);
    let bytes = folder.read("a.npy");
    assert!(bytes.starts_with(b"\x93NUMPY"));
    let header = String::from_utf8_lossy(&bytes[10..118]).into_owned();
    assert!(header.contains("'<f4'") && header.contains("(15, 15, 15") && header.contains("False"), "{header}");
    let samples: Vec<f32> =
        bytes[bytes.len() - 4 * 15 * 15 * 15..].chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    let origin = number(&metadata["origin"][2]);
    let bound = number(&metadata["error_bound"]);
    // Below the face z = 0 the distance is the height. The sample [z, y, x] = [0, 4, 4] is below
    // the center of that face.
    let sample = f64::from(samples[4 * 15 + 4]);
    assert!((sample + origin).abs() <= bound, "{sample} at height {origin}, to {bound}");
    assert!(samples[(5 * 15 + 3) * 15 + 3] < 0.0, "inside");
}

#[test]
fn schema_is_json() {
    for document in ["recipe", "report"] {
        let run = Folder::with(&[]).run(&["schema", document]).expect(0);
        assert_eq!(serde_json::from_str::<Value>(&run.stdout).unwrap()["type"], "object");
    }
}

#[test]
fn demo_writes_a_recipe_that_runs_again() {
    let folder = Folder::with(&[]);
    let run = folder.run(&["demo"]).expect(0);
    assert!(run.stdout.is_empty() && run.stderr.lines().count() <= 8, "{run:?}");
    let report = folder.json("isochore-demo/report.json");
    let mut kept = kept_promises();
    kept["volume"] = true.into();
    assert_eq!(report["promises"], kept);
    assert!(number(&report["max_displacement"]) > 0.1);
    let before = folder.contents();
    assert!(before.keys().any(|name| name.ends_with(".png")));
    folder.run(&["run", "isochore-demo/press.toml"]).expect(0);
    let mut after = folder.contents();
    // Only the timings in the report differ.
    after.insert("isochore-demo/report.json".to_owned(), before["isochore-demo/report.json"].clone());
    assert_eq!(after, before);
}

/// The promises that every recipe makes by default, all kept.
fn kept_promises() -> Value {
    serde_json::json!({
        "no_new_self_intersections": true,
        "positive_jacobian": true,
        "lock_within_half_edge": true,
        "strokes_completed": true,
    })
}
