//! Sculpting sessions.

mod query;
mod receipt;

use std::{ffi::c_char, sync::Arc};

use glam::DVec3;
use isochore_field::Pose;
use isochore_sculpt::{
    recipe::{Key, Mask, VertexWeights},
    session::{self, DirtyRange, InteractiveRefinement, NormalWeights},
};

pub use query::{
    Arrow, History, Hit, Origin, isochore_session_closest_point, isochore_session_history,
    isochore_session_moved_volume, isochore_session_origin, isochore_session_pick, isochore_session_preview,
    isochore_session_vertex_map, isochore_session_vertices, isochore_session_vertices_in_reach,
    isochore_session_volume,
};
pub use receipt::{LockSkipped, MoveReceipt, StrokeReceipt};

use crate::{
    error::{Failure, Status, guarded},
    memory::{array, free, hand_over, hand_over_text, put, put_if_wanted, put_slice, reference, reference_mut, text},
    mesh::Mesh,
    tool::Tool,
};

/// A mesh that strokes deform one after the other, with undo and redo.
#[derive(Debug)]
pub struct Session {
    session: session::Session,
    /// By buffer what has changed since it was last asked for.
    changed: [Vec<Range>; 4],
    /// The vertices that were last asked for.
    vertices: Vec<u32>,
    /// The vertices in the place of those of the mesh as opened, when they were last asked for.
    vertex_map: Vec<u32>,
    /// The vertices in reach that were last asked for.
    reached: Vec<u32>,
    /// The preview that was last asked for.
    arrows: Vec<Arrow>,
}

/// How a session works. Zeros and NULL stand for the usual.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SessionOptions {
    /// Travel of the fastest point of the tool's surface in one time step, as a share of the support or of half the tool's shortest
    /// extent, whichever is less; at most 1.
    pub step: f64,
    /// Bytes that undo and redo may hold.
    pub undo_bytes: usize,
    /// A weight for each vertex of the mesh, from 0, free, to 1, held: those that are held keep their bits.
    pub weights: *const f64,
    /// Number of weights.
    pub weight_count: usize,
    /// Whether triangles are weighted by their angles in vertex normals, and not by their areas.
    pub angle_normals: bool,
    /// Whether strokes end as the flow leaves them, without the small displacement that gives back the volume exactly.
    pub unlocked: bool,
    /// What else a recipe says under `mask`, in JSON: `{"pins": [...], "mirror": [...], "fade": 0.1}`.
    pub mask: *const c_char,
}

/// How one stroke works. Zeros and NULL stand for the usual.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct StrokeOptions {
    /// Whether all triangles stay; otherwise edges in the tool's reach are split, collapsed and flipped.
    pub keep_triangles: bool,
    /// Edges longer than this are split, model units.
    pub longest_edge: f64,
    /// No split goes beyond this number of triangles.
    pub max_triangles: usize,
    /// Balls in which the triangles stay: x, y, z and radius of each, model units.
    pub keep: *const f64,
    /// Number of balls.
    pub keep_count: usize,
}

/// Buffers for a renderer, in place: the session's own memory, until the session changes. Texture coordinates are apart, by set:
/// `isochore_session_uvs`.
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
    /// Texture coordinates, colors and origins, by render vertex.
    Attributes = 2,
    /// Indices, by triangle.
    Indices = 3,
}

/// Opens a session on a manifold, oriented mesh, which may be given back before the session. `options` may be NULL.
///
/// # Safety
/// `mesh` is a handle; `options` is NULL or has `weight_count` weights and a mask that is NULL or a text; `session` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_new(
    mesh: *const Mesh,
    options: *const SessionOptions,
    session: *mut *mut Session,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
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
            // SAFETY: as the caller promises.
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
        // SAFETY: as the caller promises.
        unsafe { hand_over("session", session, opened) }
    })
}

/// # Safety
/// The weights and the text are as the options say.
unsafe fn mask(options: &SessionOptions) -> Result<Mask, Failure> {
    let mut mask = Mask::default();
    if !options.mask.is_null() {
        // SAFETY: as the caller promises.
        let words = unsafe { text("options.mask", options.mask) }?;
        mask = serde_json::from_str(words).map_err(|error| Failure::new(Status::Recipe, format!("mask: {error}")))?;
    }
    if !options.weights.is_null() {
        // SAFETY: as the caller promises.
        let weights = unsafe { array("options.weights", options.weights, options.weight_count) }?;
        mask.vertices = Some(VertexWeights::Values(weights.to_vec()));
    }
    Ok(mask)
}

/// Begins a stroke; nothing moves before the second pose. `options` may be NULL.
///
/// # Safety
/// `session` and `tool` are handles; `options` is NULL or has four values for each of its balls.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_begin_stroke(
    session: *mut Session,
    tool: *const Tool,
    options: *const StrokeOptions,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let (session, tool) = unsafe { (reference_mut("session", session)?, reference("tool", tool)?) };
        let mut refinement = InteractiveRefinement::default();
        let mut keeps_triangles = false;
        // SAFETY: as the caller promises.
        if let Some(options) = unsafe { options.as_ref() } {
            keeps_triangles = options.keep_triangles;
            if options.longest_edge != 0.0 {
                refinement.longest = Some(options.longest_edge);
            }
            if options.max_triangles != 0 {
                refinement.max_triangles = options.max_triangles;
            }
            // SAFETY: as the caller promises.
            let balls = unsafe { array("options.keep", options.keep.cast::<[f64; 4]>(), options.keep_count) }?;
            refinement.keep = balls.iter().map(|&[x, y, z, radius]| (DVec3::new(x, y, z), radius)).collect();
        }
        let options = session::StrokeOptions { refine: (!keeps_triangles).then_some(refinement) };
        Ok(session.session.begin_stroke(&tool.tool, options)?)
    })
}

/// Moves the tool along a screw to a pose: `at`, x, y, z in model units, and `rotate`, axis x, y, z and angle in degrees, absolute;
/// NULL for none. `time` is the host's, in seconds. `receipt` may be NULL.
///
/// # Safety
/// `session` is a handle; `at` has three values, `rotate` four where it is not NULL; `receipt` can be written to where it is not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_move_to(
    session: *mut Session,
    at: *const f64,
    rotate: *const f64,
    time: f64,
    receipt: *mut MoveReceipt,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let (session, pose) = unsafe { (reference_mut("session", session)?, pose(at, rotate)?) };
        let done = session.session.move_to(&pose, time)?;
        // SAFETY: as the caller promises.
        unsafe { put_if_wanted(receipt, done.into()) };
        Ok(())
    })
}

/// # Safety
/// `at` is NULL or has three values, `rotate` is NULL or has four.
unsafe fn pose(at: *const f64, rotate: *const f64) -> Result<Pose, Failure> {
    let no_turn = [0.0, 0.0, 1.0, 0.0];
    // SAFETY: as the caller promises.
    let (at, rotate) =
        unsafe { (array("at", at, 3)?, if rotate.is_null() { &no_turn } else { array("rotate", rotate, 4)? }) };
    let key = Key { at: [at[0], at[1], at[2]], rotate: [rotate[0], rotate[1], rotate[2], rotate[3]] };
    key.pose().map_err(Failure::argument)
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
        // SAFETY: as the caller promises.
        unsafe { put_if_wanted(receipt, done.into()) };
        Ok(())
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
        unsafe { put_if_wanted(is_done, done) };
        Ok(())
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
        unsafe { put_if_wanted(is_done, done) };
        Ok(())
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
        let colors = now.colors.as_flattened();
        let place = Buffers {
            generation: now.generation,
            vertex_count: now.positions.len(),
            positions: now.positions.as_flattened().as_ptr(),
            normals: now.normals.as_flattened().as_ptr(),
            colors: if colors.is_empty() { std::ptr::null() } else { colors.as_ptr() },
            triangle_count: now.indices.len(),
            indices: now.indices.as_flattened().as_ptr(),
        };
        // SAFETY: as the caller promises.
        unsafe { put("buffers", buffers, place) }
    })
}

/// Tells where the texture coordinates of a set lie, and how many numbers they are: two a render vertex, none where there is no such
/// set. They are buffers as the others are, and the generation counts for them too.
///
/// # Safety
/// `session` is a handle; `uvs` and `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_uvs(
    session: *const Session,
    set: usize,
    uvs: *mut *const f32,
    count: *mut usize,
) -> Status {
    // SAFETY: as the caller promises.
    guarded(|| unsafe {
        let sets = reference("session", session)?.session.buffers().uvs;
        put_slice("uvs", uvs, count, sets.get(set).map_or(&[], |uvs| uvs.as_flattened()))
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

/// The ranges of a buffer, one of `IsochoreBuffer`, that `isochore_session_take_changes` found to have changed, in order: `count` of
/// them, in the session's own memory, until it is asked again.
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
        unsafe { put_slice("ranges", ranges, count, found) }
    })
}

/// Keeps the edges at some vertices, inserted ones included, from being split, collapsed or flipped from now on, and frees all others.
///
/// # Safety
/// `session` is a handle; there are `count` vertices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_freeze_edges(
    session: *mut Session,
    vertices: *const u32,
    count: usize,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let (session, vertices) = unsafe { (reference_mut("session", session)?, array("vertices", vertices, count)?) };
        session.session.freeze_edges(vertices).map_err(Failure::argument)
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

/// The surface as a mesh of its own. With `lock`, with what the lock has added at the end of each stroke; else where the flow
/// alone has taken it. Which vertices it has, `isochore_session_vertices` tells.
///
/// # Safety
/// `session` is a handle; `mesh` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_export(session: *const Session, lock: bool, mesh: *mut *mut Mesh) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let exported = unsafe { reference("session", session) }?.session.export(lock);
        // SAFETY: as the caller promises.
        unsafe { hand_over("mesh", mesh, Mesh { mesh: exported.mesh.into() }) }
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
