//! Advection of points by rigid tools with Runge-Kutta steps, on one core.

#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

mod frames;
mod race;
mod touched_part;

use isochore_bench::on_one_core;

fn main() {
    on_one_core(|| {
        frames::run();
        race::run();
        touched_part::run();
    });
    race::on_two_cores();
}
