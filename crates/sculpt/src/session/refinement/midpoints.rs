//! Images of the midpoints of edges.

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::session::{path::Path, surface::Surface};

/// The midpoint of an edge of the base, advected through some moves.
#[derive(Debug, Clone, Copy)]
struct Midpoint {
    image: DVec3,
    /// Number of moves of the path that it has passed.
    passed: u32,
}

/// Images of the midpoints of edges of the base. Each is advected once through each move, and only
/// as far as it is needed.
#[derive(Debug, Clone, Default)]
pub(in crate::session) struct Midpoints {
    /// By the ends of the edge, the smaller first. Entries of edges that do not exist any more stay:
    /// no number of a vertex gets another meaning before the stroke ends.
    known: FxHashMap<[u32; 2], Midpoint>,
}

/// Images of the midpoints of some edges.
pub(in crate::session) struct Followed {
    pub(in crate::session) images: Vec<DVec3>,
    /// Evaluations of the field.
    pub(in crate::session) evaluations: u64,
}

impl Midpoints {
    /// Forgets all midpoints, because the base or the path has changed.
    pub(in crate::session) fn clear(&mut self) {
        self.known.clear();
    }

    /// Images of the midpoints of `edges` after the whole path.
    pub(in crate::session) fn follow(&mut self, surface: &Surface, path: &Path, edges: &[[u32; 2]]) -> Followed {
        let start = |&ends: &[u32; 2]| {
            let base = || Midpoint { image: surface.base_midpoint(ends), passed: 0 };
            self.known.get(&ends).copied().unwrap_or_else(base)
        };
        let started: Vec<Midpoint> = edges.iter().map(start).collect();
        let mut order: Vec<u32> = (0..edges.len() as u32).collect();
        order.sort_by_key(|&index| started[index as usize].passed);
        let passed: Vec<u32> = order.iter().map(|&index| started[index as usize].passed).collect();
        let mut points: Vec<DVec3> = order.iter().map(|&index| started[index as usize].image).collect();
        let evaluations = path.advect_rest(&mut points, &passed);
        let mut images = vec![DVec3::ZERO; edges.len()];
        for (&index, image) in order.iter().zip(points) {
            images[index as usize] = image;
            self.known.insert(edges[index as usize], Midpoint { image, passed: path.len() as u32 });
        }
        Followed { images, evaluations }
    }
}
