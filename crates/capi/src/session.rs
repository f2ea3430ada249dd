//! Sculpting sessions.

mod buffers;
mod options;
mod query;
mod receipt;

use std::{ffi::c_char, sync::Arc};

use glam::DVec3;
use isochore_field::Pose;
use isochore_sculpt::{
    recipe::Key,
    session::{self, InteractiveRefinement, NormalWeights},
};
use options::mask;

pub use buffers::{
    Buffer, Buffers, Range, isochore_session_buffers, isochore_session_changed, isochore_session_take_changes,
    isochore_session_uvs,
};
pub use options::{SessionOptions, StrokeOptions};
pub use query::{
    Arrow, History, Hit, Origin, isochore_session_closest_point, isochore_session_history,
    isochore_session_moved_volume, isochore_session_origin, isochore_session_pick, isochore_session_preview,
    isochore_session_vertex_map, isochore_session_vertices, isochore_session_vertices_in_reach,
    isochore_session_volume,
};
pub use receipt::{LockSkipped, MoveReceipt, StrokeReceipt};

use crate::{
    error::{Failure, Status, guarded},
    memory::{array, free, hand_over, hand_over_text, put_optional, reference, reference_mut},
    mesh::Mesh,
    tool::Tool,
};

/// A sculpting session: a mesh that strokes deform one after another, with undo and redo.
#[derive(Debug)]
pub struct Session {
    session: session::Session,
    /// Changed ranges of each buffer, as of the last call to `isochore_session_take_changes`.
    changed: [Vec<Range>; 4],
    /// Result of the last call to `isochore_session_vertices`.
    vertices: Vec<u32>,
    /// Result of the last call to `isochore_session_vertex_map`.
    vertex_map: Vec<u32>,
    /// Result of the last call to `isochore_session_vertices_in_reach`.
    reached: Vec<u32>,
    /// Result of the last call to `isochore_session_preview`.
    arrows: Vec<Arrow>,
}

/// Opens a session on a manifold, consistently oriented mesh. The mesh may be freed while the
/// session is in use. `options` may be NULL.
///
/// Returns `ISOCHORE_STATUS_MESH` if the mesh or an option cannot be used, and
/// `ISOCHORE_STATUS_RECIPE` if the JSON of the mask is invalid.
///
/// Preconditions: `mesh` is a handle. `options` is NULL, or has `weight_count` weights and a mask
/// that is NULL or a string. `session` is writable. Free the session with `isochore_session_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_new(
    mesh: *const Mesh,
    options: *const SessionOptions,
    session: *mut *mut Session,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (mesh, options) = unsafe { (reference("mesh", mesh)?, options.as_ref()) };
        let mut chosen = session::SessionOptions::default();
        if let Some(options) = options {
            if options.step != 0.0 {
                chosen.step = options.step;
            }
            if options.undo_bytes != 0 {
                chosen.undo_bytes = options.undo_bytes;
            }
            if options.angle_normals {
                chosen.normals = NormalWeights::Angle;
            }
            chosen.lock = !options.unlocked;
            // SAFETY: the caller guarantees it.
            chosen.mask = unsafe { mask(options) }?;
        }
        let opened = session::Session::open(Arc::clone(&mesh.mesh), chosen)
            .map_err(|error| Failure::new(Status::Mesh, error))?;
        let opened = Session {
            session: opened,
            changed: Default::default(),
            vertices: Vec::new(),
            vertex_map: Vec::new(),
            reached: Vec::new(),
            arrows: Vec::new(),
        };
        // SAFETY: the caller guarantees it.
        unsafe { hand_over("session", session, opened) }
    })
}

/// Begins a stroke. The first pose only places the tool; later ones move it. `options` may be NULL.
///
/// Returns `ISOCHORE_STATUS_STATE` if a stroke is in progress and `ISOCHORE_STATUS_ARGUMENT` if an
/// option is out of range.
///
/// Preconditions: `session` and `tool` are handles. `options` is NULL, or has 4 × `keep_count`
/// values in `keep`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_begin_stroke(
    session: *mut Session,
    tool: *const Tool,
    options: *const StrokeOptions,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (session, tool) = unsafe { (reference_mut("session", session)?, reference("tool", tool)?) };
        let mut refinement = InteractiveRefinement::default();
        let mut keeps_triangles = false;
        // SAFETY: the caller guarantees it.
        if let Some(options) = unsafe { options.as_ref() } {
            keeps_triangles = options.keep_triangles;
            if options.longest_edge != 0.0 {
                refinement.longest = Some(options.longest_edge);
            }
            if options.deviation != 0.0 {
                refinement.deviation = Some(options.deviation);
            }
            if options.max_triangles != 0 {
                refinement.max_triangles = options.max_triangles;
            }
            // SAFETY: the caller guarantees it.
            let balls = unsafe { array("options.keep", options.keep.cast::<[f64; 4]>(), options.keep_count) }?;
            refinement.keep = balls.iter().map(|&[x, y, z, radius]| (DVec3::new(x, y, z), radius)).collect();
        }
        let options = session::StrokeOptions { refine: (!keeps_triangles).then_some(refinement) };
        Ok(session.session.begin_stroke(&tool.tool, options)?)
    })
}

/// Moves the tool to a pose along a screw motion. `at` is x, y, z in model units. `rotate` is the
/// axis x, y, z and the angle in degrees, relative to the unrotated tool; NULL means unrotated.
/// `time` is the time of the host in seconds and affects only the receipt. `receipt` may be NULL.
///
/// Returns `ISOCHORE_STATUS_STATE` if no stroke is in progress, and `ISOCHORE_STATUS_ARGUMENT` if a
/// number is not finite, the axis is zero, or `time` decreases.
///
/// Preconditions: `session` is a handle. `at` has 3 values. `rotate` is NULL or has 4 values.
/// `receipt` is NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_move_to(
    session: *mut Session,
    at: *const f64,
    rotate: *const f64,
    time: f64,
    receipt: *mut MoveReceipt,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (session, key) = unsafe { (reference_mut("session", session)?, key(at, rotate)?) };
        let done = session.session.move_to_key(&key, time)?;
        // SAFETY: the caller guarantees it.
        unsafe { put_optional(receipt, done.into()) };
        Ok(())
    })
}

/// Converts a position and an optional rotation to a pose.
///
/// # Safety
/// `at` is NULL or has 3 values, `rotate` is NULL or has 4.
unsafe fn pose(at: *const f64, rotate: *const f64) -> Result<Pose, Failure> {
    // SAFETY: the caller guarantees it.
    unsafe { key(at, rotate) }?.pose().map_err(Failure::argument)
}

/// The same pose as the log records it.
///
/// # Safety
/// As for [`pose`].
unsafe fn key(at: *const f64, rotate: *const f64) -> Result<Key, Failure> {
    let no_rotation = [0.0, 0.0, 1.0, 0.0];
    // SAFETY: the caller guarantees it.
    let (at, rotate) =
        unsafe { (array("at", at, 3)?, if rotate.is_null() { &no_rotation } else { array("rotate", rotate, 4)? }) };
    Ok(Key { at: [at[0], at[1], at[2]], rotate: [rotate[0], rotate[1], rotate[2], rotate[3]] })
}

/// Ends the stroke in progress and applies the volume lock. `receipt` may be NULL.
///
/// Returns `ISOCHORE_STATUS_STATE` if no stroke is in progress.
///
/// Preconditions: `session` is a handle. `receipt` is NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_end_stroke(session: *mut Session, receipt: *mut StrokeReceipt) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let session = unsafe { reference_mut("session", session) }?;
        let done = session.session.end_stroke()?;
        // SAFETY: the caller guarantees it.
        unsafe { put_optional(receipt, done.into()) };
        Ok(())
    })
}

/// Discards the stroke in progress.
///
/// Returns `ISOCHORE_STATUS_STATE` if no stroke is in progress.
///
/// Preconditions: `session` is a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_cancel_stroke(session: *mut Session) -> Status {
    // SAFETY: the caller guarantees it.
    guarded(|| Ok(unsafe { reference_mut("session", session) }?.session.cancel_stroke()?))
}

/// Undoes the last stroke, bit for bit. If `is_done` is not NULL, it receives whether there was a
/// stroke to undo.
///
/// Returns `ISOCHORE_STATUS_STATE` if a stroke is in progress.
///
/// Preconditions: `session` is a handle. `is_done` is NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_undo(session: *mut Session, is_done: *mut bool) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let done = unsafe { reference_mut("session", session) }?.session.undo()?;
        // SAFETY: the caller guarantees it.
        unsafe { put_optional(is_done, done) };
        Ok(())
    })
}

/// Redoes the last undone stroke, bit for bit. If `is_done` is not NULL, it receives whether there
/// was a stroke to redo.
///
/// Returns `ISOCHORE_STATUS_STATE` if a stroke is in progress.
///
/// Preconditions: `session` is a handle. `is_done` is NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_redo(session: *mut Session, is_done: *mut bool) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let done = unsafe { reference_mut("session", session) }?.session.redo()?;
        // SAFETY: the caller guarantees it.
        unsafe { put_optional(is_done, done) };
        Ok(())
    })
}

/// Excludes the edges at the given vertices from splits, collapses and flips. The vertices replace
/// those of the previous call and may include inserted ones.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if a vertex is out of range.
///
/// Preconditions: `session` is a handle. `vertices` has `count` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_freeze_edges(
    session: *mut Session,
    vertices: *const u32,
    count: usize,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (session, vertices) = unsafe { (reference_mut("session", session)?, array("vertices", vertices, count)?) };
        session.session.freeze_edges(vertices).map_err(Failure::argument)
    })
}

/// Returns the strokes that are in effect as a recipe in JSON. The recipe names its target
/// `target`. Free the string with `isochore_text_free`.
///
/// Preconditions: `session` is a handle. `recipe` is writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_log(session: *const Session, recipe: *mut *mut c_char) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let log = unsafe { reference("session", session) }?.session.log().to_json();
        // SAFETY: the caller guarantees it.
        unsafe { hand_over_text("recipe", recipe, &log) }
    })
}

/// Copies the surface to a new mesh. If `lock` is true, positions include the displacements of the
/// volume lock; otherwise they are those of the flow alone. `isochore_session_vertices` maps the
/// vertices of the mesh to those of the session.
///
/// Preconditions: `session` is a handle. `mesh` is writable. Free the mesh with
/// `isochore_mesh_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_export(session: *const Session, lock: bool, mesh: *mut *mut Mesh) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let exported = unsafe { reference("session", session) }?.session.export(lock);
        // SAFETY: the caller guarantees it.
        unsafe { hand_over("mesh", mesh, Mesh { mesh: exported.mesh.into() }) }
    })
}

/// Frees a session.
///
/// Preconditions: `session` is NULL or a handle that has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_free(session: *mut Session) {
    // SAFETY: the caller guarantees it.
    unsafe { free(session) }
}
