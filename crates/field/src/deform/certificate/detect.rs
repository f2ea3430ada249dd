//! Detection of new crossings. Only triangles near those that changed are searched.
//!
//! A crossing pair of triangles is new if the input triangles that contain them do not cross, or
//! are the same triangle. Refined parts of crossing input triangles cross too, and the pairs differ
//! at the ends of the crossing line. Such pairs count as new only if the crossing area, measured at
//! rest, has grown.

use glam::DVec3;
use isochore_mesh::{Aabb, Cancelled, Monitor, SelfIntersectionError, SelfIntersections, TriMesh};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::mark_grid::MarkGrid;
use crate::deform::{passage::Context, tessellation::Tessellation};

/// Growth of the crossing area of the input, measured at rest, above which its crossings count as
/// new. A larger value misses new crossings beside old ones; a smaller value refines where a
/// crossing line merely passes through other parts of the same triangles.
const GROWN: f64 = 1.01;

/// Marks a vertex that is not in the searched part.
const NONE: u32 = u32::MAX;

/// New crossings of a surface.
#[derive(Debug, Default)]
pub(in crate::deform) struct Crossings {
    /// Pairs of triangles that cross.
    pub(in crate::deform) pairs: Vec<[u32; 2]>,
    /// Pairs of triangles with overlapping boxes that were tested.
    pub(in crate::deform) pairs_tested: u64,
}

impl Crossings {
    /// The new crossings at the positions `image` in which a triangle of `changed` takes part.
    pub(in crate::deform) fn of(
        mesh: &Tessellation,
        image: &[DVec3],
        changed: &[u32],
        context: &Context<'_>,
    ) -> Result<Self, Cancelled> {
        let Context { input, monitor, .. } = *context;
        let box_of = |index: u32| Aabb::of(mesh.triangles[index as usize].map(|vertex| image[vertex as usize]));
        if changed.is_empty() {
            return Ok(Self::default());
        }
        let marks = MarkGrid::of(changed.iter().map(|&index| box_of(index)));
        let near: Vec<u32> =
            (0..mesh.triangles.len() as u32).into_par_iter().filter(|&index| marks.is_near(box_of(index))).collect();
        let found = pairs_among(mesh, image, &near, monitor)?;
        let mut crossings = Self { pairs: Vec::new(), pairs_tested: found.pairs_tested };
        if found.pairs.is_empty() {
            return Ok(crossings);
        }
        let is_changed: FxHashSet<u32> = changed.iter().copied().collect();
        let concerned = found.pairs.into_iter().filter(|pair| pair.iter().any(|index| is_changed.contains(index)));
        let known = input.pairs(monitor)?;
        let (old, new) = concerned.partition(|&pair| known.contains(&parents(mesh, pair)));
        crossings.pairs = new;
        if !old.is_empty() {
            crossings.pairs.extend(grown_pairs(mesh, image, old, known, monitor)?);
            crossings.pairs.sort_unstable();
        }
        Ok(crossings)
    }

    pub(in crate::deform) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// The triangles that cross, in ascending order.
    pub(in crate::deform) fn triangles(&self) -> Vec<u32> {
        distinct(self.pairs.iter().copied())
    }
}

/// Of the pairs `old`, whose input triangles cross, those that do not cross at rest. Empty unless the
/// crossing area has grown.
fn grown_pairs(
    mesh: &Tessellation,
    image: &[DVec3],
    old: Vec<[u32; 2]>,
    known: &FxHashSet<[u32; 2]>,
    monitor: &dyn Monitor,
) -> Result<Vec<[u32; 2]>, Cancelled> {
    let crossing_parents: FxHashSet<u32> = known.iter().flatten().copied().collect();
    let parts: Vec<u32> = (0..mesh.triangles.len() as u32)
        .into_par_iter()
        .filter(|&index| crossing_parents.contains(&mesh.parent(index as usize)))
        .collect();
    let crossing_at = |positions: &[DVec3]| -> Result<Vec<[u32; 2]>, Cancelled> {
        let mut pairs = pairs_among(mesh, positions, &parts, monitor)?.pairs;
        pairs.retain(|&pair| known.contains(&parents(mesh, pair)));
        Ok(pairs)
    };
    let (at_rest, now) = (crossing_at(&mesh.rest)?, crossing_at(image)?);
    let rest_area = |pairs: &[[u32; 2]]| mesh.area_at(&mesh.rest, &distinct(pairs.iter().copied()));
    if rest_area(&now) <= GROWN * rest_area(&at_rest) {
        return Ok(Vec::new());
    }
    let at_rest: FxHashSet<[u32; 2]> = at_rest.into_iter().collect();
    Ok(old.into_iter().filter(|pair| !at_rest.contains(pair)).collect())
}

/// The triangles of some pairs, in ascending order.
fn distinct(pairs: impl Iterator<Item = [u32; 2]>) -> Vec<u32> {
    let mut triangles: Vec<u32> = pairs.flatten().collect();
    triangles.sort_unstable();
    triangles.dedup();
    triangles
}

/// The input triangles that contain these two, in ascending order. Two parts of one input triangle
/// have a pair that no input has.
fn parents(mesh: &Tessellation, pair: [u32; 2]) -> [u32; 2] {
    let [a, b] = pair.map(|triangle| mesh.parent(triangle as usize));
    [a.min(b), a.max(b)]
}

/// Pairs among `triangles` that cross at the given positions of the vertices, the smaller index first.
fn pairs_among(
    mesh: &Tessellation,
    positions: &[DVec3],
    triangles: &[u32],
    monitor: &dyn Monitor,
) -> Result<Crossings, Cancelled> {
    if triangles.is_empty() {
        return Ok(Crossings::default());
    }
    let mut number = vec![NONE; positions.len()];
    let mut part = TriMesh::default();
    for &index in triangles {
        part.triangles.push(mesh.triangles[index as usize].map(|vertex| {
            let number = &mut number[vertex as usize];
            if *number == NONE {
                *number = part.positions.len() as u32;
                part.positions.push(positions[vertex as usize]);
            }
            *number
        }));
    }
    match SelfIntersections::of(&part, monitor) {
        Ok(found) => Ok(Crossings {
            pairs: found.pairs().iter().map(|pair| pair.map(|index| triangles[index as usize])).collect(),
            pairs_tested: found.pairs_tested(),
        }),
        Err(SelfIntersectionError::Cancelled(cancelled)) => Err(cancelled),
        // The check of the range reports positions that are not finite. Nothing can be split then.
        Err(_) => Ok(Crossings::default()),
    }
}
