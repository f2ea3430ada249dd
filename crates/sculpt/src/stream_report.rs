//! The account of points that were deformed chunk by chunk, as JSON.

use glam::DVec3;
use isochore_mesh::Aabb;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{Bounds, Recipe, Source, report::sha256};

/// What a stream did to its points. A surface it does not know, and so tells of no volume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StreamReport {
    /// Points read and written.
    pub points: u64,
    /// Box of the points placed in the world, model units; null where there are none.
    pub bounds_before: Option<Bounds>,
    /// Box of the points as carried, model units.
    pub bounds_after: Option<Bounds>,
    /// Points that the strokes moved at all.
    pub moved_points: u64,
    /// Farthest that a point moved, model units.
    pub max_displacement: f64,
    /// Kinds of the strokes, in order.
    pub strokes: Vec<String>,
    /// Wall-clock time of the stages.
    pub seconds: StreamSeconds,
    /// Version of the program.
    pub version: String,
    /// SHA-256 of the recipe's file as it was read, in hexadecimal digits.
    pub recipe_sha256: String,
    /// Settings that won over the recipe, `KEY=VALUE`.
    pub overrides: Vec<String>,
    /// What the user should know beyond the numbers.
    pub warnings: Vec<String>,
}

/// Wall-clock seconds by stage.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StreamSeconds {
    /// Reading the recipe, the meshes of tools, and the distance grids of those.
    pub prepare: f64,
    /// Reading points, the pass for their bounds included where one is needed.
    pub read: f64,
    /// Moving points along the strokes.
    pub advect: f64,
    /// Writing points.
    pub write: f64,
}

impl StreamReport {
    /// The account of a stream that has not begun yet.
    pub fn new(recipe: &Recipe, source: Source<'_>, warnings: Vec<String>) -> Self {
        Self {
            points: 0,
            bounds_before: None,
            bounds_after: None,
            moved_points: 0,
            max_displacement: 0.0,
            strokes: recipe.strokes.iter().map(|stroke| stroke.kind().to_owned()).collect(),
            seconds: StreamSeconds::default(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            recipe_sha256: sha256(source.text),
            overrides: source.overrides.to_vec(),
            warnings,
        }
    }

    /// Adds a chunk of points, placed in the world and carried.
    pub fn add(&mut self, before: &[DVec3], after: &[DVec3]) {
        let bits = |point: &DVec3| point.to_array().map(f64::to_bits);
        self.points += before.len() as u64;
        for (before, after) in before.iter().zip(after).filter(|(before, after)| bits(before) != bits(after)) {
            self.moved_points += 1;
            self.max_displacement = self.max_displacement.max(before.distance(*after));
        }
        grow(&mut self.bounds_before, before);
        grow(&mut self.bounds_after, after);
    }
}

fn grow(bounds: &mut Option<Bounds>, points: &[DVec3]) {
    let known = bounds.as_ref().map_or(Aabb::EMPTY, |bounds| Aabb { min: bounds.min.into(), max: bounds.max.into() });
    if !points.is_empty() {
        let Aabb { min, max } = known.union(Aabb::of(points.iter().copied()));
        *bounds = Some(Bounds { min: min.to_array(), max: max.to_array() });
    }
}
