//! Startup time and size of the command: inspecting a small mesh, compared with a program that does
//! nothing.

#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

use std::path::Path;
use std::process::{Command, Stdio};

use isochore_bench::{Comparison, interleaved_medians, on_one_core, scratch};
use isochore_mesh::{io, primitives};

/// Runs per round. A single run is too short to measure.
const RUNS: usize = 20;

fn main() {
    let command = std::env::current_exe().expect("this program has a path").with_file_name("isochore");
    let size =
        command.metadata().expect("cargo build --release builds the command into the folder of this program").len();
    println!("size of the command: {:.1} MB", 1e-6 * size as f64);
    on_one_core(|| compare(&command));
}

fn compare(command: &Path) {
    let mesh = primitives::latitude_longitude_sphere(1.0, 22, 24);
    let path = scratch().join("start.obj");
    io::write(&path, &mesh).expect("the scratch folder can be written");
    let run = |mut command: Command| {
        let status = command.stdout(Stdio::null()).stderr(Stdio::null()).status();
        assert!(status.is_ok_and(|status| status.success()), "{command:?}");
    };
    let inspect = || {
        for _ in 0..RUNS {
            let mut inspect = Command::new(command);
            inspect.arg("inspect").arg(&path);
            run(inspect);
        }
    };
    let nothing = || (0..RUNS).for_each(|_| run(Command::new("true")));
    let [ours, theirs] = interleaved_medians(&mut [&mut { inspect }, &mut { nothing }])[..] else { return };
    Comparison::print_heading();
    Comparison {
        job: format!("`isochore inspect` of {} triangles, whole process", mesh.triangles.len()),
        peer: "`true` (does nothing)".into(),
        unit: "ms".into(),
        ours: 1e3 * ours / RUNS as f64,
        theirs: 1e3 * theirs / RUNS as f64,
        accuracy: String::new(),
    }
    .report();
}
