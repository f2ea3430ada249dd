//! Sums that keep the bits rounded away (Neumaier, "Rundungsfehleranalyse einiger Verfahren zur Summation endlicher
//! Summen", 1974).

use rayon::prelude::*;

/// A running sum with its accumulated rounding error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CompensatedSum {
    sum: f64,
    lost: f64,
}

impl CompensatedSum {
    /// Adds `value`.
    pub fn add(&mut self, value: f64) {
        let sum = self.sum + value;
        // Exact rounding error of the addition, whichever operand is larger (Knuth's TwoSum).
        let from_value = sum - self.sum;
        self.lost += (self.sum - (sum - from_value)) + (value - from_value);
        self.sum = sum;
    }

    /// The sum so far.
    pub fn value(self) -> f64 {
        // Past the largest number the error term is not a number, while the sum still is one.
        if self.sum.is_finite() { self.sum + self.lost } else { self.sum }
    }

    fn merge(&mut self, other: Self) {
        self.add(other.sum);
        self.lost += other.lost;
    }
}

/// Terms added up in one go. Changing it changes the last bits of large sums.
const CHUNK: usize = 4096;

/// Sums `N` series of `count` terms at once, in parallel, with the same bits for any number of threads.
pub fn sum_terms<const N: usize>(count: usize, term: impl Fn(usize) -> [f64; N] + Sync) -> [f64; N] {
    let sum_chunk = |chunk: usize| {
        let mut sums = [CompensatedSum::default(); N];
        for index in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
            sums.iter_mut().zip(term(index)).for_each(|(sum, value)| sum.add(value));
        }
        sums
    };
    let chunks = count.div_ceil(CHUNK);
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
