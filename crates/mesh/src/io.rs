//! Mesh files: OBJ, glTF, GLB, PLY, STL and OFF.
//!
//! [`read`] and [`write`](fn@write) choose the format by the file extension. [`read_bytes`] and
//! [`write_to`] work without files. [`Format`] lists which attributes each format can store.
//! [`PointStream`] processes point files that do not fit into memory.
//!
//! ```
//! use isochore_mesh::io::{self, Format};
//! use isochore_mesh::{ClosedMesh, primitives};
//!
//! let ball = primitives::icosphere(1.0, 3);
//! let mut bytes = Vec::new();
//! io::write_to(Format::Obj, &ball, &mut bytes)?;
//! let read = io::read_bytes(Format::Obj, &bytes)?;
//! assert_eq!(ClosedMesh::new(&read)?.volume(), ball.volume());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod by_corner;
mod element;
mod format;
mod gltf;
mod links;
mod obj;
mod off;
mod ply;
mod point_stream;
mod polygon;
mod read_error;
mod sniff;
mod split;
mod stl;
mod text;
mod write_error;

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

pub use format::Format;
pub use links::follow_links;
pub use point_stream::{PointStream, PointStreamError};
pub use read_error::{LineProblem, ParseError, ReadError};
pub use split::SplitVertices;
pub use write_error::WriteError;

use crate::TriMesh;
use crate::huge_pages::in_huge_pages;

/// Reads the mesh file at `path`, and the files that it refers to, relative to its folder.
///
/// Polygons are triangulated. Vertices that the format splits at seams are welded. The result has
/// only valid indices and finite positions; use [`TriMesh::check`] to find other defects. A mesh
/// without a name is named after its file.
///
/// # Errors
/// [`ReadError`], which names the file and the faulty element in it.
///
/// ```
/// use isochore_mesh::{io, primitives};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("ball.ply");
/// io::write(&path, &primitives::icosphere(1.0, 2))?;
/// let ball = io::read(&path)?;
/// assert_eq!(ball.triangles.len(), 320);
/// assert_eq!(ball.assets.names.mesh, "ball");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(path: impl AsRef<Path>) -> Result<TriMesh, ReadError> {
    let path = path.as_ref();
    let format = Format::of_path(path).ok_or_else(|| ReadError::UnknownFormat { path: path.to_owned() })?;
    let failed = |source| ReadError::Io { path: path.to_owned(), source };
    let bytes = read_file(path).map_err(failed)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut mesh = parse(format, &bytes, &|relative| std::fs::read(folder.join(relative)))
        .map_err(|source| ReadError::Parse { path: path.to_owned(), source: Box::new(source) })?;
    if mesh.assets.names.mesh.is_empty() {
        let stem = path.file_stem().unwrap_or_default();
        mesh.assets.names.mesh = stem.to_string_lossy().into_owned();
    }
    Ok(mesh)
}

fn read_file(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let size = usize::try_from(file.metadata()?.len()).unwrap_or(usize::MAX);
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(size)?;
    bytes = in_huge_pages(bytes);
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a mesh from memory, as [`read`] does from a file. References to other files are errors.
///
/// # Errors
/// [`ParseError`], which names the faulty line or element.
///
/// ```
/// use isochore_mesh::io::{self, Format};
///
/// let mesh = io::read_bytes(Format::Off, b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")?;
/// assert_eq!(mesh.area(), 0.5);
/// let error = io::read_bytes(Format::Off, b"OFF\n1 1 0\n0 0 0\n3 0 1 2\n").unwrap_err();
/// assert_eq!(error.to_string(), "line 4: vertex 1 is out of range: there are 1");
/// # Ok::<(), isochore_mesh::io::ParseError>(())
/// ```
pub fn read_bytes(format: Format, bytes: &[u8]) -> Result<TriMesh, ParseError> {
    parse(format, bytes, &|_| Err(std::io::ErrorKind::NotFound.into()))
}

/// Returns the bytes of a referenced file, given its path relative to the referring file.
type Resolve<'a> = &'a dyn Fn(&Path) -> std::io::Result<Vec<u8>>;

fn parse(announced: Format, bytes: &[u8], resolve: Resolve<'_>) -> Result<TriMesh, ParseError> {
    let format = sniff::format_of(bytes)?.unwrap_or(announced);
    let (mut mesh, has_finite_corners) = match format {
        Format::Obj => (obj::parse(bytes)?, false),
        Format::Ply => (ply::parse(bytes)?, false),
        Format::Stl => (stl::parse(bytes)?, false),
        Format::Off => (off::parse(bytes)?, false),
        // The first bytes of the file distinguish the two.
        Format::Gltf | Format::Glb => gltf::parse(bytes, resolve)?,
    };
    if mesh.triangles.is_empty() {
        return Err(ParseError::Empty);
    }
    mesh.check_valid()?;
    element::mend_attributes(&mut mesh, has_finite_corners);
    if format.name() != announced.name() {
        let (found, expected) = (format.name(), announced.name());
        mesh.assets.notes.push(format!("the content is {found}, not {expected}; it was read as {found}"));
    }
    Ok(mesh)
}

/// Writes `mesh` to `path` in the format of its extension, completely or not at all: first to a
/// temporary file in the same folder, which then replaces an existing file. A symbolic link stays,
/// and the file that it points to is replaced.
///
/// # Errors
/// [`WriteError`], which names the file. An existing file is then unchanged.
pub fn write(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<(), WriteError> {
    let path = path.as_ref();
    let format = Format::of_path(path).ok_or_else(|| WriteError::UnknownFormat { path: path.to_owned() })?;
    check_writable(format, mesh, path)?;
    let failed = |source| WriteError::Io { path: path.to_owned(), source };
    let target = follow_links(path).map_err(failed)?;
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    // Check first: the error for a missing folder would otherwise name the temporary file in it.
    std::fs::metadata(folder).map_err(failed)?;
    let file = temporary_file(folder).map_err(failed)?;
    // A small buffer, which the large blocks that most formats collect bypass. Copying those once
    // more would take as long as writing them.
    let mut buffered = std::io::BufWriter::new(file.as_file());
    write_format(format, mesh, &mut buffered).map_err(failed)?;
    buffered.flush().map_err(failed)?;
    drop(buffered);
    file.as_file().sync_all().map_err(failed)?;
    if let Ok(replaced) = std::fs::metadata(path) {
        file.as_file().set_permissions(replaced.permissions()).map_err(failed)?;
    }
    file.persist(&target).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Writes `mesh` in `format` to `writer`.
///
/// # Errors
/// [`WriteError`]. The writer may then have received a part of the file, which the caller must
/// discard.
pub fn write_to(format: Format, mesh: &TriMesh, writer: &mut dyn Write) -> Result<(), WriteError> {
    check_writable(format, mesh, Path::new(""))?;
    write_format(format, mesh, writer).map_err(|source| WriteError::Io { path: Path::new("").to_owned(), source })
}

fn write_format(format: Format, mesh: &TriMesh, writer: &mut dyn Write) -> std::io::Result<()> {
    match format {
        Format::Obj => obj::write(mesh, writer),
        Format::Ply => ply::write(mesh, writer),
        Format::Stl => stl::write(mesh, writer),
        Format::Off => off::write(mesh, writer),
        Format::Gltf => gltf::write_json(mesh, writer),
        Format::Glb => gltf::write_binary(mesh, writer),
    }
}

/// Refuses meshes that could not be read back: invalid ones, and coordinates beyond the format's
/// range.
fn check_writable(format: Format, mesh: &TriMesh, path: &Path) -> Result<(), WriteError> {
    mesh.check_valid().map_err(|source| WriteError::Invalid { path: path.to_owned(), source })?;
    if format.is_single_precision() {
        let is_too_large = |position: &glam::DVec3| !position.as_vec3().is_finite();
        if let Some(vertex) = mesh.positions.iter().position(is_too_large) {
            return Err(WriteError::TooLarge { path: path.to_owned(), vertex });
        }
    }
    Ok(())
}

/// Creates a temporary file in `folder` with the permissions of an ordinary new file.
fn temporary_file(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".isochore-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The default of `tempfile` is readable by its owner only. The system applies its umask to
        // this mode.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}
