//! A planet: continents, mountains and craters on a sphere of radius one.

use glam::DVec3;
use isochore_mesh::{TriMesh, primitives::icosphere};

use super::solid::smooth_step;

/// Waves whose sum makes the land: direction times wave number, phase, amplitude.
const WAVES: [(DVec3, f64, f64); 10] = [
    (DVec3::new(2.1, 0.7, -1.2), 0.3, 1.00),
    (DVec3::new(-0.9, 2.6, 0.8), 1.9, 0.90),
    (DVec3::new(1.1, -1.3, 2.9), 4.1, 0.80),
    (DVec3::new(-3.4, -1.6, 2.2), 2.7, 0.55),
    (DVec3::new(2.5, 3.9, 1.9), 5.2, 0.50),
    (DVec3::new(4.4, -3.1, -2.6), 0.9, 0.42),
    (DVec3::new(-5.3, 4.2, -4.8), 3.3, 0.28),
    (DVec3::new(6.1, 5.7, 3.6), 1.2, 0.25),
    (DVec3::new(-7.2, 2.9, 7.5), 4.6, 0.18),
    (DVec3::new(8.8, -7.4, 5.1), 2.2, 0.14),
];

/// Craters: direction of the center, and radius as an angle in radians.
const CRATERS: [(DVec3, f64); 7] = [
    (DVec3::new(0.75, -0.60, 0.28), 0.26),
    (DVec3::new(-0.30, -0.90, -0.31), 0.19),
    (DVec3::new(0.20, -0.55, 0.81), 0.15),
    (DVec3::new(-0.85, 0.20, 0.48), 0.22),
    (DVec3::new(0.42, 0.88, -0.22), 0.24),
    (DVec3::new(0.60, 0.10, -0.79), 0.17),
    (DVec3::new(-0.52, -0.62, 0.58), 0.13),
];

/// Height of the land, and of the ground that keeps it from being flat, as fractions of the radius.
const LAND: f64 = 0.030;
const ROUGHNESS: f64 = 0.006;

/// The planet: an icosphere with every vertex moved along its radius.
pub(crate) fn planet(subdivisions: u32) -> TriMesh {
    let mut mesh = icosphere(1.0, subdivisions);
    for position in &mut mesh.positions {
        let direction = position.normalize();
        *position = radius(direction) * direction;
    }
    mesh
}

fn radius(direction: DVec3) -> f64 {
    let sum = WAVES
        .iter()
        .fold(0.0, |sum, &(wave, phase, amplitude)| sum + amplitude * libm::sin(1.15 * wave.dot(direction) + phase));
    let land = LAND * smooth_step(-0.05, 0.75, sum) + ROUGHNESS * sum;
    CRATERS.iter().fold(1.0 + land, |radius, &(middle, size)| {
        let away = libm::atan2(direction.cross(middle).length(), direction.dot(middle)) / size;
        radius + 0.22 * size * crater(away)
    })
}

/// Height of a crater of radius one at a distance from its center: a bowl, a rim at one, and a slope that ends at two.
fn crater(away: f64) -> f64 {
    if away >= 2.0 {
        0.0
    } else if away >= 1.0 {
        0.28 * (1.0 - smooth_step(1.0, 2.0, away))
    } else {
        0.28 - 0.85 * (1.0 - smooth_step(0.35, 1.0, away))
    }
}
