//! The points of the mesh as opened from which vertices that have moved take their attributes.

use isochore_mesh::{NONE, Origin};
use rayon::prelude::*;

use super::{lines::Freedom, remesher::Remesher};

/// Vertices that one task places. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 256;

impl Remesher<'_> {
    /// Gives free vertices that were inserted or have moved the attributes of the reference where
    /// they are, and triangles its materials.
    pub(super) fn place(&mut self) {
        let topology = &self.surface.topology;
        let mut has_stayed = vec![false; self.freedoms.len()];
        for (&vertex, &position) in self.reference.vertices.iter().zip(&self.reference.positions) {
            has_stayed[vertex as usize] = self.surface.position(vertex) == position;
        }
        let is_placed = |&vertex: &u32| {
            self.freedoms[vertex as usize] == Freedom::Free
                && !has_stayed[vertex as usize]
                && topology.outgoing(vertex) != NONE
        };
        let vertices: Vec<u32> = (0..self.freedoms.len() as u32).filter(is_placed).collect();
        let origin = |&vertex: &u32| -> Option<Origin> {
            let anchor = self.anchors[topology.outgoing(vertex) as usize / 3];
            self.reference.origin(&self.surface.opened, &self.reference.foot(anchor, self.surface.position(vertex)))
        };
        let origins: Vec<Option<Origin>> = vertices.par_iter().with_min_len(CHUNK).map(origin).collect();
        for (vertex, origin) in vertices.into_iter().zip(origins) {
            let render = self.surface.corner(self.surface.topology.outgoing(vertex));
            self.surface.set_origin(render, origin);
        }
        for triangle in self.alive() {
            let patch = self.surface.patches.get(triangle);
            let parent = self.reference.parents[self.anchors[triangle as usize] as usize];
            if patch.parent != parent {
                self.surface.set_patch(triangle, crate::session::surface::Patch { parent, ..patch });
            }
        }
    }
}
