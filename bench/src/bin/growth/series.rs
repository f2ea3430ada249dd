use isochore_bench::{cpu_seconds, median};

/// Runs of one size, of which the median counts; one is enough where it takes longer than [`LONG`].
const ROUNDS: usize = 3;

/// Seconds of a run that need no second one.
const LONG: f64 = 1.0;

/// Sizes of the last slope.
const LAST: usize = 3;

/// What one stage takes at growing sizes.
#[derive(Debug, Clone)]
pub(crate) struct Series {
    pub(crate) stage: &'static str,
    /// Sizes, and seconds of work.
    pub(crate) points: Vec<(usize, f64)>,
    has_ended: bool,
}

impl Series {
    pub(crate) fn new(stage: &'static str) -> Self {
        Self { stage, points: Vec::new(), has_ended: false }
    }

    /// Measures `run` at one more size, unless it is likely to take longer than `limit` seconds.
    pub(crate) fn measure<T>(&mut self, size: usize, limit: f64, mut run: impl FnMut() -> T) {
        let expected = self.points.last().map_or(0.0, |&(last, seconds)| seconds * size as f64 / last as f64);
        self.has_ended |= expected > limit;
        if self.has_ended {
            return;
        }
        let mut seconds = Vec::new();
        while seconds.len() < ROUNDS && seconds.iter().all(|&seconds| seconds < LONG) {
            let begin = cpu_seconds();
            let result = std::hint::black_box(run());
            seconds.push(cpu_seconds() - begin);
            drop(result);
        }
        self.points.push((size, median(&mut seconds)));
    }

    /// Takes over what `other` measured last, at `other_size`, for another measure of the size.
    pub(crate) fn repeat_last(&mut self, size: usize, other: &Self, other_size: usize) {
        let measured = other.points.last().filter(|(size, _)| *size == other_size);
        self.points.extend(measured.map(|&(_, seconds)| (size, seconds)));
    }

    /// The exponent of the power of the size that fits the seconds best, by least squares of the logarithms.
    pub(crate) fn slope(&self) -> f64 {
        slope(&self.points)
    }

    /// The same over the largest sizes alone.
    pub(crate) fn last_slope(&self) -> f64 {
        slope(&self.points[self.points.len().saturating_sub(LAST)..])
    }
}

fn slope(points: &[(usize, f64)]) -> f64 {
    let logarithms = || points.iter().map(|&(size, seconds)| (libm::log(size as f64), libm::log(seconds)));
    let count = points.len() as f64;
    let (x, y) = logarithms().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    let (covariance, variance) = logarithms().fold((0.0, 0.0), |(covariance, variance), point| {
        (covariance + (point.0 - x) * (point.1 - y), variance + (point.0 - x) * (point.0 - x))
    });
    covariance / variance
}

#[test]
fn powers_have_their_exponents() {
    let points: Vec<(usize, f64)> = [10, 30, 100, 1000].map(|size| (size, 3e-7 * (size as f64).powf(1.5))).into();
    // Rounding alone.
    assert!((slope(&points) - 1.5).abs() < 1e-12, "{}", slope(&points));
}
