//! Compensated summation (Neumaier, "Rundungsfehleranalyse einiger Verfahren zur Summation
//! endlicher Summen", 1974).

use rayon::prelude::*;

/// A running sum with its accumulated rounding error.
///
/// ```
/// use isochore_mesh::CompensatedSum;
///
/// let mut sum = CompensatedSum::default();
/// [1.0, 1e100, -1e100].into_iter().for_each(|value| sum.add(value));
/// assert_eq!(sum.value(), 1.0);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CompensatedSum {
    sum: f64,
    lost: f64,
}

impl CompensatedSum {
    /// Adds `value`.
    #[inline(always)]
    pub fn add(&mut self, value: f64) {
        let sum = self.sum + value;
        // Exact rounding error of the addition, whichever operand is larger (Knuth's TwoSum).
        let from_value = sum - self.sum;
        self.lost += (self.sum - (sum - from_value)) + (value - from_value);
        self.sum = sum;
    }

    /// The sum of all added values.
    pub fn value(self) -> f64 {
        // After overflow the error term is NaN, while the sum itself is infinite.
        if self.sum.is_finite() { self.sum + self.lost } else { self.sum }
    }

    fn merge(&mut self, other: Self) {
        self.add(other.sum);
        self.lost += other.lost;
    }
}

/// Terms per chunk. A different value changes the last bits of long sums.
const CHUNK: usize = 4096;

/// Sums `N` series of `count` terms in parallel. The bits do not depend on the number of threads.
///
/// ```
/// let [count, sum] = isochore_mesh::sum_terms(101, |index| [1.0, index as f64]);
/// assert_eq!([count, sum], [101.0, 5050.0]);
/// ```
pub fn sum_terms<const N: usize>(count: usize, term: impl Fn(usize) -> [f64; N] + Sync) -> [f64; N] {
    let sum_chunk = |chunk: usize| {
        // Sums and errors in separate arrays, so that several series fit into one register.
        let (mut sums, mut lost) = ([0.0; N], [0.0; N]);
        for index in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
            let values = term(index);
            for k in 0..N {
                let mut sum = CompensatedSum { sum: sums[k], lost: lost[k] };
                sum.add(values[k]);
                (sums[k], lost[k]) = (sum.sum, sum.lost);
            }
        }
        std::array::from_fn::<_, N, _>(|k| CompensatedSum { sum: sums[k], lost: lost[k] })
    };
    let chunks = count.div_ceil(CHUNK);
    // Chunks have a fixed length, and their sums are merged in order on this thread.
    let partial: Vec<_> = match chunks {
        0 | 1 => (0..chunks).map(sum_chunk).collect(),
        _ => (0..chunks).into_par_iter().map(sum_chunk).collect(),
    };
    let mut total = [CompensatedSum::default(); N];
    for sums in partial {
        total.iter_mut().zip(sums).for_each(|(total, sum)| total.merge(sum));
    }
    total.map(CompensatedSum::value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_terms_survive_large_ones() {
        let mut sum = CompensatedSum::default();
        [1.0, 1e100, 1.0, -1e100].into_iter().for_each(|value| sum.add(value));
        assert_eq!(sum.value(), 2.0);
        [f64::MAX, f64::MAX].into_iter().for_each(|value| sum.add(value));
        assert_eq!(sum.value(), f64::INFINITY);
    }

    #[test]
    fn sums_have_the_same_bits_for_any_number_of_threads() {
        let term = |index: usize| [libm::sin(index as f64), 1.0 / (1.0 + index as f64)];
        let with_threads = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sum_terms(100_000, term)).map(f64::to_bits)
        };
        assert_eq!(with_threads(1), with_threads(2));
        assert_eq!(with_threads(1), with_threads(8));
        // The harmonic number to full precision: Euler's constant + ln n + 1/2n − 1/12n².
        let [_, harmonic] = with_threads(2).map(f64::from_bits);
        let exact = 0.577_215_664_901_532_9 + libm::log(1e5) + 0.5e-5 - 1.0 / 12e10;
        assert!((harmonic - exact).abs() < 2.0 * f64::EPSILON * exact);
    }
}
