//! What a host asks of the surface.

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{Aabb, DistanceBlock, LANES, Origin, PointBlock, SurfaceHit};

use super::{MovedVolume, Session, SessionError, SessionTool, origin::nearest_weights, surface::Surface};

/// A point of the surface that a ray or a point found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The triangle, which indexes [`RenderBuffers::indices`](super::RenderBuffers::indices).
    pub triangle: u32,
    /// Its vertices.
    pub vertices: [u32; 3],
    /// The point, model units.
    pub point: DVec3,
    /// Its barycentric coordinates in the triangle, up to rounding: how much each of the vertices counts for it.
    pub weights: DVec3,
    /// Unit normal of the triangle; zero where it has no area.
    pub normal: DVec3,
    /// Along a ray in lengths of its direction; else in model units.
    pub distance: f64,
}

/// Where the flow of one move carries a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrow {
    /// Where the point is.
    pub point: DVec3,
    /// By how much the move carries it, model units.
    pub shift: DVec3,
}

/// Arrows that a preview has at most along each side: more is no picture any more.
const MOST_ARROWS: usize = 64;

impl Session {
    /// The first point of the surface along the ray from `origin`, seen from either side. `direction` may have any length.
    pub fn pick(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let surface = &self.surface;
        surface
            .tree
            .cast_ray(origin, direction, &|triangle| surface.shown_corners(triangle))
            .map(|hit| surface.hit(hit))
    }

    /// The point of the surface nearest to `point`.
    pub fn closest_point(&self, point: DVec3) -> Option<Hit> {
        let surface = &self.surface;
        surface.tree.closest_point(point, &|triangle| surface.shown_corners(triangle)).map(|hit| surface.hit(hit))
    }

    /// The vertices within the support of a tool at a pose, which are those that it moves as soon as it moves, in ascending order,
    /// into `vertices`. Masks are not looked at.
    ///
    /// Strokes move vertices from where the flow has left them, and so it is there that they count as reached: what the host sees may
    /// be off by what the lock has added, which [`offsets`](Self::offsets) tells.
    pub fn vertices_in_reach(&self, tool: &SessionTool, pose: &field::Pose, vertices: &mut Vec<u32>) {
        vertices.clear();
        let tool = tool.tool();
        let support = tool.distance().bounds().expanded(tool.support());
        let bounds = Aabb::of(support.corners().map(|corner| pose.transform(corner)));
        self.surface.tree.visit_box(bounds, |triangle| {
            let triangle = &self.surface.topology.triangles()[triangle as usize];
            if triangle.is_alive() {
                vertices.extend(triangle.vertices);
            }
        });
        vertices.extend(&self.loose);
        vertices.sort_unstable();
        vertices.dedup();
        let back = pose.rotation.conjugate();
        let mut is_inside = Vec::with_capacity(vertices.len());
        for chunk in vertices.chunks(LANES) {
            let mut points = PointBlock::ZERO;
            for (lane, &vertex) in chunk.iter().enumerate() {
                points.set(lane, back * (self.surface.position(vertex) - pose.translation));
            }
            let mut distance = DistanceBlock::FAR;
            tool.distance().sample_into(&points, &mut distance);
            is_inside.extend(distance.value[..chunk.len()].iter().map(|&distance| distance < tool.support()));
        }
        let mut is_inside = is_inside.into_iter();
        vertices.retain(|_| is_inside.next().unwrap_or(false));
    }

    /// Where a move of the tool between two poses would carry a lattice of points around it, `per_side` along the longest side of its
    /// support: a picture of the field, masks included, for a host that wants to draw it. Points that would stay are left out.
    ///
    /// # Errors
    /// [`SessionError::Stroke`] where there is no way between the poses.
    pub fn preview(
        &self,
        tool: &SessionTool,
        from: &field::Pose,
        to: &field::Pose,
        per_side: usize,
    ) -> Result<Vec<Arrow>, SessionError> {
        let stroke = self.segment(tool, [*from, *to])?.stroke;
        let support = tool.tool().distance().bounds().expanded(tool.tool().support());
        let per_side = per_side.clamp(2, MOST_ARROWS);
        let spacing = support.size().max_element() / (per_side - 1) as f64;
        let counts = (support.size() / spacing).to_array().map(|count| count as usize + 1);
        let mut points = Vec::with_capacity(counts.iter().product());
        for z in 0..counts[2] {
            for y in 0..counts[1] {
                for x in 0..counts[0] {
                    let local = support.min + spacing * DVec3::new(x as f64, y as f64, z as f64);
                    points.push(from.transform(local));
                }
            }
        }
        let mut carried = points.clone();
        stroke.advect(&mut carried);
        let arrows = points.into_iter().zip(carried).filter(|(point, carried)| point != carried);
        Ok(arrows.map(|(point, carried)| Arrow { point, shift: carried - point }).collect())
    }

    /// Volume that the stroke under way has moved so far; zero where there is none. Takes time in proportion to what it touched.
    pub fn moved_volume(&self) -> MovedVolume {
        self.stroke.as_ref().map_or(MovedVolume::default(), |stroke| stroke.moved_volume(&self.surface))
    }

    /// The volume inside the surface before any lock, without the stroke under way: that of the mesh as opened and the changes of all
    /// strokes since. None where the surface is open.
    pub fn volume(&self) -> Option<f64> {
        let opened = self.opened_volume?;
        let mut sum = isochore_mesh::CompensatedSum::default();
        sum.add(opened);
        self.logged().filter_map(|stroke| stroke.volume_change).for_each(|change| sum.add(change));
        Some(sum.value())
    }

    /// Number of vertices, those included that were removed. The first ones are those of the mesh as opened, in its order; inserted
    /// ones follow, and may take the numbers of others that an earlier stroke has removed.
    pub fn vertex_count(&self) -> usize {
        self.surface.positions.items().len()
    }

    /// Number of triangles that are there.
    pub fn triangle_count(&self) -> usize {
        self.surface.topology.alive()
    }

    /// Positions by vertex where the flow has taken them, those included that were removed, model units: what strokes work on, and
    /// what the log gives elsewhere.
    pub fn positions(&self) -> &[DVec3] {
        self.surface.positions.items()
    }

    /// By vertex what the locks of all strokes add to its position, model units: buffers, picks and exports with a lock show the sum.
    pub fn offsets(&self) -> &[DVec3] {
        self.surface.offsets.items()
    }

    /// The vertices that were not removed, in ascending order: those of an [export](Self::export).
    pub fn vertices(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.vertex_count() as u32).filter(|&vertex| self.is_alive(vertex))
    }

    /// By vertex of the mesh as opened the vertex that stands in its place: itself, or the one that collapses have merged it into,
    /// which may be an inserted one. All of these are there. Takes time in proportion to these vertices and to the collapses of the
    /// strokes that are not undone.
    ///
    /// The way back, from inserted vertices to the mesh as opened, is told by [`origin_of`](Self::origin_of).
    pub fn vertex_map(&self) -> Vec<u32> {
        // From the last collapse to the first: where a number was given away later, what it meant before is overwritten.
        let mut now: Vec<u32> = (0..self.vertex_count() as u32).collect();
        for &[removed, kept] in self.surface.merges.items().iter().rev() {
            now[removed as usize] = now[kept as usize];
        }
        now.truncate(self.surface.opened.positions.len());
        now
    }

    /// Whether a vertex was not removed.
    ///
    /// # Panics
    /// If there was never such a vertex.
    pub fn is_alive(&self, vertex: u32) -> bool {
        self.surface.topology.outgoing(vertex) != isochore_mesh::NONE || self.loose.binary_search(&vertex).is_ok()
    }

    /// Vertices of a triangle; none where it was removed.
    ///
    /// # Panics
    /// If there was never such a triangle.
    pub fn triangle(&self, triangle: u32) -> Option<[u32; 3]> {
        let record = self.surface.topology.triangles()[triangle as usize];
        record.is_alive().then_some(record.vertices)
    }

    /// The vertex that a render vertex belongs to; [`NONE`](isochore_mesh::NONE) where it was removed.
    ///
    /// # Panics
    /// If there is no such render vertex.
    pub fn vertex_of(&self, render_vertex: u32) -> u32 {
        self.surface.render.get(render_vertex).vertex
    }

    /// Where on the mesh as opened a render vertex takes its attributes from; none for a vertex without triangles.
    /// Of which render vertices that changes, [`Changes::attributes`](super::Changes::attributes) tells.
    ///
    /// # Panics
    /// If there is no such render vertex.
    pub fn origin_of(&self, render_vertex: u32) -> Option<Origin> {
        self.surface.render.get(render_vertex).origin
    }
}

impl Surface {
    fn hit(&self, hit: SurfaceHit) -> Hit {
        let vertices = self.topology.triangles()[hit.triangle as usize].vertices;
        let corners = vertices.map(|vertex| self.shown(vertex));
        let [a, b, c] = corners;
        Hit {
            triangle: hit.triangle,
            vertices,
            point: hit.point,
            weights: nearest_weights(hit.point, &corners),
            normal: (b - a).cross(c - a).normalize_or_zero(),
            distance: hit.distance,
        }
    }
}
