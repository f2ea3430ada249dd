//! A smooth minimum that is the minimum itself where the two differ enough.

use glam::DVec3;

/// A value and its gradient.
pub(super) type Scalar = (f64, DVec3);

/// The smaller of `a` and `b`, rounded where they differ by less than `width`: twice continuously differentiable in both,
/// never above the minimum, and below it by a sixth of the width at most.
///
/// ```text
/// min(a, b) − (w/6) h³,   h = max(0, 1 − |a − b|/w)
/// ```
///
/// Its gradient is a convex combination of theirs. Unlike log-sum-exp it is exactly the smaller one where the other is far,
/// so that distant parts may be left out without changing a bit.
pub(super) fn smooth_minimum(a: Scalar, b: Scalar, width: f64) -> Scalar {
    let (near, far) = if b.0 < a.0 { (b, a) } else { (a, b) };
    let overlap = 1.0 - (far.0 - near.0) / width;
    if overlap.is_nan() || overlap <= 0.0 {
        return near;
    }
    let share = 0.5 * overlap * overlap;
    (near.0 - width / 6.0 * overlap * overlap * overlap, (1.0 - share) * near.1 + share * far.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_minimum_where_the_values_differ_by_the_width() {
        for (a, b) in [(0.1, 0.6), (0.6, 0.1), (-1.0, f64::INFINITY), (0.3, 0.5)] {
            assert_eq!(smooth_minimum((a, DVec3::X), (b, DVec3::Y), 0.2).0, f64::min(a, b));
        }
        let infinite = (f64::INFINITY, DVec3::ZERO);
        assert_eq!(smooth_minimum(infinite, infinite, 0.2), infinite);
    }

    #[test]
    fn gradient_and_second_derivative_are_continuous() {
        let width = 0.3;
        let at = |x: f64| smooth_minimum((x, DVec3::X), (0.5 - x, -DVec3::X), width);
        let h = 1e-5;
        let mut before: Option<f64> = None;
        for index in 0..=500 {
            let x = 0.001 * f64::from(index);
            let slope = (at(x + h).0 - at(x - h).0) / (2.0 * h);
            // h²/6 of the third derivative, 8/w² = 90, which jumps where the two are equal and where they part.
            assert!((slope - at(x).1.x).abs() < 2e-8, "{x}");
            let curvature = (at(x + h).1.x - at(x - h).1.x) / (2.0 * h);
            // Steps of 0.001 change a second derivative by 0.09 at a slope of 90.
            assert!(before.is_none_or(|before| (curvature - before).abs() < 0.1), "{x}");
            before = Some(curvature);
        }
    }
}
