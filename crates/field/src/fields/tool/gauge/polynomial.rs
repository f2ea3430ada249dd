//! Cubic polynomials in space without a constant term.

use std::ops::{Add, Mul, Sub};

use glam::DVec3;

/// Number of terms of a polynomial of degree 0, 1, 2 and 3 without constant term.
pub(super) const TERMS: [usize; 4] = [0, 3, 9, 19];

/// Powers of x, y and z of each term, by ascending degree.
pub(super) const POWERS: [[i32; 3]; 19] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [2, 0, 0],
    [1, 1, 0],
    [1, 0, 1],
    [0, 2, 0],
    [0, 1, 1],
    [0, 0, 2],
    [3, 0, 0],
    [2, 1, 0],
    [2, 0, 1],
    [1, 2, 0],
    [1, 1, 1],
    [1, 0, 2],
    [0, 3, 0],
    [0, 2, 1],
    [0, 1, 2],
    [0, 0, 3],
];

/// A cubic polynomial without constant term: one coefficient for each of [`POWERS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cubic(pub(super) [f64; 19]);

impl Cubic {
    pub(crate) const ZERO: Self = Self([0.0; 19]);

    /// (a·r)(b·r)(c·r).
    pub(super) fn product(a: DVec3, b: DVec3, c: DVec3) -> Self {
        let mut sum = Self::ZERO;
        for i in 0..3 {
            for j in 0..3 {
                for k in 0..3 {
                    let mut powers = [0; 3];
                    [i, j, k].into_iter().for_each(|axis| powers[axis] += 1);
                    let term = POWERS.iter().position(|&term| term == powers);
                    if let Some(term) = term {
                        sum.0[term] += a[i] * b[j] * c[k];
                    }
                }
            }
        }
        sum
    }

    /// |r|² (c·r).
    pub(super) fn product_of_squares(c: DVec3) -> Self {
        DVec3::AXES.into_iter().fold(Self::ZERO, |sum, axis| sum + Self::product(axis, axis, c))
    }

    /// Gradient at `r`.
    #[inline(always)]
    pub(crate) fn gradient(&self, r: DVec3) -> DVec3 {
        let c = &self.0;
        let DVec3 { x, y, z } = r;
        let [xx, xy, xz, yy, yz, zz] = [x * x, x * y, x * z, y * y, y * z, z * z];
        DVec3::new(
            c[0] + 2.0 * c[3] * x
                + c[4] * y
                + c[5] * z
                + 3.0 * c[9] * xx
                + 2.0 * (c[10] * xy + c[11] * xz)
                + c[12] * yy
                + c[13] * yz
                + c[14] * zz,
            c[1] + c[4] * x
                + 2.0 * c[6] * y
                + c[7] * z
                + c[10] * xx
                + 2.0 * c[12] * xy
                + c[13] * xz
                + 3.0 * c[15] * yy
                + 2.0 * c[16] * yz
                + c[17] * zz,
            c[2] + c[5] * x
                + c[7] * y
                + 2.0 * c[8] * z
                + c[11] * xx
                + c[13] * xy
                + 2.0 * c[14] * xz
                + c[16] * yy
                + 2.0 * c[17] * yz
                + 3.0 * c[18] * zz,
        )
    }
}

impl Add for Cubic {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|term| self.0[term] + other.0[term]))
    }
}

impl Sub for Cubic {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul<f64> for Cubic {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|coefficient| coefficient * factor))
    }
}
