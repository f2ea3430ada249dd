//! Queries of the surface.

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{Aabb, DistanceBlock, LANES, Origin, PointBlock, SurfaceHit};

use super::{MovedVolume, Session, SessionError, SessionTool, origin::nearest_weights, surface::Surface};

/// A point of the surface found by a ray or a nearest-point query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The triangle, an index into [`RenderBuffers::indices`](super::RenderBuffers::indices).
    pub triangle: u32,
    /// Vertices of the triangle.
    pub vertices: [u32; 3],
    /// The point, model units.
    pub point: DVec3,
    /// Barycentric coordinates of the point in the triangle, up to rounding.
    pub weights: DVec3,
    /// Unit normal of the triangle; zero if its area is zero.
    pub normal: DVec3,
    /// Distance from the query point, model units; for a ray, in units of the length of its
    /// direction.
    pub distance: f64,
}

/// Displacement of one point by the flow of a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrow {
    /// The point before the move.
    pub point: DVec3,
    /// Displacement by the move, model units.
    pub shift: DVec3,
}

/// Maximum number of arrows along each side of a preview. Larger makes an unreadable picture;
/// smaller hides small features.
const MOST_ARROWS: usize = 64;

impl Session {
    /// The first intersection of a ray with either side of the surface. `direction` may have any
    /// length. Returns `None` if the ray misses.
    ///
    /// ```
    /// # use glam::DVec3;
    /// # use isochore_mesh::primitives::icosphere;
    /// # use isochore_sculpt::session::{Session, SessionOptions};
    /// let session = Session::open(icosphere(1.0, 4), SessionOptions::default())?;
    /// let hit = session.pick(DVec3::new(0.0, 0.1, 3.0), DVec3::NEG_Z).unwrap();
    /// assert!((hit.distance - 2.0).abs() < 0.02);
    /// assert!(session.pick(DVec3::new(0.0, 0.0, 3.0), DVec3::Z).is_none());
    /// let nearest = session.closest_point(DVec3::new(0.0, 0.1, 3.0)).unwrap();
    /// assert!(nearest.normal.z > 0.9);
    /// # Ok::<(), isochore_sculpt::session::OpenError>(())
    /// ```
    pub fn pick(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let surface = &self.surface;
        surface
            .tree
            .cast_ray(origin, direction, &|triangle| surface.shown_corners(triangle))
            .map(|hit| surface.hit(hit))
    }

    /// The point of the surface nearest to `point`. Returns `None` if `point` is not finite or the
    /// mesh has no triangles.
    pub fn closest_point(&self, point: DVec3) -> Option<Hit> {
        let surface = &self.surface;
        surface.tree.closest_point(point, &|triangle| surface.shown_corners(triangle)).map(|hit| surface.hit(hit))
    }

    /// Replaces `vertices` by the vertices within the support of a tool at `pose` (world from
    /// tool), in ascending order. Those are the vertices that the tool affects as soon as it moves.
    /// Ignores the mask.
    ///
    /// Distances are measured from the positions of the flow, where strokes start. The host sees
    /// positions that differ by the [`offsets`](Self::offsets) of the lock.
    ///
    /// ```
    /// # use glam::DVec3;
    /// # use isochore_field::Pose;
    /// # use isochore_mesh::{NoProgress, primitives::icosphere};
    /// # use isochore_sculpt::{Meshes, recipe, session::{Session, SessionOptions, SessionTool}};
    /// # let shape = recipe::ToolShape::Sphere(recipe::Sphere { radius: 0.2 });
    /// # let brush = recipe::Tool { shape, support: 0.3, profile: recipe::Profile::Quintic, free_form: 0.0 };
    /// # let brush = SessionTool::new("brush", brush, &Meshes::new(), &NoProgress)?;
    /// let session = Session::open(icosphere(1.0, 3), SessionOptions::default())?;
    /// let mut vertices = Vec::new();
    /// session.vertices_in_reach(&brush, &Pose::at(DVec3::Z), &mut vertices);
    /// // Radius plus support.
    /// assert!(vertices.iter().all(|&vertex| session.positions()[vertex as usize].distance(DVec3::Z) < 0.2 + 0.3));
    /// assert!(!vertices.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn vertices_in_reach(&self, tool: &SessionTool, pose: &field::Pose, vertices: &mut Vec<u32>) {
        vertices.clear();
        let tool = tool.tool();
        let support = tool.support_bounds();
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
        let tool_from_world = pose.rotation.conjugate();
        let mut is_inside = Vec::with_capacity(vertices.len());
        for chunk in vertices.chunks(LANES) {
            let mut points = PointBlock::ZERO;
            for (lane, &vertex) in chunk.iter().enumerate() {
                points.set(lane, tool_from_world * (self.surface.position(vertex) - pose.translation));
            }
            let mut distance = DistanceBlock::FAR;
            tool.distance().sample_into(&points, &mut distance);
            is_inside.extend(distance.value[..chunk.len()].iter().map(|&distance| distance < tool.support()));
        }
        let mut is_inside = is_inside.into_iter();
        vertices.retain(|_| is_inside.next().unwrap_or(false));
    }

    /// Displacements of a lattice of points around the tool by a move between two poses, mask
    /// included. The lattice has `per_side` points, from 2 to 64, along the longest side of the
    /// support. Points that do not move are omitted. A host can draw the result.
    ///
    /// # Errors
    /// [`SessionError::Stroke`] if the tool cannot move between the poses.
    pub fn preview(
        &self,
        tool: &SessionTool,
        from: &field::Pose,
        to: &field::Pose,
        per_side: usize,
    ) -> Result<Vec<Arrow>, SessionError> {
        let stroke = self.segment(tool, [*from, *to])?.stroke;
        let support = tool.tool().support_bounds();
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
        let mut images = points.clone();
        stroke.advect(&mut images);
        let arrows = points.into_iter().zip(images).filter(|(point, image)| point != image);
        Ok(arrows.map(|(point, image)| Arrow { point, shift: image - point }).collect())
    }

    /// Volume that the stroke under way has moved so far; zero if no stroke is under way. Takes
    /// time proportional to the part that it touched.
    pub fn moved_volume(&self) -> MovedVolume {
        self.stroke.as_ref().map_or(MovedVolume::default(), |stroke| stroke.moved_volume(&self.surface))
    }

    /// Volume inside the surface of the flow, before any lock and without the stroke under way: the
    /// volume as opened plus the changes by all strokes. `None` if the surface is open.
    pub fn volume(&self) -> Option<f64> {
        let opened = self.opened_volume?;
        let mut sum = isochore_mesh::CompensatedSum::default();
        sum.add(opened);
        self.logged().filter_map(|stroke| stroke.volume_change).for_each(|change| sum.add(change));
        Some(sum.value())
    }

    /// Number of vertices, removed ones included. The vertices of the mesh as opened come first, in
    /// their order. Inserted vertices follow, and may reuse the numbers of inserted vertices that
    /// an earlier stroke has removed.
    pub fn vertex_count(&self) -> usize {
        self.surface.positions.items().len()
    }

    /// Number of triangles, without removed ones.
    pub fn triangle_count(&self) -> usize {
        self.surface.topology.alive()
    }

    /// Positions of the flow for all vertices, removed ones included, model units. Strokes start
    /// from these positions, and a replay of the log reproduces them.
    pub fn positions(&self) -> &[DVec3] {
        self.surface.positions.items()
    }

    /// Displacement of each vertex by the locks of all strokes, model units. Buffers, picks and
    /// exports with a lock show position plus offset.
    pub fn offsets(&self) -> &[DVec3] {
        self.surface.offsets.items()
    }

    /// The vertices that are not removed, in ascending order: those of an [export](Self::export).
    pub fn vertices(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.vertex_count() as u32).filter(|&vertex| self.is_alive(vertex))
    }

    /// For each vertex of the mesh as opened, the vertex that represents it now: itself, or the
    /// vertex that collapses have merged it into, which may be an inserted one. No listed vertex is
    /// removed. Takes time proportional to the number of vertices and of collapses.
    ///
    /// [`origin_of`](Self::origin_of) maps in the other direction, from render vertices to the mesh
    /// as opened.
    pub fn vertex_map(&self) -> Vec<u32> {
        // From the last collapse to the first: if a number was reused, the earlier collapse
        // overwrites the later meaning.
        let mut now: Vec<u32> = (0..self.vertex_count() as u32).collect();
        for &[removed, kept] in self.surface.merges.items().iter().rev() {
            now[removed as usize] = now[kept as usize];
        }
        now.truncate(self.surface.opened.positions.len());
        now
    }

    /// Whether a vertex is not removed.
    ///
    /// # Panics
    /// If `vertex` is not below [`vertex_count`](Self::vertex_count).
    pub fn is_alive(&self, vertex: u32) -> bool {
        self.surface.topology.outgoing(vertex) != isochore_mesh::NONE || self.loose.binary_search(&vertex).is_ok()
    }

    /// Vertices of a triangle. `None` if it is removed.
    ///
    /// # Panics
    /// If `triangle` is not an index into
    /// [`RenderBuffers::indices`](super::RenderBuffers::indices).
    pub fn triangle(&self, triangle: u32) -> Option<[u32; 3]> {
        let record = self.surface.topology.triangles()[triangle as usize];
        record.is_alive().then_some(record.vertices)
    }

    /// The vertex that a render vertex belongs to, or [`NONE`](isochore_mesh::NONE) if it is
    /// removed.
    ///
    /// # Panics
    /// If the render vertex does not exist.
    pub fn vertex_of(&self, render_vertex: u32) -> u32 {
        self.surface.render.get(render_vertex).vertex
    }

    /// The point of the mesh as opened that a render vertex takes its attributes from. `None` for a
    /// vertex without triangles. [`Changes::attributes`](super::Changes::attributes) reports the
    /// render vertices whose origin has changed.
    ///
    /// # Panics
    /// If the render vertex does not exist.
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
