//! Mesh files: OBJ, glTF, GLB, PLY, STL and OFF.
//!
//! [`read`] and [`write`] choose the format by the file's extension; [`read_bytes`] and [`write_to`] need no files.
//! What a format can hold decides what survives: see [`Format`]. [`PointStream`] is for points that do not fit into memory.
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
mod format;
mod gltf;
mod obj;
mod off;
mod ply;
mod point_stream;
mod polygon;
mod read_error;
mod split;
mod stl;
mod text;
mod write_error;

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

pub use format::Format;
pub use point_stream::{PointStream, PointStreamError};
pub use read_error::{LineProblem, ParseError, ReadError};
pub use split::SplitVertices;
pub use write_error::WriteError;

use crate::huge_pages::in_huge_pages;
use crate::{CornerAttributes, TriMesh};

/// Reads the mesh file at `path`, and the files beside it that it refers to.
///
/// Polygons are triangulated. Vertices that the format splits at seams are welded. Indices are in range and positions
/// finite in what comes back; everything else is for [`TriMesh::check`]. A mesh without a name gets that of its file.
///
/// # Errors
/// [`ReadError`], naming the file and what in it is at fault.
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
/// [`ParseError`], naming the line or element at fault.
pub fn read_bytes(format: Format, bytes: &[u8]) -> Result<TriMesh, ParseError> {
    parse(format, bytes, &|_| Err(std::io::ErrorKind::NotFound.into()))
}

/// Gives the bytes of a file that another one refers to, by its path relative to that one.
type Resolve<'a> = &'a dyn Fn(&Path) -> std::io::Result<Vec<u8>>;

fn parse(format: Format, bytes: &[u8], resolve: Resolve<'_>) -> Result<TriMesh, ParseError> {
    let (mesh, has_finite_corners) = match format {
        Format::Obj => (obj::parse(bytes)?, false),
        Format::Ply => (ply::parse(bytes)?, false),
        Format::Stl => (stl::parse(bytes)?, false),
        Format::Off => (off::parse(bytes)?, false),
        // Which of the two it is, the bytes tell.
        Format::Gltf | Format::Glb => gltf::parse(bytes, resolve)?,
    };
    if mesh.triangles.is_empty() {
        return Err(ParseError::Empty);
    }
    mesh.check_valid()?;
    check_attributes(&mesh, has_finite_corners)?;
    Ok(mesh)
}

/// What is interpolated must be finite, or one bad number would spread. Corners that are known to be so are not looked at.
fn check_attributes(mesh: &TriMesh, has_finite_corners: bool) -> Result<(), ParseError> {
    if !has_finite_corners {
        check_corners(&mesh.corner)?;
    }
    let is_bad_skin = |skin: &Vec<(u32, f64)>| skin.iter().any(|(_, weight)| !weight.is_finite());
    let by_vertex = [
        ("color", mesh.vertex.colors.iter().position(|color| !color.is_finite())),
        ("skin weight", mesh.vertex.skin.iter().position(is_bad_skin)),
    ];
    for (attribute, vertex) in by_vertex {
        if let Some(vertex) = vertex {
            return Err(ParseError::NonFinite { attribute, element: "vertex", number: vertex });
        }
    }
    Ok(())
}

fn check_corners(corner: &CornerAttributes) -> Result<(), ParseError> {
    fn first_bad<T>(corners: &[[T; 3]], is_finite: impl Fn(&T) -> bool) -> Option<usize> {
        corners.iter().position(|corners| !corners.iter().all(&is_finite))
    }
    let by_triangle = [
        ("texture coordinate", corner.uvs.iter().find_map(|set| first_bad(set, |uv| uv.is_finite()))),
        ("normal", first_bad(&corner.normals, |normal| normal.is_finite())),
        ("color", first_bad(&corner.colors, |color| color.is_finite())),
    ];
    for (attribute, triangle) in by_triangle {
        if let Some(triangle) = triangle {
            return Err(ParseError::NonFinite { attribute, element: "triangle", number: triangle });
        }
    }
    Ok(())
}

/// Writes `mesh` to `path`, in the format of its extension, whole or not at all: into a temporary file in the same
/// folder first, which then takes the place of what was there.
///
/// # Errors
/// [`WriteError`], naming the file. An existing file is untouched then.
pub fn write(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<(), WriteError> {
    let path = path.as_ref();
    let format = Format::of_path(path).ok_or_else(|| WriteError::UnknownFormat { path: path.to_owned() })?;
    check_writable(format, mesh, path)?;
    let failed = |source| WriteError::Io { path: path.to_owned(), source };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    // Asked first, because the error of a missing folder would speak of the temporary file in it.
    std::fs::metadata(folder).map_err(failed)?;
    let file = temporary_file(folder).map_err(failed)?;
    // A small buffer, past which go the larger pieces that most formats gather: another copy would take as long as they do.
    let mut buffered = std::io::BufWriter::new(file.as_file());
    write_format(format, mesh, &mut buffered).map_err(failed)?;
    buffered.flush().map_err(failed)?;
    drop(buffered);
    file.as_file().sync_all().map_err(failed)?;
    if let Ok(replaced) = std::fs::metadata(path) {
        file.as_file().set_permissions(replaced.permissions()).map_err(failed)?;
    }
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Writes `mesh` in `format` to `writer`.
///
/// # Errors
/// [`WriteError`]; what was written before is the writer's to discard.
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

/// Refuses meshes that would come back different in kind: invalid ones, and those beyond single precision.
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

/// A temporary file in `folder` with the rights that any new file gets.
fn temporary_file(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".isochore-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The library's own choice is a file for its owner alone; from this one the system takes what its mask forbids.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}
