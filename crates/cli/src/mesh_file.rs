//! Reading the mesh file that an argument names.

use std::path::Path;

use isochore_mesh::{TriMesh, io};

use crate::{command_error::CommandError, console::Console};

/// Reads a mesh, and warns of what the reader left out or replaced.
pub(crate) fn read_mesh(path: &Path, console: &Console) -> Result<TriMesh, CommandError> {
    let mesh = io::read(path)?;
    for note in &mesh.assets.notes {
        console.warn("warning", format_args!("{}: {note}", path.display()));
    }
    Ok(mesh)
}
