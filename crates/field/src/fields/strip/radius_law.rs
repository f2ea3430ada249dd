//! Variation of the radius of a strip along its spine.
//!
//! The radius is the C² cubic spline through evenly spaced radii ρ(i), with zero slope at both
//! ends, where round caps join it. Its slopes m(i) between the ends solve
//!
//! ```text
//! m(i−1) + 4 m(i) + m(i+1) = 3 (ρ(i+1) − ρ(i−1))
//! ```

use super::StripError;

/// A radius as a smooth function of the fraction of the spine's length.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RadiusLaw {
    radii: Vec<f64>,
    /// Derivatives at the radii, by the index.
    slopes: Vec<f64>,
}

impl RadiusLaw {
    pub(super) fn new(radii: &[f64]) -> Result<Self, StripError> {
        if radii.is_empty() {
            return Err(StripError::NoRadius);
        }
        if let Some(index) = radii.iter().position(|radius| !(*radius > 0.0 && radius.is_finite())) {
            return Err(StripError::Radius { index, value: radii[index] });
        }
        let law = Self { radii: radii.to_vec(), slopes: slopes(radii) };
        match (1..radii.len()).find(|&end| law.ordinates(end - 1)[1..3].iter().any(|ordinate| *ordinate <= 0.0)) {
            Some(end) => Err(StripError::RadiusSwings { index: end - 1 }),
            None => Ok(law),
        }
    }

    pub(super) fn is_constant(&self) -> bool {
        self.radii.len() == 1
    }

    /// Upper bound on the radius.
    pub(super) fn largest(&self) -> f64 {
        let ordinates = (1..self.radii.len()).flat_map(|end| self.ordinates(end - 1));
        self.radii.iter().copied().chain(ordinates).fold(0.0, f64::max)
    }

    /// Smallest of the radii given.
    pub(super) fn smallest(&self) -> f64 {
        self.radii.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Radius at a fraction of the length, from 0 to 1, and its derivative by the fraction.
    pub(super) fn evaluate(&self, fraction: f64) -> (f64, f64) {
        let pieces = self.radii.len() - 1;
        if pieces == 0 {
            return (self.radii[0], 0.0);
        }
        let scaled = fraction.clamp(0.0, 1.0) * pieces as f64;
        let piece = (scaled as usize).min(pieces - 1);
        let t = scaled - piece as f64;
        let [a, b, c, d] = self.ordinates(piece);
        let rest = 1.0 - t;
        let value = rest * rest * (rest * a + 3.0 * t * b) + t * t * (3.0 * rest * c + t * d);
        let slope = 3.0 * (rest * rest * (b - a) + 2.0 * rest * t * (c - b) + t * t * (d - c));
        (value, slope * pieces as f64)
    }

    /// Bézier ordinates of a piece, whose convex hull contains the radius.
    fn ordinates(&self, piece: usize) -> [f64; 4] {
        let [start, end] = [self.radii[piece], self.radii[piece + 1]];
        [start, start + self.slopes[piece] / 3.0, end - self.slopes[piece + 1] / 3.0, end]
    }
}

/// Slopes at the radii: zero at both ends, and continuous second derivatives between. Solves the
/// tridiagonal system by elimination.
fn slopes(radii: &[f64]) -> Vec<f64> {
    let last = radii.len() - 1;
    let mut slopes = vec![0.0; radii.len()];
    let mut pivots = vec![4.0; radii.len()];
    for i in 1..last {
        slopes[i] = 3.0 * (radii[i + 1] - radii[i - 1]);
        if i > 1 {
            pivots[i] -= 1.0 / pivots[i - 1];
            slopes[i] -= slopes[i - 1] / pivots[i - 1];
        }
    }
    for i in (1..last).rev() {
        slopes[i] = (slopes[i] - slopes[i + 1]) / pivots[i];
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADII: [f64; 5] = [0.1, 0.3, 0.25, 0.4, 0.2];

    #[test]
    fn interpolates_the_radii_with_two_derivatives() {
        let law = RadiusLaw::new(&RADII).unwrap();
        for (i, &radius) in RADII.iter().enumerate() {
            let fraction = i as f64 / 4.0;
            assert!((law.evaluate(fraction).0 - radius).abs() < 1e-15);
        }
        for fraction in [0.25, 0.5, 0.75] {
            let h = 1e-6;
            let [before, at, after] = [fraction - h, fraction, fraction + h].map(|fraction| law.evaluate(fraction).1);
            // Third derivatives are of the order of a hundred. Their jump contributes 1e-4; a jump
            // of the second derivative would contribute 1.
            assert!(((after - at) - (at - before)).abs() / h < 1e-3, "{fraction}");
        }
        assert_eq!((law.evaluate(0.0).1, law.evaluate(1.0).1), (0.0, 0.0));
        assert!((0..=100).all(|i| law.evaluate(f64::from(i) / 100.0).0 <= law.largest()));
    }

    #[test]
    fn the_slope_is_the_derivative() {
        let law = RadiusLaw::new(&RADII).unwrap();
        for fraction in [0.1, 0.4, 0.62, 0.9] {
            let h = 1e-5;
            let difference = (law.evaluate(fraction + h).0 - law.evaluate(fraction - h).0) / (2.0 * h);
            // h²/6 of a third derivative of the order of a hundred.
            assert!((difference - law.evaluate(fraction).1).abs() < 1e-8, "{fraction}");
        }
    }

    #[test]
    fn rejects_invalid_radii() {
        assert_eq!(RadiusLaw::new(&[]).unwrap_err(), StripError::NoRadius);
        assert_eq!(RadiusLaw::new(&[0.1, -0.1]).unwrap_err(), StripError::Radius { index: 1, value: -0.1 });
        assert_eq!(RadiusLaw::new(&[1.0, 0.001, 0.001, 1.0]).unwrap_err(), StripError::RadiusSwings { index: 1 });
        assert_eq!(RadiusLaw::new(&[0.3]).unwrap().evaluate(0.7), (0.3, 0.0));
    }
}
