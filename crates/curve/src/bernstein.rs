//! Arithmetic of polynomials in Bernstein form on [0, 1].

use std::ops::{Add, Mul};

/// Bernstein coefficients of the product of two polynomials. `multiply` multiplies their
/// coefficients, which can be scalars or vectors.
pub(crate) fn product<A: Copy, B: Copy, C>(f: &[A], g: &[B], multiply: impl Fn(A, B) -> C) -> Vec<C>
where
    C: Copy + Default + Add<Output = C> + Mul<f64, Output = C>,
{
    let (m, n) = (f.len() - 1, g.len() - 1);
    let mut result = vec![C::default(); m + n + 1];
    for (i, &a) in f.iter().enumerate() {
        for (j, &b) in g.iter().enumerate() {
            let weight = binomial(m, i) * binomial(n, j) / binomial(m + n, i + j);
            result[i + j] = result[i + j] + multiply(a, b) * weight;
        }
    }
    result
}

/// Raises the degree by `degrees`; the polynomial stays the same.
pub(crate) fn raise<C>(f: &[C], degrees: usize) -> Vec<C>
where
    C: Copy + Default + Add<Output = C> + Mul<f64, Output = C>,
{
    product(&vec![1.0; degrees + 1], f, |one: f64, c| c * one)
}

/// Value of a polynomial, by de Casteljau's algorithm.
pub(crate) fn value<C>(coefficients: &[C], parameter: f64) -> C
where
    C: Copy + Default + Add<Output = C> + Mul<f64, Output = C>,
{
    let mut points = coefficients.to_vec();
    for left in (1..points.len()).rev() {
        for i in 0..left {
            points[i] = points[i] * (1.0 - parameter) + points[i + 1] * parameter;
        }
    }
    points[0]
}

/// Bernstein coefficients of the derivative. The derivative of a constant is the zero polynomial.
pub(crate) fn derivative<C>(coefficients: &[C]) -> Vec<C>
where
    C: Copy + Default + Add<Output = C> + Mul<f64, Output = C>,
{
    let degree = coefficients.len() - 1;
    if degree == 0 {
        return vec![C::default()];
    }
    coefficients.windows(2).map(|pair| (pair[1] + pair[0] * -1.0) * degree as f64).collect()
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_and_derivatives_have_the_correct_values() {
        let (f, g) = ([1.0, -2.0, 0.5], [3.0, 0.25, -1.0, 2.0]);
        let fg = product(&f, &g, |a, b| a * b);
        assert_eq!(fg.len(), 6);
        for t in [0.0, 0.3, 0.9, 1.0] {
            assert!((value(&fg, t) - value(&f, t) * value(&g, t)).abs() < 1e-15);
            assert!((value(&raise(&f, 3), t) - value(&f, t)).abs() < 1e-15);
            let step = 1e-6;
            let difference = (value(&g, t + step) - value(&g, t - step)) / (2.0 * step);
            assert!((value(&derivative(&g), t) - difference).abs() < 1e-9);
        }
        assert_eq!(derivative(&[4.0]), [0.0]);
    }
}
