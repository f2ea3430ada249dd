use isochore_bench::{cpu_seconds, median};

/// Largest number of runs per size; the median counts. Runs longer than [`LONG`] are not repeated.
const ROUNDS: usize = 3;

/// Shortest run that is not repeated, seconds.
const LONG: f64 = 1.0;

/// Number of sizes of the last slope.
const LAST: usize = 3;

/// CPU times of one stage at increasing sizes.
#[derive(Debug, Clone)]
pub(crate) struct Series {
    pub(crate) stage: &'static str,
    /// Sizes with CPU times in seconds.
    pub(crate) points: Vec<(usize, f64)>,
    has_ended: bool,
}

impl Series {
    pub(crate) fn new(stage: &'static str) -> Self {
        Self { stage, points: Vec::new(), has_ended: false }
    }

    /// Measures `run` at the next size, unless it is expected to take longer than `limit` seconds.
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

    /// Copies the last measurement of `other` under a new `size`, if it was taken at `other_size`.
    pub(crate) fn repeat_last(&mut self, size: usize, other: &Self, other_size: usize) {
        let measured = other.points.last().filter(|(size, _)| *size == other_size);
        self.points.extend(measured.map(|&(_, seconds)| (size, seconds)));
    }

    /// Exponent of the power law that fits the times best, by least squares of the logarithms.
    pub(crate) fn slope(&self) -> f64 {
        slope(&self.points)
    }

    /// Exponent over the largest sizes only.
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
fn slope_is_the_exponent_of_a_power_law() {
    let points: Vec<(usize, f64)> = [10, 30, 100, 1000].map(|size| (size, 3e-7 * (size as f64).powf(1.5))).into();
    // The bound allows only rounding.
    assert!((slope(&points) - 1.5).abs() < 1e-12, "{}", slope(&points));
}
