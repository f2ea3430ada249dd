//! The volume lock: a last small displacement that gives back exactly the volume at rest.
//!
//! Vertices move along the gradient of the volume weighted by how far each has come, so that what did not move is not moved and
//! small triangles are moved least.

use glam::DVec3;

use super::balance::{balance, balance_part};

/// What the lock did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lock {
    /// Longest displacement of a vertex, model units.
    pub max_shift: f64,
    /// Largest ratio of a vertex' displacement to the shortest edge at it.
    pub max_shift_per_edge: f64,
}

/// Moves `image` so that its volume is `volume`. None, and nothing moved, when nothing had moved or the displacement has no
/// hold on the volume, so that no root brings it back.
///
/// `rest` is where the vertices set out; those that have not moved from there stay.
///
/// # Panics
/// If an index is out of range, or `rest` is not as long as `image`.
pub fn lock_volume(rest: &[DVec3], image: &mut [DVec3], triangles: &[[u32; 3]], volume: f64) -> Option<Lock> {
    let directions = directions(rest, image, triangles)?;
    let unlocked = image.to_vec();
    balance(image, &directions, triangles, volume)?;
    Some(Lock::between(&unlocked, image, triangles))
}

/// The same for a part of a closed surface, with all triangles at what has moved: moves `image` so that the volume inside the whole
/// grows by `gain`. `size` is the volume of the whole. Takes time in proportion to the part.
///
/// # Panics
/// If an index is out of range, or `rest` is not as long as `image`.
pub fn lock_part(rest: &[DVec3], image: &mut [DVec3], triangles: &[[u32; 3]], gain: f64, size: f64) -> Option<Lock> {
    let directions = directions(rest, image, triangles)?;
    let unlocked = image.to_vec();
    balance_part(image, &directions, triangles, gain, size)?;
    Some(Lock::between(&unlocked, image, triangles))
}

impl Lock {
    /// What takes `unlocked` positions to `locked` ones.
    pub fn between(unlocked: &[DVec3], locked: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let shift = |vertex: u32| locked[vertex as usize].distance(unlocked[vertex as usize]);
        let max_shift = (0..locked.len() as u32).map(shift).fold(0.0, f64::max);
        let mut max_shift_per_edge: f64 = 0.0;
        for [a, b, c] in triangles {
            for (a, b) in [(*a, *b), (*b, *c), (*c, *a)] {
                let length = unlocked[a as usize].distance(unlocked[b as usize]);
                let longest = shift(a).max(shift(b));
                if longest > 0.0 {
                    max_shift_per_edge = max_shift_per_edge.max(longest / length);
                }
            }
        }
        Self { max_shift, max_shift_per_edge }
    }
}

/// For each vertex its area normal, scaled by its share of the largest displacement.
fn directions(rest: &[DVec3], image: &[DVec3], triangles: &[[u32; 3]]) -> Option<Vec<DVec3>> {
    let displacements: Vec<f64> = rest.iter().zip(image).map(|(rest, image)| rest.distance(*image)).collect();
    let largest = displacements.iter().copied().fold(0.0, f64::max);
    if largest == 0.0 {
        return None;
    }
    let mut directions = vec![DVec3::ZERO; image.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| image[vertex as usize]);
        // A sixth of the cross product is a third of the area, along the normal: the gradient of the volume at each corner.
        let gradient = (b - a).cross(c - a) / 6.0;
        for vertex in triangle {
            directions[*vertex as usize] += gradient;
        }
    }
    // Of the size of the mean area normal, so that λ is a length times a number near one.
    let scale = directions.iter().map(|direction| direction.length()).fold(0.0, f64::max);
    if scale == 0.0 {
        return None;
    }
    for (direction, displacement) in directions.iter_mut().zip(&displacements) {
        *direction *= displacement / largest / scale;
    }
    Some(directions)
}
