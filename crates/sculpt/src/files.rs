//! Loading the files that a recipe names: meshes, curves and the weights of masks.
//!
//! [`load`] resolves each name with a function of the caller: to a path, to bytes, or to a mesh
//! that is already in memory.
//!
//! ```
//! use isochore_sculpt::{Recipe, files::{self, NamedFile, TargetMesh}, recipe::Format};
//!
//! let text = r#"
//!     recipe = 1
//!     target = { mesh = "flat.obj" }
//! "#;
//! let mut recipe = Recipe::parse(text, Format::Toml, &[])?;
//! let bytes = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
//! let resolve = |name: &str| (name == "flat.obj").then_some(NamedFile::Bytes(bytes));
//! let meshes = files::load(&mut recipe, TargetMesh::Required, &resolve)?;
//! assert_eq!(meshes["flat.obj"].triangles, [[0, 1, 2]]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod csv_table;
mod error;
mod similar_name;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use isochore_mesh::{
    TriMesh,
    io::{self, Format, ReadError},
};

pub use csv_table::{CsvError, CsvTable};
pub use error::{FileProblem, LoadError};

use crate::{
    recipe::{Recipe, VertexWeights},
    scene::Meshes,
};

/// Contents of a file that a recipe names.
#[derive(Debug, Clone)]
pub enum NamedFile<'a> {
    /// A file to read.
    Path(PathBuf),
    /// Bytes of a file; the extension of its name gives the format of a mesh.
    Bytes(&'a [u8]),
    /// A mesh in memory.
    Mesh(Arc<TriMesh>),
}

/// Whether the mesh of the target is loaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TargetMesh {
    /// Loaded: for deforming the target.
    Required,
    /// Loaded if its name resolves: for deforming points.
    Optional,
    /// Not loaded: for a stream of points.
    Skipped,
}

/// The path of the file `name` in the recipe at the path `recipe`: names are relative to the
/// recipe.
pub fn beside(recipe: &Path, name: &str) -> PathBuf {
    recipe.parent().unwrap_or(Path::new("")).join(name)
}

/// Returns the meshes that `recipe` names, and replaces its curve files by their points and its
/// file of weights by its numbers.
///
/// Curve files and weights are tables of comma-separated values, with an optional header. Curves
/// have three columns, or six with tangents, which are ignored. Weights have one column, from 0 to
/// 1.
///
/// # Errors
/// [`LoadError`], with the key and the file at fault, if `resolve` returns `None` or a file cannot
/// be used.
pub fn load<'a>(
    recipe: &mut Recipe,
    target: TargetMesh,
    resolve: &dyn Fn(&str) -> Option<NamedFile<'a>>,
) -> Result<Meshes, LoadError> {
    load_curves(recipe, resolve)?;
    let meshes = load_meshes(recipe, target, resolve)?;
    load_weights(recipe, &meshes, resolve)?;
    Ok(meshes)
}

type Resolve<'r, 'a> = &'r dyn Fn(&str) -> Option<NamedFile<'a>>;

fn load_curves(recipe: &mut Recipe, resolve: Resolve<'_, '_>) -> Result<(), LoadError> {
    let names: Vec<String> = recipe.curve_names().into_iter().map(str::to_owned).collect();
    for name in names {
        let failed = |recipe: &Recipe, problem| LoadError::new(&recipe.curve_key(&name), &name, problem);
        let points = table(&name, resolve, &[3, 6]).map_err(|problem| failed(recipe, problem))?;
        let points: Vec<[f64; 3]> = points.rows().iter().map(|row| [row[0], row[1], row[2]]).collect();
        recipe.inline_curve(&name, &points);
    }
    Ok(())
}

fn load_meshes(recipe: &Recipe, target: TargetMesh, resolve: Resolve<'_, '_>) -> Result<Meshes, LoadError> {
    let mut meshes = Meshes::new();
    for (key, name) in recipe.mesh_keys() {
        let is_target = key == Recipe::TARGET_MESH;
        if meshes.contains_key(name) || is_target && target == TargetMesh::Skipped {
            continue;
        }
        let file = match resolve(name) {
            None if is_target && target == TargetMesh::Optional => continue,
            file => file,
        };
        let mesh = mesh(name, file).map_err(|problem| LoadError::new(&key, name, problem))?;
        meshes.insert(name.to_owned(), mesh);
    }
    Ok(meshes)
}

fn load_weights(recipe: &mut Recipe, meshes: &Meshes, resolve: Resolve<'_, '_>) -> Result<(), LoadError> {
    let Some(VertexWeights::File(name)) = &recipe.mask.vertices else { return Ok(()) };
    let target = recipe.target.mesh.as_ref().and_then(|name| meshes.get(name));
    let weights = weights(name, target.map(|mesh| mesh.positions.len()), resolve)
        .map_err(|problem| LoadError::new("mask.vertices", name, problem))?;
    recipe.mask.vertices = Some(VertexWeights::Values(weights));
    Ok(())
}

fn mesh(name: &str, file: Option<NamedFile<'_>>) -> Result<Arc<TriMesh>, FileProblem> {
    match file.ok_or(FileProblem::NotGiven)? {
        NamedFile::Path(path) => Ok(io::read(path)?.into()),
        NamedFile::Mesh(mesh) => Ok(mesh),
        NamedFile::Bytes(bytes) => {
            let path = PathBuf::from(name);
            let Some(format) = Format::of_path(&path) else { return Err(ReadError::UnknownFormat { path }.into()) };
            let mesh = io::read_bytes(format, bytes);
            Ok(mesh.map_err(|source| ReadError::Parse { path, source: Box::new(source) })?.into())
        }
    }
}

fn table(name: &str, resolve: Resolve<'_, '_>, allowed_columns: &[usize]) -> Result<CsvTable, FileProblem> {
    match resolve(name).ok_or(FileProblem::NotGiven)? {
        NamedFile::Path(path) => Ok(CsvTable::read(&path, allowed_columns)?),
        NamedFile::Bytes(bytes) => Ok(CsvTable::parse(Path::new(name), bytes, allowed_columns)?),
        NamedFile::Mesh(_) => Err(FileProblem::MeshForTable),
    }
}

/// The weights in the file `name`, one a row. `vertices` is the number of the target's vertices, if
/// it is known yet.
fn weights(name: &str, vertices: Option<usize>, resolve: Resolve<'_, '_>) -> Result<Vec<f64>, FileProblem> {
    let table = table(name, resolve, &[1])?;
    let weights: Vec<f64> = table.rows().iter().map(|row| row[0]).collect();
    if let Some(vertices) = vertices.filter(|&vertices| vertices != weights.len()) {
        let end = if weights.len() > vertices { "has no vertex" } else { "is the last" };
        let problem = format!("this weight {end}: {} weights for the {vertices} vertices of the target", weights.len());
        return Err(table.error(weights.len().min(vertices), problem).into());
    }
    match weights.iter().position(|weight| !(0.0..=1.0).contains(weight)) {
        Some(row) => {
            let problem = format!("{} is not a weight between 0 (free) and 1 (fixed)", weights[row]);
            Err(table.error(row, problem).into())
        }
        None => Ok(weights),
    }
}
