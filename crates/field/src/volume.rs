//! Volume of closed triangle lists.

use glam::DVec3;
use isochore_mesh::sum_terms;

/// Signed volume inside closed, oriented `triangles`, summed about the mean of `positions` with compensation.
pub(crate) fn signed_volume(positions: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let center = positions.iter().sum::<DVec3>() / positions.len() as f64;
    let [six_volumes] = sum_terms(triangles.len(), |index| {
        let [a, b, c] = triangles[index].map(|vertex| positions[vertex as usize] - center);
        [a.dot(b.cross(c))]
    });
    six_volumes / 6.0
}
