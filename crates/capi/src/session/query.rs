//! What a host asks of a session.

use glam::DVec3;
use isochore_mesh::NONE;
use isochore_sculpt::session::Hit as SurfaceHit;

use super::{Session, pose};
use crate::{
    error::{Failure, Status, guarded},
    memory::{array, put, put_slice, reference, reference_mut},
    tool::Tool,
};

/// A point of the surface that a query found.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// The triangle.
    pub triangle: u32,
    /// Its vertices.
    pub vertices: [u32; 3],
    /// The point, model units.
    pub point: [f64; 3],
    /// Its barycentric coordinates in the triangle: how much each of the vertices counts for it.
    pub weights: [f64; 3],
    /// Unit normal of the triangle.
    pub normal: [f64; 3],
    /// Distance from where the query began: of a closest point in model units, of a pick in lengths of its direction.
    pub distance: f64,
}

/// Where the flow of one move carries a point.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Arrow {
    /// Where the point is, model units.
    pub point: [f64; 3],
    /// By how much the move carries it, model units.
    pub shift: [f64; 3],
}

/// Where a render vertex comes from.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Origin {
    /// The vertex that it shows; `UINT32_MAX` where that was removed. The first ones are those of the mesh as opened; inserted ones
    /// follow, and may take the numbers of others that an earlier stroke has removed.
    pub vertex: u32,
    /// The triangle of the mesh as opened that it takes its attributes from; `UINT32_MAX` for a vertex without triangles.
    pub triangle: u32,
    /// Barycentric coordinates in that triangle.
    pub weights: [f64; 3],
}

/// What can be undone and redone.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct History {
    /// Strokes that can be undone.
    pub undoable: usize,
    /// Strokes that can be redone.
    pub redoable: usize,
    /// Strokes that can no longer be undone, because there was no room for them; the log still has them.
    pub forgotten: usize,
    /// Bytes held.
    pub bytes: usize,
}

/// The vertices that were not removed, in ascending order: vertex i of `isochore_session_export` is number i of these in the session.
/// They are in the session's own memory, until it is asked again.
///
/// # Safety
/// `session` is a handle; `vertices` and `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_vertices(
    session: *mut Session,
    vertices: *mut *const u32,
    count: *mut usize,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let session = unsafe { reference_mut("session", session) }?;
        session.vertices = session.session.vertices().collect();
        // SAFETY: as the caller promises.
        unsafe { put_slice("vertices", vertices, count, &session.vertices) }
    })
}

/// For each vertex of the mesh as opened, `count` of them, the vertex that stands in its place: itself, or the one that collapses have
/// merged it into. They are in the session's own memory, until it is asked again.
///
/// # Safety
/// `session` is a handle; `vertices` and `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_vertex_map(
    session: *mut Session,
    vertices: *mut *const u32,
    count: *mut usize,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let session = unsafe { reference_mut("session", session) }?;
        session.vertex_map = session.session.vertex_map();
        // SAFETY: as the caller promises.
        unsafe { put_slice("vertices", vertices, count, &session.vertex_map) }
    })
}

/// The first point of the surface on a ray; `is_hit` tells whether there is one.
///
/// # Safety
/// `session` is a handle; `origin` and `direction` have three values; `hit` and `is_hit` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_pick(
    session: *const Session,
    origin: *const f64,
    direction: *const f64,
    hit: *mut Hit,
    is_hit: *mut bool,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        unsafe {
            let session = &reference("session", session)?.session;
            let [origin, direction] = [point("origin", origin)?, point("direction", direction)?];
            answer(session.pick(origin, direction), hit, is_hit)
        }
    })
}

/// The point of the surface nearest to a point; `is_hit` tells whether there is one.
///
/// # Safety
/// `session` is a handle; `from` has three values; `hit` and `is_hit` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_closest_point(
    session: *const Session,
    from: *const f64,
    hit: *mut Hit,
    is_hit: *mut bool,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        unsafe {
            let session = &reference("session", session)?.session;
            answer(session.closest_point(point("from", from)?), hit, is_hit)
        }
    })
}

/// Volume inside the surface without the stroke under way, cubic model units; an open surface is an error.
///
/// # Safety
/// `session` is a handle; `volume` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_volume(session: *const Session, volume: *mut f64) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let enclosed = unsafe { reference("session", session) }?.session.volume();
        let enclosed = enclosed.ok_or_else(|| Failure::new(Status::Mesh, "the surface is open"))?;
        // SAFETY: as the caller promises.
        unsafe { put("volume", volume, enclosed) }
    })
}

/// The vertices within the support of a tool at a pose, given as to `isochore_session_move_to`: those that it moves as soon as it
/// moves, masks apart, in ascending order. They count as reached where the flow has left them, without what the lock has added. They are
/// in the session's own memory, until it is asked again.
///
/// # Safety
/// `session` and `tool` are handles; `at` has three values, `rotate` four where it is not NULL; `vertices` and `count` can be written
/// to.
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
        // SAFETY: as the caller promises.
        let (session, tool, pose) =
            unsafe { (reference_mut("session", session)?, reference("tool", tool)?, pose(at, rotate)?) };
        session.session.vertices_in_reach(&tool.tool, &pose, &mut session.reached);
        // SAFETY: as the caller promises.
        unsafe { put_slice("vertices", vertices, count, &session.reached) }
    })
}

/// Where a move of a tool from one pose to another, each given as to `isochore_session_move_to`, would carry a lattice of points
/// around it, `per_side` along the longest side of its support, 64 at most: arrows to draw, masks included. They are in the session's
/// own memory, until it is asked again.
///
/// # Safety
/// `session` and `tool` are handles; `from` and `to` have three values, `from_rotate` and `to_rotate` four where they are not NULL;
/// `arrows` and `count` can be written to.
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
        // SAFETY: as the caller promises.
        let (session, tool) = unsafe { (reference_mut("session", session)?, reference("tool", tool)?) };
        // SAFETY: as the caller promises.
        let (from, to) = unsafe { (pose(from, from_rotate)?, pose(to, to_rotate)?) };
        let found = session.session.preview(&tool.tool, &from, &to, per_side)?;
        let arrow = |arrow: &isochore_sculpt::session::Arrow| Arrow {
            point: arrow.point.to_array(),
            shift: arrow.shift.to_array(),
        };
        session.arrows = found.iter().map(arrow).collect();
        // SAFETY: as the caller promises.
        unsafe { put_slice("arrows", arrows, count, &session.arrows) }
    })
}

/// Volume that the stroke under way has moved outward and inward so far, cubic model units; zero where there is none.
///
/// # Safety
/// `session` is a handle; `outward` and `inward` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_moved_volume(
    session: *const Session,
    outward: *mut f64,
    inward: *mut f64,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let moved = unsafe { reference("session", session) }?.session.moved_volume();
        // SAFETY: as the caller promises.
        unsafe {
            put("outward", outward, moved.outward)?;
            put("inward", inward, moved.inward)
        }
    })
}

/// What can be undone and redone.
///
/// # Safety
/// `session` is a handle; `history` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_history(session: *const Session, history: *mut History) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let now = unsafe { reference("session", session) }?.session.history();
        let found =
            History { undoable: now.undoable, redoable: now.redoable, forgotten: now.forgotten, bytes: now.bytes };
        // SAFETY: as the caller promises.
        unsafe { put("history", history, found) }
    })
}

/// Where a render vertex comes from, one of those that the buffers hold.
///
/// # Safety
/// `session` is a handle; `origin` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_origin(
    session: *const Session,
    render_vertex: u32,
    origin: *mut Origin,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let session = &unsafe { reference("session", session) }?.session;
        let count = session.buffers().positions.len();
        if render_vertex as usize >= count {
            return Err(Failure::argument(format!("{render_vertex} is none of the {count} render vertices")));
        }
        let (vertex, known) = (session.vertex_of(render_vertex), session.origin_of(render_vertex));
        let found = Origin {
            vertex,
            triangle: known.map_or(NONE, |known| known.triangle),
            weights: known.map_or([0.0; 3], |known| known.weights.to_array()),
        };
        // SAFETY: as the caller promises.
        unsafe { put("origin", origin, found) }
    })
}

/// # Safety
/// `values` is NULL or has three values.
unsafe fn point(name: &str, values: *const f64) -> Result<DVec3, Failure> {
    // SAFETY: as the caller promises.
    let values = unsafe { array(name, values, 3) }?;
    Ok(DVec3::from_slice(values))
}

/// # Safety
/// `hit` and `is_hit` are NULL or can be written to.
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
        // SAFETY: as the caller promises.
        unsafe { put("hit", hit, found) }?;
    }
    // SAFETY: as the caller promises.
    unsafe { put("is_hit", is_hit, found.is_some()) }
}
