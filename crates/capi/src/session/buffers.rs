//! Render buffers of a session and their changes.

use isochore_sculpt::session::DirtyRange;

use super::Session;
use crate::{
    error::{Failure, Status, guarded},
    memory::{put, put_slice, reference, reference_mut},
};

/// Buffers for a renderer. The arrays belong to the session and are valid until it changes.
/// `isochore_session_uvs` returns the texture coordinates.
///
/// A render vertex is a vertex as seen by the triangles on one side of a seam. The three indices of
/// a removed triangle are 0.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Buffers {
    /// Increases whenever a buffer has moved in memory.
    pub generation: u64,
    /// Number of render vertices.
    pub vertex_count: usize,
    /// x, y, z of each render vertex, model units.
    pub positions: *const f32,
    /// Unit normal of each render vertex.
    pub normals: *const f32,
    /// Linear red, green, blue and alpha of each render vertex, or NULL if the mesh has no colors.
    pub colors: *const f32,
    /// Number of triangles, including removed ones.
    pub triangle_count: usize,
    /// Three render vertices of each triangle, counter-clockwise as seen from outside.
    pub indices: *const u32,
}

/// Half-open range of elements of a buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// First element.
    pub start: u32,
    /// One past the last element.
    pub end: u32,
}

/// Identifies a buffer.
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
/// Gets the addresses and sizes of the render buffers.
///
/// Preconditions: `session` is a handle. `buffers` is writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_buffers(session: *const Session, buffers: *mut Buffers) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let now = unsafe { reference("session", session) }?.session.buffers();
        let colors = now.colors.as_flattened();
        let pointers = Buffers {
            generation: now.generation,
            vertex_count: now.positions.len(),
            positions: now.positions.as_flattened().as_ptr(),
            normals: now.normals.as_flattened().as_ptr(),
            colors: if colors.is_empty() { std::ptr::null() } else { colors.as_ptr() },
            triangle_count: now.indices.len(),
            indices: now.indices.as_flattened().as_ptr(),
        };
        // SAFETY: the caller guarantees it.
        unsafe { put("buffers", buffers, pointers) }
    })
}

/// Gets the texture coordinates of a set, u, v of each render vertex. `count` receives the number
/// of values: 2 per render vertex, or 0 if the set does not exist. The array is a buffer like those
/// of `IsochoreBuffers`, and `generation` covers it.
///
/// Preconditions: `session` is a handle. `uvs` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_uvs(
    session: *const Session,
    set: usize,
    uvs: *mut *const f32,
    count: *mut usize,
) -> Status {
    // SAFETY: the caller guarantees it.
    guarded(|| unsafe {
        let sets = reference("session", session)?.session.buffers().uvs;
        put_slice("uvs", uvs, count, sets.get(set).map_or(&[], |uvs| uvs.as_flattened()))
    })
}

/// Records the buffer ranges that have changed since the previous call, for
/// `isochore_session_changed`. The first call records everything.
///
/// Preconditions: `session` is a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_take_changes(session: *mut Session) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let session = unsafe { reference_mut("session", session) }?;
        let changes = session.session.take_changes();
        let ranges = |ranges: Vec<DirtyRange>| {
            ranges.into_iter().map(|range| Range { start: range.start, end: range.end }).collect()
        };
        session.changed = [changes.positions, changes.normals, changes.attributes, changes.indices].map(ranges);
        Ok(())
    })
}

/// Gets the ranges of a buffer that `isochore_session_take_changes` recorded, in ascending order.
/// `buffer` is a value of `IsochoreBuffer`. The array belongs to the session and is valid until the
/// next call to `isochore_session_take_changes`.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if `buffer` is out of range.
///
/// Preconditions: `session` is a handle. `ranges` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_changed(
    session: *const Session,
    buffer: u32,
    ranges: *mut *const Range,
    count: *mut usize,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let session = unsafe { reference("session", session) }?;
        let found = session.changed.get(buffer as usize);
        let found =
            found.ok_or_else(|| Failure::argument(format!("buffer {buffer} is out of range: there are 4 buffers")))?;
        // SAFETY: the caller guarantees it.
        unsafe { put_slice("ranges", ranges, count, found) }
    })
}
