//! The surface as a mesh without holes in its numbering.

use glam::DVec3;
use isochore_field::{Lock, lock_volume};
use isochore_mesh::{NONE, Origin, Resampling, TriMesh, VertexOrigin};

use super::Session;

/// The surface of a session as a mesh.
#[derive(Debug, Clone)]
pub struct Exported {
    /// The mesh, with all attributes of the one that was opened.
    pub mesh: TriMesh,
    /// By vertex of the mesh the vertex of the session.
    pub vertices: Vec<u32>,
    /// What the volume lock did; none where it was not asked for, or found nothing to do.
    pub lock: Option<Lock>,
}

impl Session {
    /// The surface as it stands, without what was removed; the stroke under way included. Vertices and triangles keep their order.
    ///
    /// Attributes are interpolated once from the mesh as opened, by each corner's origin; shading normals are turned with the
    /// surface. With `lock`, a small displacement of all that has moved gives back the volume of the mesh as opened exactly. A
    /// session never locks by itself: the next stroke would set out from what no flow has made, and its log would give another
    /// result elsewhere.
    pub fn export(&self, lock: bool) -> Exported {
        let surface = &self.surface;
        let count = self.vertex_count();
        let mut number = vec![NONE; count];
        let vertices: Vec<u32> = (0..count as u32).filter(|&vertex| self.is_alive(vertex)).collect();
        for (index, &vertex) in vertices.iter().enumerate() {
            number[vertex as usize] = index as u32;
        }
        let alive =
            || (0..surface.corners.items().len()).filter(|&triangle| surface.topology.triangles()[triangle].is_alive());
        let origin = |render: u32| surface.render.get(render).origin;
        let lost = Origin { triangle: 0, weights: DVec3::X };
        let resampling = Resampling {
            positions: vertices.iter().map(|&vertex| surface.position(vertex)).collect(),
            triangles: alive()
                .map(|triangle| surface.topology.triangles()[triangle].vertices.map(|vertex| number[vertex as usize]))
                .collect(),
            parents: alive().map(|triangle| surface.patches.items()[triangle].parent).collect(),
            corners: alive()
                .map(|triangle| surface.corners.items()[triangle].map(|render| origin(render).unwrap_or(lost)))
                .collect(),
            vertices: vertices.iter().map(|&vertex| self.vertex_origin(vertex)).collect(),
        };
        let opened = &*surface.opened;
        let rest = |origin: &VertexOrigin| match origin {
            VertexOrigin::Vertex(vertex) => opened.positions[*vertex as usize],
            VertexOrigin::Point(origin) => opened.point_at(origin),
        };
        let rest: Vec<DVec3> = resampling.vertices.iter().map(rest).collect();
        let mut mesh = opened.resampled(&resampling);
        let mut done = None;
        if let Some(volume) = self.opened_volume.filter(|_| lock) {
            done = lock_volume(&rest, &mut mesh.positions, &mesh.triangles, volume);
        }
        mesh.turn_normals(&rest);
        Exported { mesh, vertices, lock: done }
    }

    fn vertex_origin(&self, vertex: u32) -> VertexOrigin {
        if (vertex as usize) < self.surface.opened.positions.len() {
            return VertexOrigin::Vertex(vertex);
        }
        let leaving = self.surface.topology.leaving(vertex);
        let origin = (leaving != NONE).then(|| self.surface.render.get(self.surface.corner(leaving)).origin).flatten();
        // An inserted vertex that is there has triangles, and its render vertices come from somewhere.
        origin.map_or(VertexOrigin::Vertex(0), VertexOrigin::Point)
    }
}
