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

/// A tool ready to work, made once and shared between strokes and sessions.
#[derive(Debug)]
pub struct Tool {
    pub(crate) tool: Arc<SessionTool>,
}

/// Makes a tool from what a recipe says of one, in JSON: `{"shape": {"kind": "sphere", "radius": 0.1}, "support": 0.1}`. `name` is
/// what the log calls it. A mesh is sampled now; `progress` may be NULL.
///
/// # Safety
/// `name` and `description` are texts; `meshes` has `mesh_count` entries; `progress` may be called from any thread with `context`;
/// `tool` can be written to.
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
        // SAFETY: as the caller promises.
        let (name, words, meshes) = unsafe {
            (text("name", name)?, text("description", description)?, named(array("meshes", meshes, mesh_count)?)?)
        };
        let description: recipe::Tool = serde_json::from_str(words)
            .map_err(|error| Failure::new(Status::Recipe, format!("tools.{name}: {error}")))?;
        let made = SessionTool::new(name, description, &meshes, &Watcher::new(progress, context))?;
        // SAFETY: as the caller promises.
        unsafe { hand_over("tool", tool, Tool { tool: Arc::new(made) }) }
    })
}

/// Gives a tool back. Sessions that use it go on.
///
/// # Safety
/// `tool` is NULL or a handle that was not given back yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_tool_free(tool: *mut Tool) {
    // SAFETY: as the caller promises.
    unsafe { free(tool) }
}
