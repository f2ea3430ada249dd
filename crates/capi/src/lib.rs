//! C interface: opaque handles, status codes, and a header generated from these sources by
//! cbindgen.
//!
//! The comments on exported items become the comments of `isochore.h`, so they use C terms and C
//! names.

#![allow(unsafe_code, reason = "a C interface consists of raw pointers and exported symbols")]
#![allow(
    clippy::missing_safety_doc,
    reason = "cbindgen copies these comments into the C header, which states preconditions in C terms"
)]

mod error;
mod memory;
mod mesh;
mod monitor;
mod remesh;
mod replay;
mod session;
mod tool;

pub use error::{Status, isochore_last_error};
pub use memory::isochore_text_free;
pub use mesh::{
    Mesh, isochore_mesh_corner_colors, isochore_mesh_free, isochore_mesh_material_name, isochore_mesh_new,
    isochore_mesh_normals, isochore_mesh_positions, isochore_mesh_read, isochore_mesh_set_corner_colors,
    isochore_mesh_set_materials, isochore_mesh_set_normals, isochore_mesh_set_skin, isochore_mesh_set_uvs,
    isochore_mesh_set_vertex_colors, isochore_mesh_skin, isochore_mesh_skin_influences, isochore_mesh_triangle_count,
    isochore_mesh_triangle_materials, isochore_mesh_triangles, isochore_mesh_uvs, isochore_mesh_vertex_colors,
    isochore_mesh_vertex_count, isochore_mesh_volume, isochore_mesh_write,
};
pub use monitor::Progress;
pub use remesh::{RemeshOptions, RemeshReceipt, isochore_remesh};
pub use replay::{NamedMesh, isochore_run, isochore_run_file, isochore_run_points};
pub use session::{
    Arrow, Buffer, Buffers, History, Hit, LockSkipped, MoveReceipt, Origin, Range, Session, SessionOptions,
    StrokeOptions, StrokeReceipt, isochore_session_begin_stroke, isochore_session_buffers,
    isochore_session_cancel_stroke, isochore_session_changed, isochore_session_closest_point,
    isochore_session_end_stroke, isochore_session_export, isochore_session_free, isochore_session_freeze_edges,
    isochore_session_history, isochore_session_log, isochore_session_move_to, isochore_session_moved_volume,
    isochore_session_new, isochore_session_origin, isochore_session_pick, isochore_session_preview,
    isochore_session_redo, isochore_session_remesh, isochore_session_take_changes, isochore_session_undo, isochore_session_uvs,
    isochore_session_vertex_map, isochore_session_vertices, isochore_session_vertices_in_reach,
    isochore_session_volume,
};
pub use tool::{Tool, isochore_tool_free, isochore_tool_new};
