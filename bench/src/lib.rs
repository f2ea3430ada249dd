//! Support for benchmarks. All jobs of a comparison run alternately in one process, so that a slow
//! moment of the machine affects all of them. The medians are compared.

#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

mod clay;
mod comparison;
mod memory;
mod python_peer;
mod scan;
mod surface_peer;

use std::time::Instant;

use cpu_time::ProcessTime;

pub use clay::{ClayStroke, TARGET, clay_recipe, many_pushes};
pub use comparison::{Comparison, ROWS_VARIABLE};
pub use memory::peak_bytes;
pub use python_peer::{PythonPeer, scratch};
pub use scan::{intersecting_scans, scan, scan_of_cube};
pub use surface_peer::load_mesh;

/// Rounds of every measurement, after one warm-up round.
const ROUNDS: usize = 9;

/// Runs the `jobs` alternately and returns the median wall time of each, in seconds.
pub fn interleaved_medians(jobs: &mut [&mut dyn FnMut()]) -> Vec<f64> {
    let mut seconds = vec![Vec::with_capacity(ROUNDS); jobs.len()];
    for round in 0..=ROUNDS {
        for (job, seconds) in jobs.iter_mut().zip(&mut seconds) {
            let begin = Instant::now();
            job();
            if round > 0 {
                seconds.push(begin.elapsed().as_secs_f64());
            }
        }
    }
    seconds.iter_mut().map(|seconds| median(seconds)).collect()
}

/// CPU time of all threads of this process so far, in seconds. On a busy machine, it varies less
/// than wall time.
///
/// # Panics
/// If the system does not report the CPU time.
pub fn cpu_seconds() -> f64 {
    ProcessTime::try_now().expect("the system reports CPU times").as_duration().as_secs_f64()
}

/// Median of `values`, which are sorted.
///
/// # Panics
/// If `values` is empty.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Runs `work` on one thread that is pinned to one core. The threads and processes that it starts
/// inherit the core.
///
/// # Panics
/// If a thread cannot be started.
pub fn on_one_core<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pin = |_| {
        // Use the last core, because the first handles more system work. If cores cannot be chosen,
        // the pool still has only one thread.
        if let Some(core) = core_affinity::get_core_ids().and_then(|cores| cores.last().copied()) {
            core_affinity::set_for_current(core);
        }
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).start_handler(pin).build();
    pool.expect("a thread can be started").install(work)
}

/// `count` with its digits in groups of three, separated by commas.
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let (first, rest) = digits.split_at((digits.len() - 1) % 3 + 1);
    rest.as_bytes().chunks(3).fold(first.to_owned(), |text, group| text + "," + &String::from_utf8_lossy(group))
}

/// Prints a row of right-aligned cells.
pub fn print_row<const N: usize>(cells: [&str; N]) {
    println!("{}", cells.map(|cell| format!("{cell:>18}")).join(" "));
}

#[test]
fn digits_are_grouped_by_three() {
    assert_eq!([0, 999, 1000, 560_002, 11_000_000].map(grouped), ["0", "999", "1,000", "560,002", "11,000,000"]);
}
