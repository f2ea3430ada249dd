//! Recording, undoing and redoing the changes of a stroke.

use glam::DVec3;
use isochore_mesh::{Delta, EditDelta, NONE};

use super::{Patch, RenderVertex, Surface};

/// Difference between the surface before and after a stroke. Applied to either, it gives the other.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::session) struct SurfaceDelta {
    topology: EditDelta,
    positions: Delta<DVec3>,
    offsets: Delta<DVec3>,
    frozen: Delta<u32>,
    corners: Delta<[u32; 3]>,
    patches: Delta<Patch>,
    render: Delta<RenderVertex>,
    merges: Delta<[u32; 2]>,
    render_positions: Delta<[f32; 3]>,
    normals: Delta<[f32; 3]>,
}

impl Surface {
    /// Starts recording the changes of a stroke. Returns the number of triangles.
    pub(in crate::session) fn begin(&mut self) -> usize {
        self.bases.clear();
        self.positions.begin();
        self.offsets.begin();
        self.frozen.begin();
        self.corners.begin();
        self.patches.begin();
        self.render.begin();
        self.merges.begin();
        self.render_positions.begin();
        self.normals.begin();
        self.topology.begin()
    }

    /// Stops recording and returns the changes. `alive` is the result of [`begin`](Self::begin).
    pub(in crate::session) fn finish(&mut self, alive: usize) -> SurfaceDelta {
        let mut delta = SurfaceDelta {
            topology: self.topology.finish(alive),
            positions: self.positions.finish(),
            offsets: self.offsets.finish(),
            frozen: self.frozen.finish(),
            corners: self.corners.finish(),
            patches: self.patches.finish(),
            render: self.render.finish(),
            merges: self.merges.finish(),
            render_positions: self.render_positions.finish(),
            normals: self.normals.finish(),
        };
        self.free_render.follow(&self.render, &delta.render, |render| render.vertex == NONE);
        delta.shrink();
        delta
    }

    /// Applies `delta` and replaces it by its inverse.
    pub(in crate::session) fn swap(&mut self, delta: &mut SurfaceDelta) {
        let triangles = self.corners.items().len();
        let vertices = self.positions.items().len();
        rayon::join(
            || {
                self.topology.swap(&mut delta.topology);
                self.positions.swap(&mut delta.positions);
                self.offsets.swap(&mut delta.offsets);
                self.frozen.swap(&mut delta.frozen);
            },
            || {
                self.corners.swap(&mut delta.corners);
                self.patches.swap(&mut delta.patches);
                self.render.swap(&mut delta.render);
                self.merges.swap(&mut delta.merges);
                self.render_positions.swap(&mut delta.render_positions);
                self.normals.swap(&mut delta.normals);
            },
        );

        self.free_render.follow(&self.render, &delta.render, |render| render.vertex == NONE);
        self.renewed.extend(delta.render.indices());
        self.renewed.extend(delta.render.length() as u32..self.render.items().len() as u32);
        delta.render_positions.indices().for_each(|index| self.dirty.positions.mark(index));
        delta.normals.indices().for_each(|index| self.dirty.normals.mark(index));
        delta.corners.indices().for_each(|index| self.dirty.indices.mark(index));
        self.dirty.indices.mark_range(triangles, self.corners.items().len());
        let render = self.render.items().len();
        self.dirty.positions.mark_range(delta.render_positions.length(), render);
        self.dirty.normals.mark_range(delta.normals.length(), render);
        self.write_attributes();
        self.note_addresses();

        // The tree must follow the triangles that moved or were edited.
        let now = self.corners.items().len();
        let moved = delta.positions.indices().chain(delta.offsets.indices());
        let moved: Vec<u32> = moved.filter(|&vertex| (vertex as usize) < vertices).collect();
        let edited: Vec<u32> =
            delta.topology.triangles.indices().filter(|&triangle| (triangle as usize) < now).collect();
        let changed = self.triangles_around(&moved, &edited);
        self.update_tree(&changed);
    }
}

impl SurfaceDelta {
    /// Memory in use.
    pub(in crate::session) fn bytes(&self) -> usize {
        self.topology.bytes()
            + self.positions.bytes()
            + self.offsets.bytes()
            + self.frozen.bytes()
            + self.corners.bytes()
            + self.patches.bytes()
            + self.render.bytes()
            + self.merges.bytes()
            + self.render_positions.bytes()
            + self.normals.bytes()
    }

    fn shrink(&mut self) {
        self.topology.shrink();
        self.positions.shrink();
        self.offsets.shrink();
        self.frozen.shrink();
        self.corners.shrink();
        self.patches.shrink();
        self.render.shrink();
        self.merges.shrink();
        self.render_positions.shrink();
        self.normals.shrink();
    }
}
