//! The surface of a session: topology, positions, attributes and buffers, which are edited and
//! undone together.

pub(super) mod delta;
mod rendering;

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, EditMesh, FreeSlots, Journaled, NONE, Origin, SurfaceTree, TriMesh};

use super::{NormalWeights, base_points::BasePoints, buffers::DirtyBuffers, marks::Marks};

/// A vertex as seen by the triangles on one side of a seam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RenderVertex {
    pub(super) vertex: u32,
    /// Point of the mesh as opened that its attributes are taken from. `None` for a vertex without
    /// triangles.
    pub(super) origin: Option<Origin>,
}

impl RenderVertex {
    /// Removed render vertex.
    pub(super) const REMOVED: Self = Self { vertex: NONE, origin: None };
}

/// Data that a triangle inherits from the mesh as opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Patch {
    /// The triangle of the mesh as opened that contains the triangle or a part of it.
    pub(super) parent: u32,
    /// Hard edges, across which shading is discontinuous: bits 0, 1 and 2.
    pub(super) hard: u8,
}

#[derive(Debug, Clone)]
pub(super) struct Surface {
    pub(super) opened: Arc<TriMesh>,
    pub(super) topology: EditMesh,
    /// Positions of the flow.
    pub(super) positions: Journaled<DVec3>,
    /// Displacements by the locks of the strokes. The host sees position plus offset.
    pub(super) offsets: Journaled<DVec3>,
    /// For each vertex, the number of the last call that froze its edges, or zero.
    frozen: Journaled<u32>,
    /// Number of calls that froze edges. Only edges of the last call are frozen. Undo may restore
    /// vertices that an earlier call froze.
    freezes: u32,
    /// Render vertices of each triangle, all zero if it is removed. This is the index buffer.
    pub(super) corners: Journaled<[u32; 3]>,
    pub(super) patches: Journaled<Patch>,
    /// Entries are immutable; they are removed and their slots reused.
    pub(super) render: Journaled<RenderVertex>,
    free_render: FreeSlots,
    /// All collapses so far, in order: the removed vertex and the vertex that it was merged into.
    /// Never shortened, except by undo.
    pub(super) merges: Journaled<[u32; 2]>,
    /// Render vertices whose texture coordinates and colors are out of date.
    renewed: Vec<u32>,
    pub(super) render_positions: Journaled<[f32; 3]>,
    pub(super) normals: Journaled<[f32; 3]>,
    uvs: Vec<Vec<[f32; 2]>>,
    colors: Vec<[f32; 4]>,
    pub(super) tree: SurfaceTree,
    pub(super) weights: NormalWeights,
    /// Whether the mesh has any hard edge.
    pub(super) has_hard_edges: bool,
    dirty: DirtyBuffers,
    pub(super) bases: BasePoints,
    /// Scratch sets of the selections.
    pub(super) triangle_marks: Marks,
    pub(super) vertex_marks: Marks,
    /// Scratch numbers of vertices in a part of the surface.
    pub(super) numbers: Vec<u32>,
}

/// Spare capacity of all arrays as a fraction of the size of the mesh as opened, so that the
/// buffers keep their addresses for a while and no early move waits for a large mesh to be copied.
/// Larger wastes memory on meshes that hardly grow; smaller makes slow moves likelier.
const SPARE_CAPACITY: f64 = 0.125;

impl Surface {
    /// Assembles the surface and fills the buffers.
    pub(super) fn new(
        opened: Arc<TriMesh>,
        topology: EditMesh,
        corners: Vec<[u32; 3]>,
        patches: Vec<Patch>,
        render: Vec<RenderVertex>,
        tree: SurfaceTree,
        weights: NormalWeights,
    ) -> Self {
        let count = render.len();
        let position = |render: &RenderVertex| opened.positions[render.vertex as usize].as_vec3().to_array();
        let mut surface = Self {
            topology,
            positions: Journaled::new(opened.positions.clone()),
            offsets: Journaled::new(vec![DVec3::ZERO; opened.positions.len()]),
            frozen: Journaled::new(vec![0; opened.positions.len()]),
            freezes: 0,
            render_positions: Journaled::new(render.iter().map(position).collect()),
            corners: Journaled::new(corners),
            has_hard_edges: patches.iter().any(|patch| patch.hard != 0),
            patches: Journaled::new(patches),
            render: Journaled::new(render),
            free_render: FreeSlots::new(count as u32),
            merges: Journaled::default(),
            renewed: (0..count as u32).collect(),
            bases: BasePoints::default(),
            normals: Journaled::new(vec![[0.0; 3]; count]),
            uvs: vec![Vec::new(); opened.corner.uvs.len()],
            colors: Vec::new(),
            tree,
            weights,
            dirty: DirtyBuffers::default(),
            triangle_marks: Marks::default(),
            vertex_marks: Marks::default(),
            numbers: Vec::new(),
            opened,
        };
        let spare = |length: usize| (length as f64 * SPARE_CAPACITY) as usize + 1024;
        let triangles = spare(surface.corners.items().len());
        surface.topology.reserve(spare(surface.topology.vertex_count()), triangles);
        surface.positions.reserve(spare(surface.positions.items().len()));
        surface.offsets.reserve(spare(surface.positions.items().len()));
        surface.frozen.reserve(spare(surface.positions.items().len()));
        surface.corners.reserve(triangles);
        surface.patches.reserve(triangles);
        surface.tree.reserve(triangles);
        surface.render.reserve(spare(count));
        surface.render_positions.reserve(spare(count));
        surface.normals.reserve(spare(count));
        surface.uvs.iter_mut().for_each(|set| set.reserve(count + spare(count)));
        if surface.has_colors() {
            surface.colors.reserve(count + spare(count));
        }
        surface.write_attributes();
        let all: Vec<u32> = (0..surface.topology.vertex_count() as u32).collect();
        surface.shade(&all);
        surface.dirty.positions.mark_range(0, count);
        surface.dirty.indices.mark_range(0, surface.corners.items().len());
        surface.note_addresses();
        surface
    }

    /// Position of a vertex on the base.
    pub(super) fn base(&self, vertex: u32) -> DVec3 {
        let existing = || self.positions.original(vertex).unwrap_or_else(|| self.positions.get(vertex));
        self.bases.position(vertex).unwrap_or_else(existing)
    }

    /// Position of a vertex on the surface at the beginning of the stroke. For a vertex that the
    /// stroke has inserted, the corresponding point of that surface.
    pub(super) fn start(&self, vertex: u32) -> DVec3 {
        let existing = || self.positions.original(vertex).unwrap_or_else(|| self.positions.get(vertex));
        self.bases.inserted_at(vertex).unwrap_or_else(existing)
    }

    /// Midpoint of the edge between two vertices on the surface at the beginning of the stroke.
    pub(super) fn start_midpoint(&self, ends: [u32; 2]) -> DVec3 {
        let [a, b] = ends.map(|vertex| self.start(vertex));
        0.5 * (a + b)
    }

    /// Midpoint of the edge between two vertices on the base.
    pub(super) fn base_midpoint(&self, ends: [u32; 2]) -> DVec3 {
        let [a, b] = ends.map(|vertex| self.base(vertex));
        0.5 * (a + b)
    }

    /// Ends of the edges 01, 12 and 20 of a triangle, the smaller first.
    pub(super) fn edges_of(&self, triangle: u32) -> [[u32; 2]; 3] {
        let [a, b, c] = self.topology.triangles()[triangle as usize].vertices;
        [[a, b], [b, c], [c, a]].map(|[one, other]| [one.min(other), one.max(other)])
    }

    /// The longest edge of a triangle. Ties go to the edge with the larger ends, so that both
    /// triangles at an edge agree.
    pub(super) fn longest_edge(&self, triangle: u32) -> [u32; 2] {
        let edges = self.edges_of(triangle);
        let lengths = edges.map(|[a, b]| self.position(a).distance_squared(self.position(b)));
        let order =
            |&one: &usize, &other: &usize| lengths[one].total_cmp(&lengths[other]).then(edges[one].cmp(&edges[other]));
        (0..3).max_by(order).map_or(edges[0], |side| edges[side])
    }

    /// A half-edge between two vertices. `None` if no edge connects them.
    pub(super) fn half_edge(&self, [a, b]: [u32; 2]) -> Option<u32> {
        // A boundary edge has a half-edge in one direction only.
        self.topology.half_edge(a, b).or_else(|| self.topology.half_edge(b, a))
    }

    /// The triangles on both sides of an edge; [`NONE`] beyond the boundary.
    pub(super) fn triangles_beside(&self, half_edge: u32) -> [u32; 2] {
        let twin = self.topology.twin(half_edge);
        [half_edge / 3, if twin == NONE { NONE } else { twin / 3 }]
    }

    /// Corners of a triangle. `None` if it is removed.
    #[inline]
    pub(super) fn corners_of(&self, triangle: u32) -> Option<[DVec3; 3]> {
        let triangle = &self.topology.triangles()[triangle as usize];
        let positions = self.positions.items();
        triangle.is_alive().then(|| triangle.vertices.map(|vertex| positions[vertex as usize]))
    }

    /// Position of a vertex that the host sees.
    #[inline]
    pub(super) fn shown(&self, vertex: u32) -> DVec3 {
        let (position, offset) = (self.positions.get(vertex), self.offsets.get(vertex));
        // Adding zero would turn a coordinate of −0 into +0.
        if offset == DVec3::ZERO { position } else { position + offset }
    }

    /// Corners of a triangle that the host sees. `None` if it is removed.
    pub(super) fn shown_corners(&self, triangle: u32) -> Option<[DVec3; 3]> {
        let triangle = &self.topology.triangles()[triangle as usize];
        triangle.is_alive().then(|| triangle.vertices.map(|vertex| self.shown(vertex)))
    }

    /// Freezes the edges at `vertices` and releases all others.
    pub(super) fn freeze(&mut self, vertices: impl Iterator<Item = u32>) {
        self.freezes = self.freezes.wrapping_add(1).max(1);
        vertices.for_each(|vertex| self.frozen.amend(vertex, self.freezes));
    }

    /// Adds a vertex that a split has inserted. Its edges are not frozen.
    pub(super) fn insert_vertex(&mut self, vertex: u32, position: DVec3, offset: DVec3) {
        self.positions.put(vertex, position);
        self.offsets.put(vertex, offset);
        self.frozen.put(vertex, 0);
    }

    /// Whether the edges at a vertex are frozen.
    pub(super) fn is_frozen(&self, vertex: u32) -> bool {
        self.freezes != 0 && self.frozen.get(vertex) == self.freezes
    }

    /// Updates the tree for the triangles `changed`, which moved or were edited, added or removed.
    pub(super) fn update_tree(&mut self, changed: &[u32]) {
        let triangles = self.topology.triangles();
        let (positions, offsets) = (&self.positions, &self.offsets);
        // The boxes contain the positions of the flow and those that the host sees, as strokes and
        // picks both search the tree.
        let bounds = |triangle: u32| {
            let triangle = &triangles[triangle as usize];
            let ends = |vertex| {
                let position = positions.get(vertex);
                [position, position + offsets.get(vertex)]
            };
            let corners = triangle.is_alive().then(|| triangle.vertices.map(ends));
            Aabb::of(corners.into_iter().flatten().flatten())
        };
        let near = |triangle: u32| {
            let triangle = &triangles[triangle as usize];
            triangle.is_alive().then(|| triangle.twins.map(|twin| if twin == NONE { NONE } else { twin / 3 }))
        };
        self.tree.update(triangles.len(), changed, &bounds, &near);
    }
}
