//! Recipes carried out.

use std::sync::Arc;

use bytemuck::cast_slice_mut;
use glam::DVec3;
use isochore_mesh::NoProgress;
use isochore_sculpt::{Meshes, Recipe as RecipeData, Report, Source, recipe::Format, replay, replay_points};
use wasm_bindgen::prelude::*;

use crate::{error::thrown, mesh::Mesh};

/// A recipe and the meshes that it names.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Recipe {
    text: String,
    recipe: RecipeData,
    meshes: Meshes,
}

/// What became of a recipe's target.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Replay {
    mesh: Mesh,
    report: String,
}

#[wasm_bindgen]
impl Recipe {
    /// Reads a recipe: JSON where it begins with a brace, TOML otherwise.
    #[wasm_bindgen(constructor)]
    pub fn new(text: String) -> Result<Recipe, JsError> {
        let recipe = RecipeData::parse(&text, Format::of_text(&text), &[]).map_err(thrown)?;
        Ok(Self { text, recipe, meshes: Meshes::new() })
    }

    /// Names of the meshes that it needs.
    #[wasm_bindgen(getter, js_name = meshNames)]
    pub fn mesh_names(&self) -> Vec<String> {
        self.recipe.mesh_names().into_iter().map(str::to_owned).collect()
    }

    /// Gives it a mesh that it names.
    #[wasm_bindgen(js_name = setMesh)]
    pub fn set_mesh(&mut self, name: String, mesh: &Mesh) {
        self.meshes.insert(name, Arc::clone(&mesh.mesh));
    }

    /// Deforms the target.
    pub fn run(&self) -> Result<Replay, JsError> {
        let replay = replay(&self.recipe, &self.meshes, &NoProgress).map_err(thrown)?;
        let source = Source { text: self.text.as_bytes(), overrides: &[] };
        let report = Report::new(&self.recipe, source, &replay, &replay.deformed.mesh, &NoProgress).map_err(thrown)?;
        let report = serde_json::to_string(&report).map_err(thrown)?;
        Ok(Replay { mesh: Mesh { mesh: replay.deformed.mesh.into() }, report })
    }

    /// Carries points along the strokes, in place: x, y, z of each, in world coordinates, model units. Points have no surface and no
    /// volume: there is no refinement and no lock, and stamps are refused. The target need not be given, unless a mask has weights for
    /// its vertices. Returns what of the recipe does not apply to points.
    #[wasm_bindgen(js_name = runPoints)]
    pub fn run_points(&self, points: &mut [f64]) -> Result<Vec<String>, JsError> {
        if let Some(bad) = points.iter().position(|number| !number.is_finite()) {
            return Err(thrown(format!("points: number {} of point {} is not finite", bad % 3, bad / 3)));
        }
        let (rows, []) = points.as_chunks_mut::<3>() else { return Err(thrown("points have three numbers each")) };
        let rows: &mut [DVec3] = cast_slice_mut(rows);
        let carried = replay_points(&self.recipe, &self.meshes, rows, &NoProgress).map_err(thrown)?;
        rows.copy_from_slice(&carried.points);
        Ok(carried.warnings)
    }
}

#[wasm_bindgen]
impl Replay {
    /// The report as JSON.
    #[wasm_bindgen(getter)]
    pub fn report(&self) -> String {
        self.report.clone()
    }

    /// The deformed mesh, which is taken out.
    #[wasm_bindgen(js_name = intoMesh)]
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }
}
