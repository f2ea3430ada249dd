//! Export of the surface as a mesh with consecutive numbers.

use glam::DVec3;
use isochore_field::Lock;
use isochore_mesh::{NONE, Origin, Resampling, TriMesh, VertexOrigin};

use super::Session;

/// Result of [`Session::export`].
#[derive(Debug, Clone)]
pub struct Exported {
    /// The mesh, with all attributes of the mesh as opened.
    pub mesh: TriMesh,
    /// For each vertex of the mesh, its number in the session.
    pub vertices: Vec<u32>,
    /// Combined displacement by the locks of all strokes. `None` if it is excluded or zero.
    pub lock: Option<Lock>,
}

impl Session {
    /// The current surface without removed elements. Includes the stroke under way. Vertices and
    /// triangles keep their order.
    ///
    /// Attributes are interpolated once from the mesh as opened, at the origin of each corner.
    /// Shading normals are rotated with the surface.
    ///
    /// With `lock`, positions are those that the host sees: the flow plus the displacement that
    /// each stroke's lock has added at its end. They have the volume of the mesh as opened, except
    /// for a stroke under way. Without `lock`, positions are those of the flow alone, which a
    /// replay of the [`log`](Self::log) reproduces bit for bit.
    ///
    /// ```
    /// # use isochore_mesh::primitives::icosphere;
    /// # use isochore_sculpt::session::{Session, SessionOptions};
    /// let session = Session::open(icosphere(1.0, 2), SessionOptions::default())?;
    /// let exported = session.export(true);
    /// assert_eq!(exported.mesh, icosphere(1.0, 2));
    /// assert_eq!(exported.vertices.len(), 162);
    /// assert!(exported.lock.is_none());
    /// # Ok::<(), isochore_sculpt::session::OpenError>(())
    /// ```
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
        // Never used: every corner has an origin.
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

    /// The point of the mesh as opened that a vertex takes its attributes from.
    fn vertex_origin(&self, vertex: u32) -> VertexOrigin {
        let surface = &self.surface;
        let outgoing = surface.topology.outgoing(vertex);
        // A vertex with triangles has render vertices with origins.
        let origin = (outgoing != NONE).then(|| surface.render.get(surface.corner(outgoing)).origin).flatten();
        let Some(origin) = origin else { return VertexOrigin::Vertex(vertex) };
        // A remesh moves vertices of the mesh as opened to other points of it.
        let corners = surface.opened.triangles[origin.triangle as usize];
        match origin.weights.to_array().iter().position(|&weight| weight == 1.0) {
            Some(side) if corners[side] == vertex => VertexOrigin::Vertex(vertex),
            _ => VertexOrigin::Point(origin),
        }
    }
}
