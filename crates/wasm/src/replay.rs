//! Replay of recipes on meshes and points.

use std::{collections::BTreeMap, sync::Arc};

use bytemuck::cast_slice_mut;
use glam::DVec3;
use isochore_mesh::NoProgress;
use isochore_sculpt::{
    Meshes, Recipe as RecipeData, Report, Source,
    files::{self, NamedFile, TargetMesh},
    recipe::Format,
    replay, replay_points,
};
use wasm_bindgen::prelude::*;

use crate::{error::thrown, mesh::Mesh};

/// A recipe and the files that it names.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Recipe {
    text: String,
    recipe: RecipeData,
    meshes: Meshes,
    files: BTreeMap<String, Vec<u8>>,
}

/// Result of a recipe.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Replay {
    mesh: Mesh,
    report: String,
}

#[wasm_bindgen]
impl Recipe {
    /// Parses a recipe, as JSON if it begins with a brace and as TOML otherwise. Throws if it is
    /// invalid.
    #[wasm_bindgen(constructor)]
    pub fn new(text: String) -> Result<Recipe, JsError> {
        let recipe = RecipeData::parse(&text, Format::of_text(&text), &[]).map_err(thrown)?;
        Ok(Self { text, recipe, meshes: Meshes::new(), files: BTreeMap::new() })
    }

    /// Names of the meshes that the recipe needs.
    #[wasm_bindgen(getter, js_name = meshNames)]
    pub fn mesh_names(&self) -> Vec<String> {
        self.recipe.mesh_names().into_iter().map(str::to_owned).collect()
    }

    /// Provides a mesh that the recipe names.
    #[wasm_bindgen(js_name = setMesh)]
    pub fn set_mesh(&mut self, name: String, mesh: &Mesh) {
        self.meshes.insert(name, Arc::clone(&mesh.mesh));
    }

    /// Names of all files that the recipe needs: meshes, curves and weights.
    #[wasm_bindgen(getter, js_name = fileNames)]
    pub fn file_names(&self) -> Vec<String> {
        self.recipe.file_names().into_iter().map(str::to_owned).collect()
    }

    /// Provides the bytes of a file that the recipe names: a mesh, whose format follows from the
    /// extension of the name, or a CSV file of a curve or of weights.
    #[wasm_bindgen(js_name = setFile)]
    pub fn set_file(&mut self, name: String, bytes: Vec<u8>) {
        self.files.insert(name, bytes);
    }

    /// Deforms the target. Throws if a mesh is missing or cannot be used.
    pub fn run(&self) -> Result<Replay, JsError> {
        let (recipe, meshes) = self.load(TargetMesh::Required)?;
        let replay = replay(&recipe, &meshes, &NoProgress).map_err(thrown)?;
        let source = Source { text: self.text.as_bytes(), overrides: &[] };
        let report = Report::new(&recipe, source, &replay, &replay.deformed.mesh, &NoProgress).map_err(thrown)?;
        let report = serde_json::to_string(&report).map_err(thrown)?;
        Ok(Replay { mesh: Mesh { mesh: replay.deformed.mesh.into() }, report })
    }

    /// Advects points along the strokes, in place: x, y, z of each point in world coordinates,
    /// model units. Returns warnings about parts of the recipe that do not apply to points.
    ///
    /// Points have neither a surface nor a volume, so refinement and the volume lock do not apply,
    /// and a recipe with a stamp throws. The target mesh is needed only if a mask has weights for
    /// its vertices.
    #[wasm_bindgen(js_name = runPoints)]
    pub fn run_points(&self, points: &mut [f64]) -> Result<Vec<String>, JsError> {
        if let Some(bad) = points.iter().position(|number| !number.is_finite()) {
            return Err(thrown(format!("points: number {} of point {} is not finite", bad % 3, bad / 3)));
        }
        let (rows, []) = points.as_chunks_mut::<3>() else {
            return Err(thrown("the length of points must be a multiple of 3: three numbers per point"));
        };
        let rows: &mut [DVec3] = cast_slice_mut(rows);
        let (recipe, meshes) = self.load(TargetMesh::Optional)?;
        let advected = replay_points(&recipe, &meshes, rows, &NoProgress).map_err(thrown)?;
        rows.copy_from_slice(&advected.points);
        Ok(advected.warnings)
    }
}

impl Recipe {
    fn load(&self, target: TargetMesh) -> Result<(RecipeData, Meshes), JsError> {
        let mut recipe = self.recipe.clone();
        let resolve = |name: &str| match self.meshes.get(name) {
            Some(mesh) => Some(NamedFile::Mesh(Arc::clone(mesh))),
            None => self.files.get(name).map(|bytes| NamedFile::Bytes(bytes)),
        };
        let meshes = files::load(&mut recipe, target, &resolve).map_err(thrown)?;
        Ok((recipe, meshes))
    }
}

#[wasm_bindgen]
impl Replay {
    /// The report as JSON.
    #[wasm_bindgen(getter)]
    pub fn report(&self) -> String {
        self.report.clone()
    }

    /// Returns the deformed mesh and frees this object.
    #[wasm_bindgen(js_name = intoMesh)]
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }
}
