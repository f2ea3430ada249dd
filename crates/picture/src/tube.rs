//! Tube meshes for lines and arrows.

use glam::{DQuat, DVec3};
use isochore_mesh::TriMesh;

/// Sides of a tube's cross-section.
const SIDES: usize = 12;

/// Radius and length of an arrow head, in shaft radii.
const HEAD_RADIUS: f64 = 2.6;
const HEAD_LENGTH: f64 = 6.5;

/// Largest fraction of an arrow's length that its head may take.
const HEAD_FRACTION: f64 = 0.5;

/// Tube around a polyline. Each cross-section follows from the previous one by the smallest
/// rotation.
pub(crate) fn polyline(points: &[DVec3], radius: f64) -> TriMesh {
    let mut mesh = TriMesh::default();
    let mut path: Vec<DVec3> = points.iter().copied().filter(|point| point.is_finite()).collect();
    path.dedup();
    append_tube(&mut mesh, &path, &vec![radius; path.len()]);
    mesh
}

/// Arrows, each consisting of a shaft and a cone.
pub(crate) fn arrows(arrows: &[(DVec3, DVec3)], radius: f64) -> TriMesh {
    let mut mesh = TriMesh::default();
    for &(from, to) in arrows {
        let length = from.distance(to);
        if !(length.is_finite() && length > 0.0) {
            continue;
        }
        let head = (HEAD_LENGTH * radius).min(HEAD_FRACTION * length);
        let neck = to - head / length * (to - from);
        let scale = head / (HEAD_LENGTH * radius);
        append_tube(&mut mesh, &[from, neck], &[radius * scale; 2]);
        append_tube(&mut mesh, &[neck, to], &[HEAD_RADIUS * radius * scale, 0.0]);
    }
    mesh
}

/// Appends a tube with flat caps, whose radius varies linearly between points.
fn append_tube(mesh: &mut TriMesh, path: &[DVec3], radii: &[f64]) {
    if path.len() < 2 {
        return;
    }
    let directions: Vec<DVec3> = path.windows(2).map(|pair| (pair[1] - pair[0]).normalize_or_zero()).collect();
    let mut side = directions[0].any_orthonormal_vector();
    let start = mesh.positions.len() as u32;
    for (i, (&point, &radius)) in path.iter().zip(radii).enumerate() {
        let before = directions[i.saturating_sub(1)];
        let after = directions[i.min(directions.len() - 1)];
        let tangent = (before + after).try_normalize().unwrap_or(after);
        if i > 0 {
            side = DQuat::from_rotation_arc(before, after) * side;
        }
        let across = (side - side.dot(tangent) * tangent).normalize_or(tangent.any_orthonormal_vector());
        let along = tangent.cross(across);
        for step in 0..SIDES {
            let (sine, cosine) = libm::sincos(core::f64::consts::TAU * step as f64 / SIDES as f64);
            mesh.positions.push(point + radius * (cosine * across + sine * along));
        }
    }
    let sides = SIDES as u32;
    for ring in 0..path.len() as u32 - 1 {
        for step in 0..sides {
            let [a, b] = [step, (step + 1) % sides].map(|step| start + ring * sides + step);
            mesh.triangles.push([a, b, b + sides]);
            mesh.triangles.push([a, b + sides, a + sides]);
        }
    }
    for (ring, forward) in [(0, false), (path.len() as u32 - 1, true)] {
        for step in 1..sides - 1 {
            let [a, b, c] = [0, step, step + 1].map(|step| start + ring * sides + step);
            mesh.triangles.push(if forward { [a, b, c] } else { [a, c, b] });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(mesh: &TriMesh) -> f64 {
        let signed = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
            a.dot(b.cross(c)) / 6.0
        };
        mesh.triangles.iter().map(signed).sum()
    }

    /// Area of a regular polygon with [`SIDES`] corners on the unit circle.
    fn section_area() -> f64 {
        0.5 * SIDES as f64 * libm::sin(core::f64::consts::TAU / SIDES as f64)
    }

    #[test]
    fn straight_tube_is_an_outward_facing_prism() {
        let tube = polyline(&[DVec3::X, DVec3::X + 2.0 * DVec3::Z, DVec3::X + 3.0 * DVec3::Z], 0.1);
        let exact = 3.0 * 0.01 * section_area();
        assert!((volume(&tube) - exact).abs() < 1e-14);
    }

    #[test]
    fn arrow_is_a_prism_and_a_pyramid() {
        let arrow = arrows(&[(DVec3::ZERO, 10.0 * DVec3::Y)], 0.1);
        let head = HEAD_LENGTH * 0.1;
        let exact = section_area() * 0.01 * ((10.0 - head) + HEAD_RADIUS * HEAD_RADIUS * head / 3.0);
        assert!((volume(&arrow) - exact).abs() < 1e-13);
    }

    #[test]
    fn lines_and_arrows_of_zero_length_are_empty() {
        assert!(polyline(&[DVec3::ONE, DVec3::ONE], 0.1).triangles.is_empty());
        assert!(arrows(&[(DVec3::ONE, DVec3::ONE)], 0.1).triangles.is_empty());
    }
}
