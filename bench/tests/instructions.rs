//! Regression test of hot loops: compares their instruction counts under Callgrind with
//! `bench/instructions.json`. The counts do not depend on the load of the machine.
//!
//! After an intended change or with a new compiler, `cargo xtask instructions` updates the counts.

#![allow(clippy::print_stderr, reason = "reports the differences")]

use std::{collections::BTreeMap, env, fs, ops::Range, path::Path, process::Command, sync::Arc};

use glam::{DVec3, Vec3};
use isochore_bench::{on_one_core, scan, scratch};
use isochore_curve::{FrameMethod, Spine, TrigonometricCurve, rotation_minimizing_frames};
use isochore_field::{Move, Pose, Profile, Stroke, Tool, advect_points};
use isochore_mesh::{
    Capsule, Distance, DistanceField, DistanceFieldOptions, NoProgress, Padding, SelfIntersections, io, primitives,
};
use isochore_sculpt::{
    Meshes,
    recipe::{self, Sphere, ToolShape},
    session::{InteractiveRefinement, Session, SessionOptions, SessionTool, StrokeOptions},
};
use serde::{Deserialize, Serialize};

/// Largest relative growth of a count. Larger: loops can become slower gradually. Smaller: other
/// versions of system libraries fail the test.
const TOLERANCE: f64 = 0.03;

/// The same for a compiler that differs from that of the counts, because another compiler changes
/// them.
const TOLERANCE_OF_COMPILER: f64 = 0.25;

/// Environment variable that requests an update of the counts.
const WRITE_VARIABLE: &str = "ISOCHORE_WRITE_INSTRUCTIONS";

/// The measured loops. Each is an ignored test in this file.
const LOOPS: [&str; 10] = [
    "distance_grid",
    "advect_analytic",
    "advect_sampled",
    "split",
    "self_intersection",
    "session_moves",
    "read_obj",
    "read_glb",
    "read_ply",
    "frames",
];

#[derive(Debug, Default, Serialize, Deserialize)]
struct Baseline {
    rustc: String,
    instructions: BTreeMap<String, u64>,
}

#[test]
fn no_loop_takes_more_instructions() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("instructions.json");
    let counted = Baseline {
        rustc: rustc(),
        instructions: LOOPS.iter().map(|&name| (name.to_owned(), instructions(name))).collect(),
    };
    if env::var_os(WRITE_VARIABLE).is_some() {
        let text = serde_json::to_string_pretty(&counted).expect("the counts can be serialized");
        return fs::write(path, text + "\n").expect("the folder can be written");
    }
    let text = fs::read_to_string(path).expect("bench/instructions.json can be read");
    let baseline: Baseline = serde_json::from_str(&text).expect("bench/instructions.json has the counts");
    let tolerance = if baseline.rustc == counted.rustc { TOLERANCE } else { TOLERANCE_OF_COMPILER };
    let mut slower = Vec::new();
    for (name, &count) in &counted.instructions {
        let before = *baseline.instructions.get(name).unwrap_or(&0);
        let growth = count as f64 / before as f64 - 1.0;
        eprintln!("{name}: {before} instructions before, {count} now, {:+.1} %", 100.0 * growth);
        if growth.is_nan() || growth > tolerance {
            slower.push(name);
        }
    }
    assert!(slower.is_empty(), "more instructions than in bench/instructions.json: {slower:?}");
}

/// Version of the compiler.
fn rustc() -> String {
    let output = Command::new("rustc").arg("--version").output().expect("rustc can be started");
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

/// Counts the instructions of one of the loops.
fn instructions(name: &str) -> u64 {
    let program = env::current_exe().expect("this program has a path");
    let mut valgrind = Command::new("valgrind");
    valgrind
        .args(["--tool=callgrind", "--toggle-collect=*guarded*", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(["--ignored", "--exact", name, "--test-threads=1"]);
    let output = valgrind.output().expect("valgrind can be started; install the package valgrind");
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {text}");
    let count = text.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok());
    count.unwrap_or_else(|| panic!("{name}: the output has no count: {text}"))
}

/// Runs `work`. Callgrind counts only instructions in this function.
#[inline(never)]
fn guarded<T>(work: impl FnOnce() -> T) {
    std::hint::black_box(work());
}

fn count<T>(work: impl FnOnce() -> T + Send) {
    on_one_core(|| guarded(work));
}

fn advect(tool: Arc<dyn Distance>) {
    let points = primitives::icosphere(1.0, 4).positions;
    let tool = Arc::new(Tool::new(tool, 0.3, Profile::Quintic).expect("a positive support"));
    let keys = vec![Pose::at(DVec3::new(0.0, 0.9, -0.2)), Pose::at(DVec3::new(0.0, 0.9, 0.2))];
    let stroke = Stroke::Move(Move::new(tool, keys, 0.125).expect("a valid path"));
    count(|| advect_points(&points, std::slice::from_ref(&stroke), &NoProgress));
}

#[test]
#[ignore = "run by `no_loop_takes_more_instructions` under Callgrind"]
fn distance_grid() {
    let mesh = scan(3);
    let options = DistanceFieldOptions { resolution: 24, ..DistanceFieldOptions::default() };
    count(|| DistanceField::new(&mesh, &options, &NoProgress));
}

#[test]
#[ignore = "run by `no_loop_takes_more_instructions` under Callgrind"]
fn advect_analytic() {
    advect(Arc::new(Capsule::new(0.15, 0.8).expect("a positive length")));
}

#[test]
#[ignore = "run by `no_loop_takes_more_instructions` under Callgrind"]
fn advect_sampled() {
    let mesh = primitives::icosphere(0.4, 2);
    let options =
        DistanceFieldOptions { resolution: 16, padding: Padding::Reach(0.3), ..DistanceFieldOptions::default() };
    advect(Arc::new(DistanceField::new(&mesh, &options, &NoProgress).expect("a valid mesh")));
}

#[test]
#[ignore = "run by `no_loop_takes_more_instructions` under Callgrind"]
fn split() {
    let mesh = scan(4);
    count(|| mesh.split_to_length(0.02, 1_000_000, &NoProgress));
}

#[test]
#[ignore = "run by `no_loop_takes_more_instructions` under Callgrind"]
fn self_intersection() {
    let mesh = scan(5);
    count(|| SelfIntersections::of(&mesh, &NoProgress));
}

/// Ten moves of a brush over a ball. Edges within its reach are split, collapsed and flipped.
#[test]
#[ignore = "run by `no_loop_takes_more_instructions` under Callgrind"]
fn session_moves() {
    let shape = ToolShape::Sphere(Sphere { radius: 0.15 });
    let brush = recipe::Tool { shape, support: 0.2, profile: recipe::Profile::Quintic, free_form: 0.0 };
    let brush = Arc::new(SessionTool::new("brush", brush, &Meshes::new(), &NoProgress).expect("a valid tool"));
    let refine = InteractiveRefinement { longest: Some(0.03), ..InteractiveRefinement::default() };
    let mut session = Session::open(primitives::icosphere(1.0, 5), SessionOptions::default()).expect("a valid mesh");
    session.begin_stroke(&brush, StrokeOptions { refine: Some(refine) }).expect("no open stroke");
    let mut inserted = 0;
    let mut run_moves = |moves: Range<u8>| {
        for step in moves.map(f64::from) {
            let pose = Pose::at(DVec3::new(0.01 * step, 0.0, 1.2 - 0.005 * step));
            inserted += session.move_to(&pose, step / 60.0).expect("a valid move").inserted_vertices;
        }
    };
    run_moves(0..10);
    count(|| run_moves(10..20));
    assert!(inserted > 100, "{inserted}");
}

/// Counts the instructions of reading a file with texture coordinates and normals.
fn read(name: &str) {
    let path = scratch().join(name);
    let mut mesh = scan(4);
    let normals: Vec<Vec3> = mesh.vertex_normals().into_iter().map(DVec3::as_vec3).collect();
    let corners = || mesh.triangles.iter().map(|triangle| triangle.map(|vertex| normals[vertex as usize]));
    mesh.corner.uvs = vec![corners().map(|corners| corners.map(Vec3::truncate)).collect()];
    mesh.corner.normals = corners().collect();
    io::write(&path, &mesh).expect("the scratch folder can be written");
    count(|| io::read(&path));
}

#[test]
#[ignore = "run by `no_loop_takes_more_instructions` under Callgrind"]
fn read_obj() {
    let path = scratch().join("instructions.obj");
    io::write(&path, &scan(4)).expect("the scratch folder can be written");
    count(|| io::read(&path));
}

#[test]
#[ignore = "run by `no_loop_takes_more_instructions` under Callgrind"]
fn read_glb() {
    read("instructions.glb");
}

#[test]
#[ignore = "run by `no_loop_takes_more_instructions` under Callgrind"]
fn read_ply() {
    read("instructions.ply");
}

#[test]
#[ignore = "run by `no_loop_takes_more_instructions` under Callgrind"]
fn frames() {
    let spine = Spine::sample(&TrigonometricCurve::torus_knot(), 10_000).expect("a regular curve");
    count(|| rotation_minimizing_frames(&spine, -DVec3::X, FrameMethod::DoubleReflection, Default::default()));
}
