//! The render buffers of the surface.

use isochore_mesh::Origin;

use super::{Patch, RenderVertex, Surface};
use crate::session::buffers::{Changes, RenderBuffers};

impl Surface {
    /// Updates the buffers at `vertices`, whose triangles moved or were edited, and at `loose`
    /// vertices without triangles that moved.
    pub(in crate::session) fn write_buffers(&mut self, vertices: &[u32], loose: impl Iterator<Item = u32>) {
        for vertex in loose {
            // A vertex without triangles has one render vertex, with its own number.
            self.set_render_position(vertex, self.shown(vertex).as_vec3().to_array());
        }
        self.write_attributes();
        self.shade(vertices);
        self.note_addresses();
    }

    /// Sets the render vertices of a triangle.
    pub(in crate::session) fn set_corners(&mut self, triangle: u32, corners: [u32; 3]) {
        self.corners.put(triangle, corners);
        self.dirty.indices.mark(triangle);
    }

    /// Sets the patch of a triangle.
    pub(in crate::session) fn set_patch(&mut self, triangle: u32, patch: Patch) {
        self.patches.put(triangle, patch);
    }

    /// Sets the position of a render vertex.
    pub(in crate::session) fn set_render_position(&mut self, render: u32, position: [f32; 3]) {
        if self.render_positions.get(render) != position {
            self.render_positions.set(render, position);
            self.dirty.positions.mark(render);
        }
    }

    /// Sets the normal of a render vertex.
    pub(in crate::session) fn set_normal(&mut self, render: u32, normal: [f32; 3]) {
        if self.normals.get(render) != normal {
            self.normals.set(render, normal);
            self.dirty.normals.mark(render);
        }
    }

    /// Adds a render vertex at the shown position of its vertex.
    pub(in crate::session) fn add_render_vertex(&mut self, render: RenderVertex) -> u32 {
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

    /// Sets the point of the mesh as opened that a render vertex takes its attributes from.
    pub(in crate::session) fn set_origin(&mut self, index: u32, origin: Option<Origin>) {
        let render = self.render.get(index);
        self.render.set(index, RenderVertex { origin, ..render });
        self.renewed.push(index);
    }

    /// Removes a render vertex that no triangle uses.
    pub(in crate::session) fn remove_render_vertex(&mut self, index: u32) {
        self.render.set(index, RenderVertex::REMOVED);
        self.renewed.push(index);
    }

    /// Whether the mesh as opened has colors.
    pub(super) fn has_colors(&self) -> bool {
        !(self.opened.corner.colors.is_empty() && self.opened.vertex.colors.is_empty())
    }

    /// Resizes texture coordinates and colors, and writes those of added and removed render
    /// vertices.
    pub(super) fn write_attributes(&mut self) {
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

    /// Increases the generation if a buffer has moved in memory.
    pub(super) fn note_addresses(&mut self) {
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

    /// See [`Session::buffers`](crate::session::Session::buffers).
    pub(in crate::session) fn buffers(&self) -> RenderBuffers<'_> {
        RenderBuffers {
            generation: self.dirty.generation,
            positions: self.render_positions.items(),
            normals: self.normals.items(),
            uvs: &self.uvs,
            colors: &self.colors,
            indices: self.corners.items(),
        }
    }

    /// See [`Session::take_changes`](crate::session::Session::take_changes).
    pub(in crate::session) fn take_changes(&mut self) -> Changes {
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
