//! Recipes carried out.

use std::{
    ffi::{c_char, c_void},
    sync::Arc,
};

use bytemuck::cast_slice;
use glam::DVec3;
use isochore_sculpt::{Meshes, Recipe, Report, Source, recipe::Format, replay, replay_points};

use crate::{
    error::{Failure, Status, guarded},
    memory::{array, fill, finite_values, hand_over, hand_over_text, reference, text},
    mesh::Mesh,
    monitor::{Progress, Watcher},
};

/// A mesh by the name that a recipe gives it.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct NamedMesh {
    /// Name in the recipe, as its keys `mesh` have it.
    pub name: *const c_char,
    /// The mesh.
    pub mesh: *const Mesh,
}

/// Deforms the target of a recipe, given as the text of a TOML document or, where it begins with a brace, a JSON one. Points of
/// spines and weights of masks stand in the recipe itself.
///
/// `report` may be NULL; otherwise it gets a report as JSON, to be given back with `isochore_text_free`. `progress` may be NULL.
///
/// # Safety
/// `recipe` is a text; `meshes` has `mesh_count` entries; `mesh` can be written to; `progress` may be called from any thread with
/// `context`.
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
        // SAFETY: as the caller promises.
        let (words, given) = unsafe { (text("recipe", recipe)?, array("meshes", meshes, mesh_count)?) };
        if mesh.is_null() {
            return Err(Failure::argument("mesh is NULL"));
        }
        let recipe = Recipe::parse(words, Format::of_text(words), &[])?;
        // SAFETY: as the caller promises.
        let meshes = unsafe { named(given) }?;
        let watcher = Watcher::new(progress, context);
        let replay = replay(&recipe, &meshes, &watcher)?;
        if !report.is_null() {
            let source = Source { text: words.as_bytes(), overrides: &[] };
            let account = Report::new(&recipe, source, &replay, &replay.deformed.mesh, &watcher)?;
            let account = serde_json::to_string(&account).map_err(Failure::argument)?;
            // SAFETY: as the caller promises.
            unsafe { hand_over_text("report", report, &account) }?;
        }
        // SAFETY: as the caller promises.
        unsafe { hand_over("mesh", mesh, Mesh { mesh: replay.deformed.mesh.into() }) }
    })
}

/// Carries points along the strokes of a recipe, in place: x, y, z of each, in world coordinates, model units. Points have no surface
/// and no volume: there is no refinement and no lock, and stamps are refused. The target's mesh need not be there, unless a mask has
/// weights for its vertices.
///
/// `warnings` may be NULL; otherwise it gets what of the recipe does not apply to points, as JSON, an array of texts, to be given back
/// with `isochore_text_free`. `progress` may be NULL.
///
/// # Safety
/// `recipe` is a text; `meshes` has `mesh_count` entries; `points` has 3 × `point_count` values, which can be written to; `progress` may
/// be called from any thread with `context`; `warnings` can be written to where it is not NULL.
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
        // SAFETY: as the caller promises.
        let (words, given) = unsafe { (text("recipe", recipe)?, array("meshes", meshes, mesh_count)?) };
        // SAFETY: as the caller promises.
        let at: Vec<DVec3> = unsafe { finite_values("points", points, 3, point_count, f64::is_finite) }?;
        let recipe = Recipe::parse(words, Format::of_text(words), &[])?;
        // SAFETY: as the caller promises.
        let meshes = unsafe { named(given) }?;
        let carried = replay_points(&recipe, &meshes, &at, &Watcher::new(progress, context))?;
        if !warnings.is_null() {
            let found = serde_json::to_string(&carried.warnings).map_err(Failure::argument)?;
            // SAFETY: as the caller promises.
            unsafe { hand_over_text("warnings", warnings, &found) }?;
        }
        // SAFETY: as the caller promises.
        unsafe { fill("points", points, cast_slice(&carried.points)) }
    })
}

/// The meshes that a caller names.
///
/// # Safety
/// Names are texts, meshes handles.
pub(crate) unsafe fn named(given: &[NamedMesh]) -> Result<Meshes, Failure> {
    let one = |named: &NamedMesh| {
        // SAFETY: as the caller promises.
        let (name, mesh) = unsafe { (text("meshes.name", named.name)?, reference("meshes.mesh", named.mesh)?) };
        Ok((name.to_owned(), Arc::clone(&mesh.mesh)))
    };
    given.iter().map(one).collect()
}
