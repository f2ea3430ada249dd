//! Tools of sessions.

use std::{
    ffi::{c_char, c_void},
    sync::Arc,
};

use isochore_sculpt::{recipe, session::SessionTool};

use crate::{
    error::{Failure, Status, guarded},
    memory::{array, free, hand_over, text},
    monitor::{Progress, Watcher},
    replay::{NamedMesh, named},
};

/// A prepared tool. It can be used by any number of strokes and sessions.
#[derive(Debug)]
pub struct Tool {
    pub(crate) tool: Arc<SessionTool>,
}

/// Creates a tool from its description in a recipe, as JSON:
/// `{"shape": {"kind": "sphere", "radius": 0.1}, "support": 0.1}`.
/// `name` identifies the tool in the log of a session. `meshes` provides the mesh of a shape of
/// kind `mesh`, whose distance is sampled during this call. `progress` may be NULL.
///
/// Returns `ISOCHORE_STATUS_RECIPE` if the description is invalid or names a mesh that is missing
/// from `meshes`, and `ISOCHORE_STATUS_CANCELLED` if `progress` returned false.
///
/// Preconditions: `name` and `description` are strings. `meshes` has `mesh_count` entries. `tool`
/// is writable. Free the tool with `isochore_tool_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_tool_new(
    name: *const c_char,
    description: *const c_char,
    meshes: *const NamedMesh,
    mesh_count: usize,
    progress: Progress,
    context: *mut c_void,
    tool: *mut *mut Tool,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (name, json, meshes) = unsafe {
            (text("name", name)?, text("description", description)?, named(array("meshes", meshes, mesh_count)?)?)
        };
        let description: recipe::Tool = serde_json::from_str(json)
            .map_err(|error| Failure::new(Status::Recipe, format!("tools.{name}: {error}")))?;
        let built = SessionTool::new(name, description, &meshes, &Watcher::new(progress, context))?;
        // SAFETY: the caller guarantees it.
        unsafe { hand_over("tool", tool, Tool { tool: Arc::new(built) }) }
    })
}

/// Frees a tool. Sessions that use it remain valid.
///
/// Preconditions: `tool` is NULL or a handle that has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_tool_free(tool: *mut Tool) {
    // SAFETY: the caller guarantees it.
    unsafe { free(tool) }
}
