//! Replay of recipes on meshes and points.

use std::{
    ffi::{c_char, c_void},
    fs,
    path::Path,
    sync::Arc,
};

use bytemuck::cast_slice;
use glam::DVec3;
use isochore_sculpt::{
    Meshes, Recipe, Report, Source,
    files::{self, LoadError, NamedFile, TargetMesh},
    recipe::Format,
    replay, replay_points,
};

use crate::{
    error::{Failure, Status, guarded},
    memory::{array, copy_into, finite_values, hand_over, hand_over_text, reference, text},
    mesh::Mesh,
    monitor::{Progress, Watcher},
};

/// A mesh with the name that a recipe uses for it.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct NamedMesh {
    /// Value of a `mesh` key of the recipe.
    pub name: *const c_char,
    /// The mesh.
    pub mesh: *const Mesh,
}

/// Deforms the target of a recipe. `recipe` is the text of a TOML document, or of a JSON document
/// if it begins with a brace. `meshes` provides the meshes that the recipe names; no file is read.
/// The recipe must contain the points of spines and the weights of masks itself. To let a recipe
/// read its files, use `isochore_run_file`.
///
/// Stores the deformed mesh in `mesh`. If `report` is not NULL, stores the report as a JSON string;
/// free it with `isochore_text_free`. `progress` may be NULL.
///
/// Returns `ISOCHORE_STATUS_RECIPE` if the recipe is invalid or names a mesh that is missing from
/// `meshes`, `ISOCHORE_STATUS_MESH` if the result cannot be measured, and
/// `ISOCHORE_STATUS_CANCELLED` if `progress` returned false.
///
/// Preconditions: `recipe` is a string. `meshes` has `mesh_count` entries. `mesh` is writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_run(
    recipe: *const c_char,
    meshes: *const NamedMesh,
    mesh_count: usize,
    progress: Progress,
    context: *mut c_void,
    mesh: *mut *mut Mesh,
    report: *mut *mut c_char,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (recipe_text, named_meshes) = unsafe { (text("recipe", recipe)?, array("meshes", meshes, mesh_count)?) };
        if mesh.is_null() {
            return Err(Failure::argument("mesh is NULL"));
        }
        let mut recipe = Recipe::parse(recipe_text, Format::of_text(recipe_text), &[])?;
        // SAFETY: the caller guarantees it.
        let meshes = load(&mut recipe, TargetMesh::Required, unsafe { named(named_meshes) }?)?;
        let loaded = LoadedRecipe { recipe, text: recipe_text, meshes };
        // SAFETY: the caller guarantees it.
        unsafe { loaded.run(&Watcher::new(progress, context), mesh, report) }
    })
}

/// Deforms the target of the recipe in the file at `path`: JSON if its extension is `json`, TOML
/// otherwise. Reads the meshes, the CSV files of spines and the CSV file of mask weights that the
/// recipe names; their names are relative to the folder of the recipe. Writes no file, so the
/// `output` of the recipe has no effect.
///
/// Stores the deformed mesh in `mesh`. If `report` is not NULL, stores the report as a JSON string;
/// free it with `isochore_text_free`. `progress` may be NULL.
///
/// Returns `ISOCHORE_STATUS_FILE` if a file cannot be read, `ISOCHORE_STATUS_RECIPE` if the recipe
/// or the contents of a file that it names are invalid, `ISOCHORE_STATUS_MESH` if the result cannot
/// be measured, and `ISOCHORE_STATUS_CANCELLED` if `progress` returned false. The message names the
/// file at fault and the key that names it.
///
/// Preconditions: `path` is a string. `mesh` is writable. `report` is NULL or writable. Free the
/// mesh with `isochore_mesh_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_run_file(
    path: *const c_char,
    progress: Progress,
    context: *mut c_void,
    mesh: *mut *mut Mesh,
    report: *mut *mut c_char,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let path = Path::new(unsafe { text("path", path) }?);
        if mesh.is_null() {
            return Err(Failure::argument("mesh is NULL"));
        }
        let text = read_text(path).map_err(|failure| failure.in_file(path))?;
        let recipe = Recipe::parse(&text, Format::of_path(path), &[]);
        let mut recipe = recipe.map_err(|error| Failure::from(error).in_file(path))?;
        let resolve = |name: &str| Some(NamedFile::Path(files::beside(path, name)));
        let source = Source { text: text.as_bytes(), overrides: &[] };
        let meshes =
            files::load(&mut recipe, TargetMesh::Required, &resolve).map_err(|error| error.in_recipe(path, source))?;
        let loaded = LoadedRecipe { recipe, text: &text, meshes };
        // SAFETY: the caller guarantees it.
        unsafe { loaded.run(&Watcher::new(progress, context), mesh, report) }.map_err(|failure| failure.in_file(path))
    })
}

/// Reads a recipe.
fn read_text(path: &Path) -> Result<String, Failure> {
    let bytes = fs::read(path).map_err(|error| Failure::new(Status::File, format!("cannot read: {error}")))?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        Failure::new(Status::Recipe, format!("the recipe is not valid UTF-8 at byte {valid}"))
    })
}

/// A recipe whose files are loaded.
struct LoadedRecipe<'a> {
    recipe: Recipe,
    /// The recipe as given; the report identifies it.
    text: &'a str,
    meshes: Meshes,
}

impl LoadedRecipe<'_> {
    /// Deforms the target. Stores the deformed mesh and, unless `report` is NULL, the report.
    ///
    /// # Safety
    /// `mesh` is writable. `report` is NULL or writable.
    unsafe fn run(&self, watcher: &Watcher, mesh: *mut *mut Mesh, report: *mut *mut c_char) -> Result<(), Failure> {
        let replay = replay(&self.recipe, &self.meshes, watcher)?;
        if !report.is_null() {
            let source = Source { text: self.text.as_bytes(), overrides: &[] };
            let json = Report::new(&self.recipe, source, &replay, &replay.deformed.mesh, watcher)?;
            let json = serde_json::to_string(&json).map_err(Failure::argument)?;
            // SAFETY: the caller guarantees it.
            unsafe { hand_over_text("report", report, &json) }?;
        }
        // SAFETY: the caller guarantees it.
        unsafe { hand_over("mesh", mesh, Mesh { mesh: replay.deformed.mesh.into() }) }
    }
}

/// Advects points along the strokes of a recipe, in place. `points` holds x, y, z of each point in
/// world coordinates, model units. Points have neither a surface nor a volume, so refinement and
/// the volume lock do not apply, and a recipe with a stamp is rejected. The target mesh may be
/// missing unless a mask has weights for its vertices.
///
/// If `warnings` is not NULL, stores a JSON array of strings that name the parts of the recipe that
/// do not apply to points; free it with `isochore_text_free`. `progress` may be NULL.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if a coordinate is not finite, `ISOCHORE_STATUS_RECIPE` if
/// the recipe is invalid, and `ISOCHORE_STATUS_CANCELLED` if `progress` returned false. On failure
/// the points keep their values.
///
/// Preconditions: `recipe` is a string. `meshes` has `mesh_count` entries. `points` has 3 ×
/// `point_count` writable values. `warnings` is NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_run_points(
    recipe: *const c_char,
    meshes: *const NamedMesh,
    mesh_count: usize,
    progress: Progress,
    context: *mut c_void,
    points: *mut f64,
    point_count: usize,
    warnings: *mut *mut c_char,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (recipe_text, named_meshes) = unsafe { (text("recipe", recipe)?, array("meshes", meshes, mesh_count)?) };
        // SAFETY: the caller guarantees it.
        let at: Vec<DVec3> = unsafe { finite_values("points", points, 3, point_count, f64::is_finite) }?;
        let mut recipe = Recipe::parse(recipe_text, Format::of_text(recipe_text), &[])?;
        // SAFETY: the caller guarantees it.
        let meshes = load(&mut recipe, TargetMesh::Optional, unsafe { named(named_meshes) }?)?;
        let advected = replay_points(&recipe, &meshes, &at, &Watcher::new(progress, context))?;
        if !warnings.is_null() {
            let json = serde_json::to_string(&advected.warnings).map_err(Failure::argument)?;
            // SAFETY: the caller guarantees it.
            unsafe { hand_over_text("warnings", warnings, &json) }?;
        }
        // SAFETY: the caller guarantees it.
        unsafe { copy_into("points", points, cast_slice(&advected.points)) }
    })
}

/// Collects the meshes that the caller passed.
///
/// # Safety
/// Names are strings, meshes are handles.
pub(crate) unsafe fn named(given: &[NamedMesh]) -> Result<Meshes, Failure> {
    let one = |named: &NamedMesh| {
        // SAFETY: the caller guarantees it.
        let (name, mesh) = unsafe { (text("meshes.name", named.name)?, reference("meshes.mesh", named.mesh)?) };
        Ok((name.to_owned(), Arc::clone(&mesh.mesh)))
    };
    given.iter().map(one).collect()
}

/// Takes the meshes that the recipe names from `given`.
fn load(recipe: &mut Recipe, target: TargetMesh, given: Meshes) -> Result<Meshes, LoadError> {
    files::load(recipe, target, &|name| given.get(name).map(|mesh| NamedFile::Mesh(Arc::clone(mesh))))
}
