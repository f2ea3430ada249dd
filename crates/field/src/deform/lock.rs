//! The volume lock: a last small displacement that restores the volume at rest exactly.
//!
//! Each vertex moves along the gradient of the volume, scaled by the displacement of the vertex from
//! rest. Vertices at rest stay, and vertices of small triangles move least.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use isochore_mesh::Aabb;
use petgraph::unionfind::UnionFind;

use super::balance::{balance, balance_part};

/// Size of a lock's displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lock {
    /// Longest displacement of a vertex, model units.
    pub max_shift: f64,
    /// Largest ratio of a vertex's displacement to the shortest edge at it.
    pub max_shift_per_edge: f64,
}

/// Moves `image` so that its volume is `volume`. Returns `None` and leaves `image` unchanged if no
/// vertex has moved from `rest` or the displacement cannot change the volume.
///
/// `rest` holds the positions of the same vertices at rest. A vertex that has not moved stays.
///
/// ```
/// use isochore_field::lock_volume;
/// use isochore_mesh::{primitives, signed_volume};
///
/// let sphere = primitives::icosphere(1.0, 3);
/// let volume = signed_volume(&sphere.positions, &sphere.triangles);
/// // A stretch of the upper half, which changes the volume.
/// let mut image = sphere.positions.clone();
/// image.iter_mut().filter(|point| point.z > 0.0).for_each(|point| point.z *= 1.1);
/// let lock = lock_volume(&sphere.positions, &mut image, &sphere.triangles, volume).unwrap();
/// assert!((signed_volume(&image, &sphere.triangles) / volume - 1.0).abs() < 1e-13);
/// assert!(lock.max_shift < 0.15);
/// ```
///
/// # Panics
/// If an index is out of range, or `rest` is not as long as `image`.
pub fn lock_volume(rest: &[DVec3], image: &mut [DVec3], triangles: &[[u32; 3]], volume: f64) -> Option<Lock> {
    lock_with_weights(rest, image, triangles, &vec![1.0; image.len()], volume)
}

/// Like [`lock_volume`], with displacements multiplied by a weight for each vertex. A vertex of weight
/// zero stays.
pub(crate) fn lock_with_weights(
    rest: &[DVec3],
    image: &mut [DVec3],
    triangles: &[[u32; 3]],
    weights: &[f64],
    volume: f64,
) -> Option<Lock> {
    let mut directions = directions(rest, image, triangles)?;
    directions.iter_mut().zip(weights).for_each(|(direction, &weight)| *direction *= weight);
    join_twins(rest, triangles, &mut directions);
    let unlocked = image.to_vec();
    balance(image, &directions, triangles, volume)?;
    Some(Lock::between(&unlocked, image, triangles))
}

/// Moves `image`, a part of a closed surface, so that the volume inside the whole surface grows by
/// `gain`. `triangles` must include all triangles at the moved vertices, and `size` is the volume of
/// the whole. Time is proportional to the part. Returns `None` as [`lock_volume`] does.
/// The displacement of each vertex is multiplied by its weight; a vertex of weight zero stays.
///
/// # Panics
/// If an index is out of range, or `rest` or `weights` is not as long as `image`.
pub fn lock_part(
    rest: &[DVec3],
    image: &mut [DVec3],
    triangles: &[[u32; 3]],
    weights: &[f64],
    gain: f64,
    size: f64,
) -> Option<Lock> {
    let mut directions = directions(rest, image, triangles)?;
    directions.iter_mut().zip(weights).for_each(|(direction, &weight)| *direction *= weight);
    let unlocked = image.to_vec();
    balance_part(image, &directions, triangles, gain, size)?;
    Some(Lock::between(&unlocked, image, triangles))
}

/// An edge at rest of at most this fraction of the longest side of the bounds joins twins: vertices that
/// are one point but for rounding. A larger value keeps fine detail from being locked freely; a smaller
/// value pulls twins apart.
const TWIN: f64 = 1e-9;

/// The length of an edge between twins, at most.
fn twin_length(rest: &[DVec3]) -> f64 {
    TWIN * Aabb::of(rest.iter().copied()).size().max_element()
}

/// Gives twins the same direction, the mean of theirs, so that the lock does not pull them apart.
fn join_twins(rest: &[DVec3], triangles: &[[u32; 3]], directions: &mut [DVec3]) {
    let longest = twin_length(rest);
    let mut twins = Vec::new();
    for [a, b, c] in triangles {
        for [a, b] in [[*a, *b], [*b, *c], [*c, *a]] {
            // Each edge inside a surface occurs once in this order.
            if a < b && rest[a as usize].distance(rest[b as usize]) <= longest {
                twins.push([a, b]);
            }
        }
    }
    if twins.is_empty() {
        return;
    }
    let mut groups = UnionFind::<u32>::new(rest.len());
    twins.iter().for_each(|&[a, b]| _ = groups.union(a, b));
    let mut members: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for vertex in twins.iter().flatten().copied().collect::<BTreeSet<u32>>() {
        members.entry(groups.find_mut(vertex)).or_default().push(vertex);
    }
    for group in members.values() {
        let sum: DVec3 = group.iter().map(|&vertex| directions[vertex as usize]).sum();
        group.iter().for_each(|&vertex| directions[vertex as usize] = sum / group.len() as f64);
    }
}

impl Lock {
    /// The size of the displacement from `unlocked` to `locked` positions. Edges between twins, which
    /// are moved alike, do not count.
    pub fn between(unlocked: &[DVec3], locked: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let shift = |vertex: u32| locked[vertex as usize].distance(unlocked[vertex as usize]);
        let max_shift = (0..locked.len() as u32).map(shift).fold(0.0, f64::max);
        let mut max_shift_per_edge: f64 = 0.0;
        let shortest = twin_length(unlocked);
        for [a, b, c] in triangles {
            for (a, b) in [(*a, *b), (*b, *c), (*c, *a)] {
                let length = unlocked[a as usize].distance(unlocked[b as usize]);
                let longest = shift(a).max(shift(b));
                if longest > 0.0 && length > shortest {
                    max_shift_per_edge = max_shift_per_edge.max(longest / length);
                }
            }
        }
        Self { max_shift, max_shift_per_edge }
    }
}

/// The area normal of each vertex, scaled by its displacement relative to the largest. `None` if no
/// vertex has moved or the surface has no area.
fn directions(rest: &[DVec3], image: &[DVec3], triangles: &[[u32; 3]]) -> Option<Vec<DVec3>> {
    let displacements: Vec<f64> = rest.iter().zip(image).map(|(rest, image)| rest.distance(*image)).collect();
    let largest = displacements.iter().copied().fold(0.0, f64::max);
    if largest == 0.0 {
        return None;
    }
    let mut directions = vec![DVec3::ZERO; image.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| image[vertex as usize]);
        // The gradient of the volume at each corner is a third of the area along the normal, which is a
        // sixth of the cross product.
        let gradient = (b - a).cross(c - a) / 6.0;
        for vertex in triangle {
            directions[*vertex as usize] += gradient;
        }
    }
    // Normalized by the largest area normal, so that λ is about the length of the largest shift.
    let scale = directions.iter().map(|direction| direction.length()).fold(0.0, f64::max);
    if scale == 0.0 {
        return None;
    }
    for (direction, displacement) in directions.iter_mut().zip(&displacements) {
        *direction *= displacement / largest / scale;
    }
    Some(directions)
}
