//! Measures of the shape of a triangle.

use glam::DVec3;

/// Normal of twice the area of the triangle in length.
#[inline]
pub(super) fn area_normal([a, b, c]: &[DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Unit normal of a triangle; zero without area.
#[inline]
pub(super) fn direction(corners: &[DVec3; 3]) -> DVec3 {
    area_normal(corners).normalize_or_zero()
}

/// Square of the sine of the smallest angle; zero for a triangle without area.
#[inline]
pub(super) fn smallest_sine2(corners: &[DVec3; 3]) -> f64 {
    let [a, b, c] = *corners;
    let [x, y, z] = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
    // The smallest angle is between the two longest sides.
    let longest2 = (x * y).max(y * z).max(z * x);
    let sine2 = area_normal(corners).length_squared() / longest2;
    if sine2.is_finite() { sine2 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smallest_sine_of_known_triangles() {
        let sine2 = |corners: [[f64; 3]; 3]| smallest_sine2(&corners.map(DVec3::from_array));
        let third = 0.75_f64.sqrt();
        assert!((sine2([[0.0; 3], [1.0, 0.0, 0.0], [0.5, third, 0.0]]) - 0.75).abs() < 1e-15);
        // The sides are 3, 4 and 5, and the smallest angle is opposite to 3.
        assert!((sine2([[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]]) - 0.36).abs() < 1e-15);
        assert_eq!(sine2([[0.0; 3], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]]), 0.0);
        assert_eq!(sine2([[1.0; 3]; 3]), 0.0);
    }
}
