//! Sculpting sessions.

use std::ffi::c_char;

use glam::DVec3;
use isochore_sculpt::{
    recipe::Key,
    session::{self, DirtyRange, Hit as SurfaceHit, InteractiveRefinement, SessionOptions, StrokeOptions},
};

use crate::{
    error::{Failure, Status, guarded},
    memory::{array, free, hand_over, hand_over_text, put, reference, reference_mut},
    mesh::Mesh,
    tool::Tool,
};

/// A mesh that strokes deform one after the other, with undo and redo.
#[derive(Debug)]
pub struct Session {
    session: session::Session,
    /// By buffer what has changed since it was last asked for.
    changed: [Vec<Range>; 4],
}

/// Buffers for a renderer, in place: the session's own memory, until the session changes.
///
/// A render vertex is a vertex as the triangles on one side of a seam see it. Removed triangles are three times zero.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Buffers {
    /// Grows whenever a buffer has moved in memory.
    pub generation: u64,
    /// Number of render vertices.
    pub vertex_count: usize,
    /// x, y, z of each render vertex, model units.
    pub positions: *const f32,
    /// Unit normal of each render vertex.
    pub normals: *const f32,
    /// u, v of each render vertex, the first set; NULL where the mesh has none.
    pub uvs: *const f32,
    /// Linear red, green, blue, alpha of each render vertex; NULL where the mesh has none.
    pub colors: *const f32,
    /// Number of triangles, those removed included.
    pub triangle_count: usize,
    /// Three render vertices of each triangle, counter-clockwise seen from outside.
    pub indices: *const u32,
}

/// Elements from `start` to before `end`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// The first element.
    pub start: u32,
    /// The element after the last.
    pub end: u32,
}

/// Which buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Buffer {
    /// Positions, by render vertex.
    Positions = 0,
    /// Normals, by render vertex.
    Normals = 1,
    /// Texture coordinates and colors, by render vertex.
    Attributes = 2,
    /// Indices, by triangle.
    Indices = 3,
}

/// What one stroke did.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct StrokeReceipt {
    /// Moves that it was made of.
    pub moves: usize,
    /// Vertices there before that it moved or removed.
    pub touched_vertices: usize,
    /// Vertices that splits inserted.
    pub inserted_vertices: usize,
    /// Vertices that collapses removed.
    pub removed_vertices: usize,
    /// Edges that were flipped.
    pub flipped_edges: usize,
    /// Whether the surface is closed, and the changes of its volume below mean something.
    pub has_volume: bool,
    /// Signed change of the volume by the flow, cubic model units.
    pub volume_flow: f64,
    /// By splits.
    pub volume_splits: f64,
    /// By collapses and flips.
    pub volume_remeshing: f64,
    /// Bound on the rounding in these.
    pub volume_rounding: f64,
    /// Bytes that undo holds for it.
    pub undo_bytes: usize,
    /// Older strokes that undo forgot to make room.
    pub forgotten_strokes: usize,
}

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
    /// Unit normal of the triangle.
    pub normal: [f64; 3],
    /// Distance from where the query began, model units.
    pub distance: f64,
}

/// Opens a session on a copy of a manifold, oriented mesh. `step` is the travel of the tool in one time step as in a recipe, zero
/// for the usual; `undo_bytes` limits undo, zero for the usual.
///
/// # Safety
/// `mesh` is a handle; `session` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_new(
    mesh: *const Mesh,
    step: f64,
    undo_bytes: usize,
    session: *mut *mut Session,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let mesh = unsafe { reference("mesh", mesh) }?;
        let default = SessionOptions::default();
        let options = SessionOptions {
            step: if step == 0.0 { default.step } else { step },
            undo_bytes: if undo_bytes == 0 { default.undo_bytes } else { undo_bytes },
            ..default
        };
        let opened =
            session::Session::open(mesh.mesh.clone(), options).map_err(|error| Failure::new(Status::Mesh, error))?;
        // SAFETY: as the caller promises.
        unsafe { hand_over("session", session, Session { session: opened, changed: Default::default() }) }
    })
}

/// Begins a stroke; nothing moves before the second pose. `refine` lets edges in the tool's reach be split, those longer than
/// `longest_edge` (model units; zero for the usual), and collapsed and flipped.
///
/// # Safety
/// `session` and `tool` are handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_begin_stroke(
    session: *mut Session,
    tool: *const Tool,
    refine: bool,
    longest_edge: f64,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let (session, tool) = unsafe { (reference_mut("session", session)?, reference("tool", tool)?) };
        let longest = (longest_edge != 0.0).then_some(longest_edge);
        let refine = refine.then(|| InteractiveRefinement { longest, ..InteractiveRefinement::default() });
        Ok(session.session.begin_stroke(&tool.tool, StrokeOptions { refine })?)
    })
}

/// Moves the tool along a screw to a pose: `at`, x, y, z in model units, and `rotate`, axis x, y, z and angle in degrees, absolute;
/// NULL for none. `time` is the host's, in seconds.
///
/// # Safety
/// `session` is a handle; `at` has three values, `rotate` four where it is not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_move_to(
    session: *mut Session,
    at: *const f64,
    rotate: *const f64,
    time: f64,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let (session, at, rotate) = unsafe {
            (
                reference_mut("session", session)?,
                *reference("at", at.cast::<[f64; 3]>())?,
                rotate.cast::<[f64; 4]>().as_ref(),
            )
        };
        let key = Key { at, rotate: rotate.copied().unwrap_or([0.0, 0.0, 1.0, 0.0]) };
        session.session.move_to(&key.pose(), time)?;
        Ok(())
    })
}

/// Ends the stroke. `receipt` may be NULL.
///
/// # Safety
/// `session` is a handle; `receipt` can be written to where it is not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_end_stroke(session: *mut Session, receipt: *mut StrokeReceipt) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let session = unsafe { reference_mut("session", session) }?;
        let done = session.session.end_stroke()?;
        let volume = done.volume.unwrap_or_default();
        let account = StrokeReceipt {
            moves: done.moves,
            touched_vertices: done.touched_vertices,
            inserted_vertices: done.inserted_vertices,
            removed_vertices: done.removed_vertices,
            flipped_edges: done.flipped_edges,
            has_volume: done.volume.is_some(),
            volume_flow: volume.flow,
            volume_splits: volume.splits,
            volume_remeshing: volume.remeshing,
            volume_rounding: volume.rounding,
            undo_bytes: done.undo_bytes,
            forgotten_strokes: done.forgotten_strokes,
        };
        // SAFETY: as the caller promises.
        if receipt.is_null() { Ok(()) } else { unsafe { put("receipt", receipt, account) } }
    })
}

/// Takes back the stroke under way.
///
/// # Safety
/// `session` is a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_cancel_stroke(session: *mut Session) -> Status {
    // SAFETY: as the caller promises.
    guarded(|| Ok(unsafe { reference_mut("session", session) }?.session.cancel_stroke()?))
}

/// Takes back the last stroke, to the bit. `is_done`, which may be NULL, tells whether there was one.
///
/// # Safety
/// `session` is a handle; `is_done` can be written to where it is not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_undo(session: *mut Session, is_done: *mut bool) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let done = unsafe { reference_mut("session", session) }?.session.undo()?;
        // SAFETY: as the caller promises.
        if is_done.is_null() { Ok(()) } else { unsafe { put("is_done", is_done, done) } }
    })
}

/// Does again what was undone last, to the bit. `is_done`, which may be NULL, tells whether there was something.
///
/// # Safety
/// `session` is a handle; `is_done` can be written to where it is not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_redo(session: *mut Session, is_done: *mut bool) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let done = unsafe { reference_mut("session", session) }?.session.redo()?;
        // SAFETY: as the caller promises.
        if is_done.is_null() { Ok(()) } else { unsafe { put("is_done", is_done, done) } }
    })
}

/// Tells where the buffers are.
///
/// # Safety
/// `session` is a handle; `buffers` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_buffers(session: *const Session, buffers: *mut Buffers) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let now = unsafe { reference("session", session) }?.session.buffers();
        let or_null = |values: &[f32]| if values.is_empty() { std::ptr::null() } else { values.as_ptr() };
        let place = Buffers {
            generation: now.generation,
            vertex_count: now.positions.len(),
            positions: now.positions.as_flattened().as_ptr(),
            normals: now.normals.as_flattened().as_ptr(),
            uvs: now.uvs.first().map_or(std::ptr::null(), |uvs| or_null(uvs.as_flattened())),
            colors: or_null(now.colors.as_flattened()),
            triangle_count: now.indices.len(),
            indices: now.indices.as_flattened().as_ptr(),
        };
        // SAFETY: as the caller promises.
        unsafe { put("buffers", buffers, place) }
    })
}

/// Finds out what has changed in the buffers since the last call, for `isochore_session_changed`: at first, everything.
///
/// # Safety
/// `session` is a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_take_changes(session: *mut Session) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let session = unsafe { reference_mut("session", session) }?;
        let changes = session.session.take_changes();
        let ranges = |ranges: Vec<DirtyRange>| {
            ranges.into_iter().map(|range| Range { start: range.start, end: range.end }).collect()
        };
        session.changed = [changes.positions, changes.normals, changes.attributes, changes.indices].map(ranges);
        Ok(())
    })
}

/// The ranges of a buffer, one of `IsochoreBuffer`, that `isochore_session_take_changes` found to have changed, in order: `count` of them in the session's own
/// memory, until it is asked again.
///
/// # Safety
/// `session` is a handle; `ranges` and `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_changed(
    session: *const Session,
    buffer: u32,
    ranges: *mut *const Range,
    count: *mut usize,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let session = unsafe { reference("session", session) }?;
        let found = session.changed.get(buffer as usize);
        let found = found.ok_or_else(|| Failure::argument(format!("{buffer} is no buffer")))?;
        // SAFETY: as the caller promises.
        unsafe {
            put("ranges", ranges, found.as_ptr())?;
            put("count", count, found.len())
        }
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

/// All strokes that are done and not undone, as the JSON text of a recipe, to be given back with `isochore_text_free`.
///
/// # Safety
/// `session` is a handle; `recipe` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_log(session: *const Session, recipe: *mut *mut c_char) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let log = unsafe { reference("session", session) }?.session.log().to_json();
        // SAFETY: as the caller promises.
        unsafe { hand_over_text("recipe", recipe, &log) }
    })
}

/// The surface as a mesh of its own. `lock` gives back the volume of the mesh as opened by the least displacement of what has moved.
///
/// # Safety
/// `session` is a handle; `mesh` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_export(session: *const Session, lock: bool, mesh: *mut *mut Mesh) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let exported = unsafe { reference("session", session) }?.session.export(lock);
        // SAFETY: as the caller promises.
        unsafe { hand_over("mesh", mesh, Mesh { mesh: exported.mesh }) }
    })
}

/// Gives a session back.
///
/// # Safety
/// `session` is NULL or a handle that was not given back yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_free(session: *mut Session) {
    // SAFETY: as the caller promises.
    unsafe { free(session) }
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
            normal: found.normal.to_array(),
            distance: found.distance,
        };
        // SAFETY: as the caller promises.
        unsafe { put("hit", hit, found) }?;
    }
    // SAFETY: as the caller promises.
    unsafe { put("is_hit", is_hit, found.is_some()) }
}
