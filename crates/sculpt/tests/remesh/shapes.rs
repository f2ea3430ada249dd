//! Meshes to remesh.

use glam::{DVec2, DVec3};
use isochore_mesh::{TriMesh, primitives::icosphere};

/// Pseudorandom numbers (D. Lehmer's generator with the multiplier of L'Ecuyer's table, 1999).
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    /// Between 0 and 1.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(0xd134_2543_de82_ef95).wrapping_add(1);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        DVec3::new(self.next() - 0.5, self.next() - 0.5, self.next() - 0.5).normalize_or(DVec3::X)
    }
}

/// A grid of `columns` × `rows` vertices with these positions, closed around itself in the directions
/// that wrap.
pub(crate) fn grid(
    [columns, rows]: [usize; 2],
    [wraps_columns, wraps_rows]: [bool; 2],
    position: impl Fn(usize, usize) -> DVec3,
) -> TriMesh {
    let positions = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j])).map(|[i, j]| position(i, j)).collect();
    let mut triangles = Vec::new();
    for j in 0..rows - usize::from(!wraps_rows) {
        for i in 0..columns - usize::from(!wraps_columns) {
            let at = |i: usize, j: usize| (j % rows * columns + i % columns) as u32;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    TriMesh::new(positions, triangles)
}

/// A torus around z with radii 1 and `tube`.
pub(crate) fn torus(tube: f64, around: usize, across: usize) -> TriMesh {
    use std::f64::consts::TAU;
    grid([around, across], [true, true], |i, j| {
        let (u, v) = (TAU * i as f64 / around as f64, TAU * j as f64 / across as f64);
        let radius = 1.0 + tube * libm::cos(v);
        DVec3::new(radius * libm::cos(u), radius * libm::sin(u), tube * libm::sin(v))
    })
}

/// A smooth, bumpy ball of random shape whose vertices are scattered along the surface.
pub(crate) fn bumpy_ball(seed: u64, subdivisions: u32) -> TriMesh {
    let mut numbers = Numbers(seed);
    let waves: Vec<(DVec3, f64)> = (0..6).map(|_| (3.0 * numbers.direction(), 6.0 * numbers.next())).collect();
    let mut mesh = icosphere(1.0, subdivisions);
    let scatter = 0.5 / f64::from(1 << subdivisions);
    for position in &mut mesh.positions {
        let direction = (*position + scatter * numbers.next() * numbers.direction()).normalize();
        let bumps: f64 = waves.iter().map(|(wave, phase)| libm::sin(wave.dot(direction) + phase)).sum();
        *position = direction * (1.0 + 0.06 * bumps);
    }
    mesh
}

/// A wavy square sheet.
pub(crate) fn sheet(count: usize) -> TriMesh {
    grid([count; 2], [false; 2], |i, j| {
        let place = DVec2::new(i as f64, j as f64) / (count - 1) as f64;
        place.extend(0.05 * libm::sin(7.0 * place.x) * libm::cos(5.0 * place.y))
    })
}
