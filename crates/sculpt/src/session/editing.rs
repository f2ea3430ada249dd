//! Single edits of the surface: topology together with the attributes of triangles and corners.

use glam::DVec3;
use isochore_mesh::{NONE, Split, next_half_edge, previous_half_edge};

use super::{
    origin::midpoint_origin,
    surface::{Patch, RenderVertex, Surface},
};

/// Hard-edge bit of a [`Patch`] for one side, as 0 or 1.
fn bit(patch: Patch, side: usize) -> u8 {
    patch.hard >> (side % 3) & 1
}

impl Surface {
    /// The render vertex at the start of a half-edge, in the triangle of the half-edge.
    #[inline]
    pub(super) fn corner(&self, half_edge: u32) -> u32 {
        self.corners.items()[half_edge as usize / 3][half_edge as usize % 3]
    }

    #[inline]
    pub(super) fn position(&self, vertex: u32) -> DVec3 {
        self.positions.items()[vertex as usize]
    }

    /// Whether both sides of the edge have the same render vertices, shading and material. False
    /// for a seam of any kind and for the boundary.
    pub(super) fn is_seamless(&self, half_edge: u32) -> bool {
        let twin = self.topology.twin(half_edge);
        twin != NONE
            && self.corner(half_edge) == self.corner(next_half_edge(twin))
            && self.corner(next_half_edge(half_edge)) == self.corner(twin)
            && !self.is_hard(half_edge)
            && self.material(half_edge / 3) == self.material(twin / 3)
    }

    fn material(&self, triangle: u32) -> Option<u32> {
        let parent = self.patches.items()[triangle as usize].parent;
        self.opened.triangle_materials.get(parent as usize).copied()
    }

    /// Splits an edge by a vertex at `position`. Returns the split and the volume that it adds.
    pub(super) fn split(&mut self, half_edge: u32, position: DVec3) -> (Split, f64) {
        let twin = self.topology.twin(half_edge);
        let [from, to] = [half_edge, next_half_edge(half_edge)].map(|half_edge| self.corner(half_edge));
        let (near, side) = (half_edge / 3, half_edge as usize % 3);
        let gained = self.volume_under(half_edge, position);

        let split = self.topology.split(half_edge);
        let ends = [from, to].map(|corner| self.offsets.get(self.render.get(corner).vertex));
        self.insert_vertex(split.vertex, position, 0.5 * (ends[0] + ends[1]));
        let inserted = self.insert_corner(split.vertex, [from, to], near);
        let (mut corners, patch) = (self.corners.get(near), self.patches.get(near));
        let apex = corners[(side + 2) % 3];
        corners[(side + 1) % 3] = inserted;
        self.set_corners(near, corners);
        self.set_corners(split.near[1], [inserted, to, apex]);
        let hard = bit(patch, side);
        self.set_patch(near, Patch { hard: patch.hard & !(1 << ((side + 1) % 3)), ..patch });
        self.set_patch(split.near[1], Patch { hard: hard | bit(patch, side + 1) << 1, ..patch });

        let Some([far, added]) = split.far else { return (split, gained) };
        let side = twin as usize % 3;
        let (mut corners, patch) = (self.corners.get(far), self.patches.get(far));
        let (far_to, far_from, apex) = (corners[side], corners[(side + 1) % 3], corners[(side + 2) % 3]);
        let is_seamless = [far_from, far_to] == [from, to];
        let inserted = if is_seamless { inserted } else { self.insert_corner(split.vertex, [far_from, far_to], far) };
        corners[side] = inserted;
        self.set_corners(far, corners);
        self.set_corners(added, [far_to, inserted, apex]);
        self.set_patch(far, Patch { hard: patch.hard & !(1 << ((side + 2) % 3)), ..patch });
        self.set_patch(added, Patch { hard: hard | bit(patch, side + 2) << 2, ..patch });
        (split, gained)
    }

    fn insert_corner(&mut self, vertex: u32, ends: [u32; 2], triangle: u32) -> u32 {
        let [one, other] = ends.map(|end| self.render.items()[end as usize].origin);
        let parent = self.patches.items()[triangle as usize].parent;
        let origin = one.zip(other).map(|(one, other)| midpoint_origin(&self.opened, [one, other], parent));
        self.add_render_vertex(RenderVertex { vertex, origin })
    }

    /// Volume between the two triangles at an edge and those that a vertex at `position` splits
    /// them into.
    fn volume_under(&self, half_edge: u32, position: DVec3) -> f64 {
        let a = self.position(self.topology.start(half_edge));
        let b = self.position(self.topology.end(half_edge)) - a;
        let position = position - a;
        let apex = |half_edge: u32| self.position(self.topology.start(previous_half_edge(half_edge))) - a;
        let near = position.dot(b.cross(apex(half_edge)));
        let twin = self.topology.twin(half_edge);
        let far = if twin == NONE { 0.0 } else { b.dot(position.cross(apex(twin))) };
        (near + far) / 6.0
    }

    /// Flips a seamless edge and returns the volume that this adds. Requires
    /// [`EditMesh::can_flip`].
    ///
    /// [`EditMesh::can_flip`]: isochore_mesh::EditMesh::can_flip
    pub(super) fn flip(&mut self, half_edge: u32) -> f64 {
        let twin = self.topology.twin(half_edge);
        let gained = self.volume_of_flip(half_edge);
        let ([near, far], [side, far_side]) =
            ([half_edge, twin].map(|h| h / 3), [half_edge, twin].map(|h| h as usize % 3));
        let [mut corners, mut far_corners] = [near, far].map(|triangle| self.corners.get(triangle));
        let (apex, far_apex) = (corners[(side + 2) % 3], far_corners[(far_side + 2) % 3]);
        let [patch, far_patch] = [near, far].map(|triangle| self.patches.get(triangle));
        self.topology.flip(half_edge);
        corners[(side + 1) % 3] = far_apex;
        far_corners[(far_side + 1) % 3] = apex;
        self.set_corners(near, corners);
        self.set_corners(far, far_corners);
        // Each triangle passes the edge after the flipped one to the other triangle.
        let hard = |own: Patch, side: usize, other: Patch, other_side: usize| {
            bit(other, other_side + 1) << side | bit(own, side + 2) << ((side + 2) % 3)
        };
        self.set_patch(near, Patch { hard: hard(patch, side, far_patch, far_side), ..patch });
        self.set_patch(far, Patch { hard: hard(far_patch, far_side, patch, side), ..far_patch });
        gained
    }

    /// Volume that flipping an edge adds: the tetrahedron of the two triangles.
    pub(super) fn volume_of_flip(&self, half_edge: u32) -> f64 {
        let twin = self.topology.twin(half_edge);
        let a = self.position(self.topology.start(half_edge));
        let b = self.position(self.topology.end(half_edge)) - a;
        let [c, d] = [half_edge, twin].map(|side| self.position(self.topology.start(previous_half_edge(side))) - a);
        d.dot(b.cross(c)) / 6.0
    }

    /// Merges the start of a half-edge into its end and returns the volume that this adds. Requires
    /// [`EditMesh::can_collapse`], and that the start [is free](Self::is_free) or that it is between
    /// two edges of one seam, of which the half-edge is one.
    ///
    /// [`EditMesh::can_collapse`]: isochore_mesh::EditMesh::can_collapse
    pub(super) fn collapse(&mut self, half_edge: u32) -> f64 {
        let twin = self.topology.twin(half_edge);
        let gained = self.volume_of_collapse(half_edge);
        // The render vertices of start and end on each side.
        let near = [half_edge, next_half_edge(half_edge)].map(|half_edge| self.corner(half_edge));
        let far =
            if twin == NONE { near } else { [next_half_edge(twin), twin].map(|half_edge| self.corner(half_edge)) };
        // Outer edges of the removed triangles: each passes its hard-edge bit to the edge it is merged
        // with.
        let mut inherited = [(NONE, 0); 2];
        let patch = self.patches.get(half_edge / 3);
        inherited[0] = (self.topology.twin(previous_half_edge(half_edge)), bit(patch, half_edge as usize % 3 + 1));
        if twin != NONE {
            let patch = self.patches.get(twin / 3);
            inherited[1] = (self.topology.twin(next_half_edge(twin)), bit(patch, twin as usize % 3 + 2));
        }
        let [start, end] = [self.topology.start(half_edge), self.topology.end(half_edge)];
        let fan: Vec<u32> = self.topology.fan(start).collect();
        self.topology.collapse(half_edge);
        self.merges.push([start, end]);
        self.remove_render_vertex(near[0]);
        if far[0] != near[0] {
            self.remove_render_vertex(far[0]);
        }
        for outgoing in fan {
            let mut corners = self.corners.get(outgoing / 3);
            let corner = &mut corners[outgoing as usize % 3];
            *corner = if *corner == near[0] { near[1] } else { far[1] };
            let is_alive = self.topology.triangles()[outgoing as usize / 3].is_alive();
            self.set_corners(outgoing / 3, if is_alive { corners } else { [0; 3] });
        }
        for (half_edge, hard) in inherited.into_iter().filter(|&(half_edge, _)| half_edge != NONE) {
            let patch = self.patches.get(half_edge / 3);
            let side = half_edge % 3;
            self.set_patch(half_edge / 3, Patch { hard: patch.hard & !(1 << side) | hard << side, ..patch });
        }
        gained
    }

    /// Volume that merging the start of a half-edge into its end adds.
    pub(super) fn volume_of_collapse(&self, half_edge: u32) -> f64 {
        let kept = self.topology.end(half_edge);
        let origin = self.position(kept);
        // With the kept vertex as origin, all new triangles have volume zero, so the change is
        // minus the old volume of the fan.
        let lost: f64 = self
            .topology
            .fan(self.topology.start(half_edge))
            .map(|outgoing| {
                let corners = self.topology.triangles()[outgoing as usize / 3].vertices;
                let [a, b, c] = corners.map(|vertex| self.position(vertex) - origin);
                a.dot(b.cross(c))
            })
            .sum();
        -lost / 6.0
    }

    /// Whether a vertex has only seamless edges: it is not on a seam, a hard edge, a border between
    /// materials or the boundary.
    pub(super) fn is_free(&self, vertex: u32) -> bool {
        self.topology.outgoing(vertex) != NONE && self.topology.fan(vertex).all(|half_edge| self.is_seamless(half_edge))
    }
}
