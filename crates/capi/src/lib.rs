//! isochore for C: handles, status codes, and a header that is made from this source.

#![allow(unsafe_code, reason = "the border to C is made of pointers and exported names")]

mod error;
mod memory;
mod mesh;
mod monitor;
mod replay;

pub use error::{Status, isochore_last_error};
pub use memory::isochore_text_free;
pub use mesh::{
    Mesh, isochore_mesh_free, isochore_mesh_new, isochore_mesh_positions, isochore_mesh_read,
    isochore_mesh_triangle_count, isochore_mesh_triangles, isochore_mesh_vertex_count, isochore_mesh_volume,
    isochore_mesh_write,
};
pub use monitor::Progress;
pub use replay::{NamedMesh, isochore_run};
