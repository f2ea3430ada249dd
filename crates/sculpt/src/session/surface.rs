//! The surface of a session: topology, positions, attributes and buffers, edited together and undone together.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, Delta, EditDelta, EditMesh, FreeSlots, Journaled, NONE, Origin, SurfaceTree, TriMesh};

use super::{
    NormalWeights,
    buffers::{Changes, DirtyPages, RenderBuffers},
    inserted::InsertedVertices,
    marks::Marks,
};

/// A vertex as the triangles on one side of a seam see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RenderVertex {
    pub(super) vertex: u32,
    /// Where it takes its attributes from; none for a vertex without triangles.
    pub(super) origin: Option<Origin>,
}

impl RenderVertex {
    /// One that shows nothing any more.
    pub(super) const REMOVED: Self = Self { vertex: NONE, origin: None };
}

/// What a triangle has from the mesh as opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Patch {
    /// A triangle of the mesh as opened that holds it, or a part of it.
    pub(super) parent: u32,
    /// By edge, whether shading breaks there: bits 0, 1 and 2.
    pub(super) hard: u8,
}

#[derive(Debug, Clone)]
pub(super) struct Surface {
    pub(super) opened: Arc<TriMesh>,
    pub(super) topology: EditMesh,
    /// Where the flow has taken the vertices.
    pub(super) positions: Journaled<DVec3>,
    /// What the locks of the strokes add to that for the eyes of the host.
    pub(super) offsets: Journaled<DVec3>,
    /// By vertex the number of the call that froze its edges last, zero for none.
    frozen: Journaled<u32>,
    /// Calls so far that froze edges. Only what the last one named is frozen: undo may bring back vertices that earlier ones did.
    freezes: u32,
    /// By triangle its render vertices, all zero where it was removed: the index buffer itself.
    pub(super) corners: Journaled<[u32; 3]>,
    pub(super) patches: Journaled<Patch>,
    /// Nothing in it is ever changed, but removed, and its place taken.
    pub(super) render: Journaled<RenderVertex>,
    free_render: FreeSlots,
    /// All collapses so far, in order: the vertex that was removed, and the one in its place. They stay as long as the log does.
    pub(super) merges: Journaled<[u32; 2]>,
    /// Render vertices whose texture coordinates and colors are to be written.
    renewed: Vec<u32>,
    pub(super) render_positions: Journaled<[f32; 3]>,
    pub(super) normals: Journaled<[f32; 3]>,
    uvs: Vec<Vec<[f32; 2]>>,
    colors: Vec<[f32; 4]>,
    pub(super) tree: SurfaceTree,
    pub(super) weights: NormalWeights,
    /// Whether shading breaks anywhere.
    pub(super) has_hard_edges: bool,
    dirty: Dirty,
    pub(super) inserted: InsertedVertices,
    /// Scratch.
    pub(super) triangle_marks: Marks,
    pub(super) vertex_marks: Marks,
}

#[derive(Debug, Clone, Default)]
struct Dirty {
    generation: u64,
    addresses: Vec<usize>,
    positions: DirtyPages,
    normals: DirtyPages,
    attributes: DirtyPages,
    indices: DirtyPages,
}

/// The way to the other end of a stroke.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SurfaceDelta {
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

/// Room in all arrays beyond what the mesh needs as opened, as a share of it, so that addresses stay for a while and no early move
/// waits for a large mesh to be copied. Larger spends memory on meshes that hardly grow; smaller, moves that take long.
const SPARE_ROOM: f64 = 0.125;

impl Surface {
    /// Puts the parts together and fills the buffers.
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
            inserted: InsertedVertices::new(opened.positions.len()),
            normals: Journaled::new(vec![[0.0; 3]; count]),
            uvs: vec![Vec::new(); opened.corner.uvs.len()],
            colors: Vec::new(),
            tree,
            weights,
            dirty: Dirty::default(),
            triangle_marks: Marks::default(),
            vertex_marks: Marks::default(),
            opened,
        };
        let spare = |length: usize| (length as f64 * SPARE_ROOM) as usize + 1024;
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

    /// Corners of a triangle that is there.
    #[inline]
    pub(super) fn corners_of(&self, triangle: u32) -> Option<[DVec3; 3]> {
        let triangle = &self.topology.triangles()[triangle as usize];
        let positions = self.positions.items();
        triangle.is_alive().then(|| triangle.vertices.map(|vertex| positions[vertex as usize]))
    }

    /// Where the host sees a vertex.
    #[inline]
    pub(super) fn shown(&self, vertex: u32) -> DVec3 {
        let (position, offset) = (self.positions.get(vertex), self.offsets.get(vertex));
        // Adding zero would turn a coordinate of −0 into +0.
        if offset == DVec3::ZERO { position } else { position + offset }
    }

    /// Where the host sees the corners of a triangle that is there.
    pub(super) fn shown_corners(&self, triangle: u32) -> Option<[DVec3; 3]> {
        let triangle = &self.topology.triangles()[triangle as usize];
        triangle.is_alive().then(|| triangle.vertices.map(|vertex| self.shown(vertex)))
    }

    /// Freezes the edges at `vertices`, and frees all others.
    pub(super) fn freeze(&mut self, vertices: impl Iterator<Item = u32>) {
        self.freezes = self.freezes.wrapping_add(1).max(1);
        vertices.for_each(|vertex| self.frozen.amend(vertex, self.freezes));
    }

    /// Takes in a vertex that a split inserted, with its edges free.
    pub(super) fn insert_vertex(&mut self, vertex: u32, position: DVec3, offset: DVec3) {
        self.positions.put(vertex, position);
        self.offsets.put(vertex, offset);
        self.frozen.put(vertex, 0);
    }

    /// Whether the edges at a vertex stay.
    pub(super) fn is_frozen(&self, vertex: u32) -> bool {
        self.freezes != 0 && self.frozen.get(vertex) == self.freezes
    }

    pub(super) fn begin(&mut self) -> usize {
        self.inserted.clear();
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

    pub(super) fn finish(&mut self, alive: usize) -> SurfaceDelta {
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

    /// Takes everything to the other end of `delta`.
    pub(super) fn swap(&mut self, delta: &mut SurfaceDelta) {
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

        // The boxes: around what moved, and what was edited.
        let now = self.corners.items().len();
        let moved = delta.positions.indices().chain(delta.offsets.indices());
        let moved: Vec<u32> = moved.filter(|&vertex| (vertex as usize) < vertices).collect();
        let edited: Vec<u32> =
            delta.topology.triangles.indices().filter(|&triangle| (triangle as usize) < now).collect();
        let changed = self.triangles_around(&moved, &edited);
        self.update_tree(&changed);
    }

    /// Lets the tree follow triangles that moved or were edited, and those that are new or gone.
    pub(super) fn update_tree(&mut self, changed: &[u32]) {
        let triangles = self.topology.triangles();
        let (positions, offsets) = (&self.positions, &self.offsets);
        // Around where the flow has taken them and where the host sees them.
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

    /// Brings the buffers up to date at `vertices`, which have triangles that moved or were edited, and where `loose` vertices,
    /// which have none, moved.
    pub(super) fn write_buffers(&mut self, vertices: &[u32], loose: impl Iterator<Item = u32>) {
        for vertex in loose {
            // Without triangles, a vertex is its own render vertex.
            self.set_render_position(vertex, self.shown(vertex).as_vec3().to_array());
        }
        self.write_attributes();
        self.shade(vertices);
        self.note_addresses();
    }

    /// Sets the render vertices of a triangle.
    pub(super) fn set_corners(&mut self, triangle: u32, corners: [u32; 3]) {
        self.corners.put(triangle, corners);
        self.dirty.indices.mark(triangle);
    }

    pub(super) fn set_patch(&mut self, triangle: u32, patch: Patch) {
        self.patches.put(triangle, patch);
    }

    /// Sets the position of a render vertex.
    pub(super) fn set_render_position(&mut self, render: u32, position: [f32; 3]) {
        if self.render_positions.get(render) != position {
            self.render_positions.set(render, position);
            self.dirty.positions.mark(render);
        }
    }

    /// Sets the normal of a render vertex.
    pub(super) fn set_normal(&mut self, render: u32, normal: [f32; 3]) {
        if self.normals.get(render) != normal {
            self.normals.set(render, normal);
            self.dirty.normals.mark(render);
        }
    }

    /// Adds a render vertex of a vertex that stands where it is.
    pub(super) fn add_render_vertex(&mut self, render: RenderVertex) -> u32 {
        let position = self.shown(render.vertex).as_vec3().to_array();
        let index = self.free_render.take(self.render.items().len());
        self.render_positions.put(index, position);
        self.normals.put(index, [0.0; 3]);
        self.render.put(index, render);
        self.renewed.push(index);
        self.dirty.positions.mark(index);
        self.dirty.normals.mark(index);
        index
    }

    /// Removes a render vertex that no triangle has any more.
    pub(super) fn remove_render_vertex(&mut self, index: u32) {
        self.render.set(index, RenderVertex::REMOVED);
        self.renewed.push(index);
    }

    fn has_colors(&self) -> bool {
        !(self.opened.corner.colors.is_empty() && self.opened.vertex.colors.is_empty())
    }

    /// Writes texture coordinates and colors of the render vertices that are new, or were removed, and makes their number right.
    fn write_attributes(&mut self) {
        let count = self.render.items().len();
        let (opened, render) = (&self.opened, self.render.items());
        self.renewed.retain(|&index| (index as usize) < count);
        for (index, set) in self.uvs.iter_mut().enumerate() {
            set.resize(count, [0.0; 2]);
            for &renewed in &self.renewed {
                let origin = &render[renewed as usize].origin;
                set[renewed as usize] =
                    origin.as_ref().map_or([0.0; 2], |origin| opened.uv_at(index, origin).to_array());
            }
        }
        if !(opened.corner.colors.is_empty() && opened.vertex.colors.is_empty()) {
            self.colors.resize(count, [0.0; 4]);
            for &renewed in &self.renewed {
                let RenderVertex { vertex, origin } = &render[renewed as usize];
                let own = || opened.vertex.colors.get(*vertex as usize).copied();
                let color = origin.as_ref().map_or_else(own, |origin| opened.color_at(origin));
                self.colors[renewed as usize] = color.unwrap_or_default().as_vec4().to_array();
            }
        }
        self.renewed.drain(..).for_each(|index| self.dirty.attributes.mark(index));
    }

    /// Notes whether a buffer has moved.
    fn note_addresses(&mut self) {
        let fixed = [
            self.render_positions.items().as_ptr() as usize,
            self.normals.items().as_ptr() as usize,
            self.corners.items().as_ptr() as usize,
            self.colors.as_ptr() as usize,
        ];
        let now = fixed.into_iter().chain(self.uvs.iter().map(|set| set.as_ptr() as usize));
        if !now.clone().eq(self.dirty.addresses.iter().copied()) {
            self.dirty.addresses = now.collect();
            self.dirty.generation += 1;
        }
    }

    pub(super) fn buffers(&self) -> RenderBuffers<'_> {
        RenderBuffers {
            generation: self.dirty.generation,
            positions: self.render_positions.items(),
            normals: self.normals.items(),
            uvs: &self.uvs,
            colors: &self.colors,
            indices: self.corners.items(),
        }
    }

    pub(super) fn take_changes(&mut self) -> Changes {
        let render = self.render.items().len();
        Changes {
            generation: self.dirty.generation,
            positions: self.dirty.positions.take(render),
            normals: self.dirty.normals.take(render),
            attributes: self.dirty.attributes.take(render),
            indices: self.dirty.indices.take(self.corners.items().len()),
        }
    }
}

impl SurfaceDelta {
    pub(super) fn bytes(&self) -> usize {
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
