//! Measurements side by side: everything that is compared runs in turn in one process, so that a slow moment of the machine
//! hits all alike, and the medians are compared.

#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

mod comparison;
mod memory;
mod python_peer;
mod scan;
mod surface_peer;

use std::time::Instant;

use cpu_time::ProcessTime;

pub use comparison::{Comparison, ROWS_VARIABLE};
pub use memory::peak_bytes;
pub use python_peer::{PythonPeer, scratch};
pub use scan::{crossing_scans, scan, scan_of_cube};
pub use surface_peer::give_mesh;

/// Rounds of every measurement, after one that warms up.
const ROUNDS: usize = 9;

/// Median seconds of each of the `jobs`, run in turn.
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

/// Seconds that all threads of this process have worked so far. Steadier than the clock on a machine that others use too.
///
/// # Panics
/// If the system does not tell.
pub fn cpu_seconds() -> f64 {
    ProcessTime::try_now().expect("the system counts").as_duration().as_secs_f64()
}

/// The middle one of these numbers.
///
/// # Panics
/// If there are none.
pub fn median(seconds: &mut [f64]) -> f64 {
    seconds.sort_unstable_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

/// Runs `work` on one thread that keeps to one core, as do the threads and programs that it starts, whatever the machine has.
///
/// # Panics
/// If the system refuses a thread.
pub fn on_one_core<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pin = |_| {
        // The first core has more to do for the system. Where cores cannot be chosen, one thread is all that can be had.
        if let Some(core) = core_affinity::get_core_ids().and_then(|cores| cores.last().copied()) {
            core_affinity::set_for_current(core);
        }
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).start_handler(pin).build();
    pool.expect("a thread can be started").install(work)
}

/// Prints a row of cells, each right-aligned in its column.
pub fn print_row<const N: usize>(cells: [&str; N]) {
    println!("{}", cells.map(|cell| format!("{cell:>18}")).join(" "));
}
