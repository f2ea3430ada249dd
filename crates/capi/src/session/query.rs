//! Queries on a session.

use glam::DVec3;
use isochore_mesh::NONE;
use isochore_sculpt::session::Hit as SurfaceHit;

use super::{Session, pose};
use crate::{
    error::{Failure, Status, guarded},
    memory::{array, put, put_slice, reference, reference_mut},
    tool::Tool,
};

/// A point of the surface found by a query.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// Triangle that contains the point.
    pub triangle: u32,
    /// Vertices of the triangle.
    pub vertices: [u32; 3],
    /// Position, model units.
    pub point: [f64; 3],
    /// Barycentric coordinates of the point in the triangle.
    pub weights: [f64; 3],
    /// Unit normal of the triangle.
    pub normal: [f64; 3],
    /// Distance from the query point in model units. For a ray, the ray parameter: the distance
    /// divided by the length of its direction.
    pub distance: f64,
}

/// A point and its displacement by one move.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Arrow {
    /// Position, model units.
    pub point: [f64; 3],
    /// Displacement, model units.
    pub shift: [f64; 3],
}

/// Source of a render vertex.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Origin {
    /// Vertex that the render vertex belongs to, or `UINT32_MAX` if it has been removed. The
    /// vertices of the opened mesh come first. Inserted vertices follow and may reuse the numbers
    /// of vertices that an earlier stroke removed.
    pub vertex: u32,
    /// Triangle of the opened mesh that provides the attributes, or `UINT32_MAX` for a vertex
    /// without triangles.
    pub triangle: u32,
    /// Barycentric coordinates in that triangle.
    pub weights: [f64; 3],
}

/// Size of the undo history.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct History {
    /// Number of strokes that can be undone.
    pub undoable: usize,
    /// Number of strokes that can be redone.
    pub redoable: usize,
    /// Number of strokes that the memory budget has removed from the history. The log still
    /// contains them.
    pub forgotten: usize,
    /// Memory in use, in bytes.
    pub bytes: usize,
}

/// Gets the vertices that have not been removed, in ascending order. Vertex i of a mesh from
/// `isochore_session_export` is element i of this array. The array belongs to the session and is
/// valid until the next call to this function.
///
/// Preconditions: `session` is a handle. `vertices` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_vertices(
    session: *mut Session,
    vertices: *mut *const u32,
    count: *mut usize,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let session = unsafe { reference_mut("session", session) }?;
        session.vertices = session.session.vertices().collect();
        // SAFETY: the caller guarantees it.
        unsafe { put_slice("vertices", vertices, count, &session.vertices) }
    })
}

/// Maps each vertex of the opened mesh to the vertex that represents it: the vertex itself, or the
/// one that collapses have merged it into. `count` receives the number of vertices of the opened
/// mesh. The array belongs to the session and is valid until the next call to this function.
///
/// Preconditions: `session` is a handle. `vertices` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_vertex_map(
    session: *mut Session,
    vertices: *mut *const u32,
    count: *mut usize,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let session = unsafe { reference_mut("session", session) }?;
        session.vertex_map = session.session.vertex_map();
        // SAFETY: the caller guarantees it.
        unsafe { put_slice("vertices", vertices, count, &session.vertex_map) }
    })
}

/// Finds the first point of the surface along a ray. `direction` may have any nonzero length.
/// `is_hit` receives whether the ray hits the surface; `hit` is written only in that case.
///
/// Preconditions: `session` is a handle. `origin` and `direction` have 3 values. `hit` and `is_hit`
/// are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_pick(
    session: *const Session,
    origin: *const f64,
    direction: *const f64,
    hit: *mut Hit,
    is_hit: *mut bool,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        unsafe {
            let session = &reference("session", session)?.session;
            let [origin, direction] = [point("origin", origin)?, point("direction", direction)?];
            answer(session.pick(origin, direction), hit, is_hit)
        }
    })
}

/// Finds the point of the surface closest to a point. `is_hit` receives false, and `hit` is not
/// written, if the mesh has no triangles.
///
/// Preconditions: `session` is a handle. `from` has 3 values. `hit` and `is_hit` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_closest_point(
    session: *const Session,
    from: *const f64,
    hit: *mut Hit,
    is_hit: *mut bool,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        unsafe {
            let session = &reference("session", session)?.session;
            answer(session.closest_point(point("from", from)?), hit, is_hit)
        }
    })
}

/// Computes the volume enclosed by the surface before any volume lock, without the stroke in
/// progress, in cubic model units.
///
/// Returns `ISOCHORE_STATUS_MESH` if the surface is open.
///
/// Preconditions: `session` is a handle. `volume` is writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_volume(session: *const Session, volume: *mut f64) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let enclosed_volume = unsafe { reference("session", session) }?.session.volume();
        let enclosed_volume =
            enclosed_volume.ok_or_else(|| Failure::new(Status::Mesh, "the surface is open and encloses no volume"))?;
        // SAFETY: the caller guarantees it.
        unsafe { put("volume", volume, enclosed_volume) }
    })
}

/// Gets the vertices within the support of a tool at a pose, in ascending order. These are the
/// vertices that a stroke moves as soon as the tool moves, ignoring masks. The test uses positions
/// without the displacements of the volume lock. The pose has the form described at
/// `isochore_session_move_to`. The array belongs to the session and is valid until the next call to
/// this function.
///
/// Preconditions: `session` and `tool` are handles. `at` has 3 values. `rotate` is NULL or has 4
/// values. `vertices` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_vertices_in_reach(
    session: *mut Session,
    tool: *const Tool,
    at: *const f64,
    rotate: *const f64,
    vertices: *mut *const u32,
    count: *mut usize,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (session, tool, pose) =
            unsafe { (reference_mut("session", session)?, reference("tool", tool)?, pose(at, rotate)?) };
        session.session.vertices_in_reach(&tool.tool, &pose, &mut session.reached);
        // SAFETY: the caller guarantees it.
        unsafe { put_slice("vertices", vertices, count, &session.reached) }
    })
}

/// Computes the displacements of a lattice of points around a tool if it moved from one pose to
/// another, for display as arrows. Masks apply. `per_side` is the number of points along the
/// longest side of the support, at most 64. The poses have the form described at
/// `isochore_session_move_to`. The array belongs to the session and is valid until the next call to
/// this function.
///
/// Preconditions: `session` and `tool` are handles. `from` and `to` have 3 values. `from_rotate`
/// and `to_rotate` are NULL or have 4 values. `arrows` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_preview(
    session: *mut Session,
    tool: *const Tool,
    from: *const f64,
    from_rotate: *const f64,
    to: *const f64,
    to_rotate: *const f64,
    per_side: usize,
    arrows: *mut *const Arrow,
    count: *mut usize,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (session, tool) = unsafe { (reference_mut("session", session)?, reference("tool", tool)?) };
        // SAFETY: the caller guarantees it.
        let (from, to) = unsafe { (pose(from, from_rotate)?, pose(to, to_rotate)?) };
        let found = session.session.preview(&tool.tool, &from, &to, per_side)?;
        let arrow = |arrow: &isochore_sculpt::session::Arrow| Arrow {
            point: arrow.point.to_array(),
            shift: arrow.shift.to_array(),
        };
        session.arrows = found.iter().map(arrow).collect();
        // SAFETY: the caller guarantees it.
        unsafe { put_slice("arrows", arrows, count, &session.arrows) }
    })
}

/// Gets the volumes that the stroke in progress has moved outward and inward, in cubic model units;
/// 0 if no stroke is in progress.
///
/// Preconditions: `session` is a handle. `outward` and `inward` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_moved_volume(
    session: *const Session,
    outward: *mut f64,
    inward: *mut f64,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let moved = unsafe { reference("session", session) }?.session.moved_volume();
        // SAFETY: the caller guarantees it.
        unsafe {
            put("outward", outward, moved.outward)?;
            put("inward", inward, moved.inward)
        }
    })
}

/// Gets the size of the undo history.
///
/// Preconditions: `session` is a handle. `history` is writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_history(session: *const Session, history: *mut History) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let sizes = unsafe { reference("session", session) }?.session.history();
        let found = History {
            undoable: sizes.undoable,
            redoable: sizes.redoable,
            forgotten: sizes.forgotten,
            bytes: sizes.bytes,
        };
        // SAFETY: the caller guarantees it.
        unsafe { put("history", history, found) }
    })
}

/// Gets the vertex of a render vertex and the point of the opened mesh that provides its
/// attributes.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if `render_vertex` is out of range.
///
/// Preconditions: `session` is a handle. `origin` is writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_origin(
    session: *const Session,
    render_vertex: u32,
    origin: *mut Origin,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let session = &unsafe { reference("session", session) }?.session;
        let count = session.buffers().positions.len();
        if render_vertex as usize >= count {
            return Err(Failure::argument(format!(
                "render vertex {render_vertex} is out of range: the session has {count} render vertices"
            )));
        }
        let (vertex, origin_point) = (session.vertex_of(render_vertex), session.origin_of(render_vertex));
        let found = Origin {
            vertex,
            triangle: origin_point.map_or(NONE, |origin| origin.triangle),
            weights: origin_point.map_or([0.0; 3], |origin| origin.weights.to_array()),
        };
        // SAFETY: the caller guarantees it.
        unsafe { put("origin", origin, found) }
    })
}

/// Reads a point.
///
/// # Safety
/// `values` is NULL or has 3 values.
unsafe fn point(name: &str, values: *const f64) -> Result<DVec3, Failure> {
    // SAFETY: the caller guarantees it.
    let values = unsafe { array(name, values, 3) }?;
    Ok(DVec3::from_slice(values))
}

/// Writes the result of a query.
///
/// # Safety
/// `hit` and `is_hit` are NULL or writable.
unsafe fn answer(found: Option<SurfaceHit>, hit: *mut Hit, is_hit: *mut bool) -> Result<(), Failure> {
    if let Some(found) = &found {
        let found = Hit {
            triangle: found.triangle,
            vertices: found.vertices,
            point: found.point.to_array(),
            weights: found.weights.to_array(),
            normal: found.normal.to_array(),
            distance: found.distance,
        };
        // SAFETY: the caller guarantees it.
        unsafe { put("hit", hit, found) }?;
    }
    // SAFETY: the caller guarantees it.
    unsafe { put("is_hit", is_hit, found.is_some()) }
}
