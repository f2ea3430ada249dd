//! The surface as a mesh without holes in its numbering.

use glam::DVec3;
use isochore_field::Lock;
use isochore_mesh::{NONE, Origin, Resampling, TriMesh, VertexOrigin};

use super::Session;

/// The surface of a session as a mesh.
#[derive(Debug, Clone)]
pub struct Exported {
    /// The mesh, with all attributes of the one that was opened.
    pub mesh: TriMesh,
    /// By vertex of the mesh the vertex of the session.
    pub vertices: Vec<u32>,
    /// What the locks of all strokes did together; none where it was not asked for, or they did nothing.
    pub lock: Option<Lock>,
}

impl Session {
    /// The surface as it stands, without what was removed; the stroke under way included. Vertices and triangles keep their order.
    ///
    /// Attributes are interpolated once from the mesh as opened, by each corner's origin; shading normals are turned with the
    /// surface. With `lock`, vertices are where the host sees them, which keeps the volume of the mesh as opened: the flow and what
    /// the lock has added at the end of each stroke; the stroke under way has none yet. Without, they are where the flow alone has
    /// taken them, to the bits that the log gives elsewhere.
    pub fn export(&self, lock: bool) -> Exported {
        let surface = &self.surface;
        let mut number = vec![NONE; self.vertex_count()];
        let vertices: Vec<u32> = self.vertices().collect();
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
        let has_lock = lock && surface.offsets.items().iter().any(|&offset| offset != DVec3::ZERO);
        let lock = has_lock.then(|| {
            let shown: Vec<DVec3> = vertices.iter().map(|&vertex| surface.shown(vertex)).collect();
            let unlocked = std::mem::replace(&mut mesh.positions, shown);
            Lock::between(&unlocked, &mesh.positions, &mesh.triangles)
        });
        mesh.turn_normals(&rest);
        Exported { mesh, vertices, lock }
    }

    fn vertex_origin(&self, vertex: u32) -> VertexOrigin {
        if (vertex as usize) < self.surface.opened.positions.len() {
            return VertexOrigin::Vertex(vertex);
        }
        let leaving = self.surface.topology.outgoing(vertex);
        let origin = (leaving != NONE).then(|| self.surface.render.get(self.surface.corner(leaving)).origin).flatten();
        // An inserted vertex that is there has triangles, and its render vertices come from somewhere.
        origin.map_or(VertexOrigin::Vertex(0), VertexOrigin::Point)
    }
}
