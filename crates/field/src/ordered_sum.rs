//! Sums in parallel whose bits do not depend on the number of threads.

use rayon::prelude::*;

/// Terms that one task sums. The partition is fixed, so that the rounding is.
const CHUNK: usize = 4096;

/// Sums N columns of `count` rows, each with Neumaier's compensation: the error stays near one rounding of the result however
/// many terms there are.
pub(crate) fn ordered_sum<const N: usize>(count: usize, row: impl Fn(usize) -> [f64; N] + Sync) -> [f64; N] {
    let chunks: Vec<Compensated<N>> = (0..count.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut sum = Compensated::ZERO;
            for index in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                sum.add(row(index));
            }
            sum
        })
        .collect();
    let mut total = Compensated::ZERO;
    for chunk in chunks {
        total.add(chunk.sum);
        total.add(chunk.rest);
    }
    total.value()
}

#[derive(Clone, Copy)]
struct Compensated<const N: usize> {
    sum: [f64; N],
    rest: [f64; N],
}

impl<const N: usize> Compensated<N> {
    const ZERO: Self = Self { sum: [0.0; N], rest: [0.0; N] };

    fn add(&mut self, terms: [f64; N]) {
        for column in 0..N {
            let (sum, term) = (self.sum[column], terms[column]);
            let next = sum + term;
            self.rest[column] +=
                if sum.abs() >= term.abs() { (sum - next) + term } else { (term - next) + sum };
            self.sum[column] = next;
        }
    }

    fn value(&self) -> [f64; N] {
        std::array::from_fn(|column| self.sum[column] + self.rest[column])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cancelling_terms_leave_the_small_ones() {
        let terms = |index: usize| [[1e16, 1.0, -1e16, 0.5][index % 4]];
        let [sum] = ordered_sum(40_000, terms);
        assert_eq!(sum, 15_000.0);
    }

    #[test]
    fn threads_do_not_change_the_bits() {
        let sum = || ordered_sum(100_001, |index| [libm::sin(index as f64), 1.0 / (1.0 + index as f64)]);
        let threads = |count| rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        assert_eq!(threads(1).install(sum).map(f64::to_bits), threads(8).install(sum).map(f64::to_bits));
    }
}
