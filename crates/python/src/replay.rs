//! Replay of recipes on meshes and points.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use isochore_mesh::Monitor;
use isochore_sculpt::{
    Meshes, Recipe, Report, Source,
    files::{self, NamedFile, TargetMesh},
    recipe::{Format, Override},
};
use numpy::PyArray2;
use pyo3::{prelude::*, types::PyDict};

use crate::{
    arrays::{contiguous, finite_numbers, points, points_to_array},
    error::Failure,
    mesh::{Mesh, mesh_of},
    watch::watched,
};

/// A parsed recipe.
#[pyclass(frozen, module = "isochore")]
#[derive(Debug)]
pub(crate) struct LoadedRecipe {
    recipe: Recipe,
    text: String,
    settings: Vec<String>,
}

#[pymethods]
impl LoadedRecipe {
    /// Parses a recipe, as JSON if `is_json` and as TOML otherwise. `settings` of the form
    /// KEY=VALUE override its keys.
    #[new]
    fn new(text: String, is_json: bool, settings: Vec<String>) -> Result<Self, Failure> {
        let overrides: Vec<Override> =
            settings.iter().map(|setting| Override::parse(setting)).collect::<Result<_, _>>()?;
        let format = if is_json { Format::Json } else { Format::Toml };
        let recipe = Recipe::parse(&text, format, &overrides)?;
        Ok(Self { recipe, text, settings })
    }

    /// Names of the files that the recipe uses.
    #[getter]
    fn file_names(&self) -> Vec<&str> {
        self.recipe.file_names()
    }

    /// Deforms the target. Returns the mesh, the same triangles before deformation, and the report
    /// as JSON.
    fn replay(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        meshes: &Bound<'_, PyDict>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Result<(Mesh, Mesh, String), Failure> {
        let given = meshes_of(meshes)?;
        watched(py, progress, |monitor| {
            let (recipe, meshes) = self.load(&folder, &given)?;
            let replay = isochore_sculpt::replay(&recipe, &meshes, monitor)?;
            let source = Source { text: self.text.as_bytes(), overrides: &self.settings };
            let report = Report::new(&recipe, source, &replay, &replay.deformed.mesh, monitor)?;
            let report = serde_json::to_string(&report).expect("all keys of a report are strings");
            Ok((Mesh { mesh: replay.deformed.mesh.into() }, Mesh { mesh: replay.deformed.rest.into() }, report))
        })
    }

    /// Advects points of shape (N, 3) along the strokes. Returns the points and warnings.
    fn replay_points<'py>(
        &self,
        py: Python<'py>,
        array: &Bound<'py, PyAny>,
        folder: PathBuf,
        meshes: &Bound<'_, PyDict>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Result<(Bound<'py, PyArray2<f64>>, Vec<String>), Failure> {
        let given = meshes_of(meshes)?;
        let array = contiguous::<f64>(array)?;
        let points = points("points", &array)?;
        finite_numbers("points", &array)?;
        let work = |monitor: &dyn Monitor| {
            let (recipe, meshes) = self.load(&folder, &given)?;
            Ok(isochore_sculpt::replay_points(&recipe, &meshes, points, monitor)?)
        };
        let replay = watched(py, progress, work)?;
        Ok((points_to_array(py, replay.points)?, replay.warnings))
    }
}

impl LoadedRecipe {
    /// Loads the files that the recipe names, relative to `folder`. Meshes of the caller replace
    /// files of the same name.
    fn load(&self, folder: &Path, given: &Meshes) -> Result<(Recipe, Meshes), Failure> {
        let mut recipe = self.recipe.clone();
        let resolve = |name: &str| {
            Some(match given.get(name) {
                Some(mesh) => NamedFile::Mesh(Arc::clone(mesh)),
                None => NamedFile::Path(folder.join(name)),
            })
        };
        let meshes = files::load(&mut recipe, TargetMesh::Required, &resolve)?;
        Ok((recipe, meshes))
    }
}

fn meshes_of(meshes: &Bound<'_, PyDict>) -> Result<Meshes, Failure> {
    meshes.iter().map(|(name, mesh)| Ok((name.extract()?, mesh_of(&mesh)?))).collect()
}
