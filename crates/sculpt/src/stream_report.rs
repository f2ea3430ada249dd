//! Reports of streams of points, written as JSON.

use glam::DVec3;
use isochore_mesh::Aabb;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{Bounds, Recipe, Source, report::sha256};

/// Measurements of a stream of points. Points have no surface and no volume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StreamReport {
    /// Number of points read and written.
    pub points: u64,
    /// Bounding box of the points in world coordinates before the strokes, model units; null
    /// without points.
    pub bounds_before: Option<Bounds>,
    /// Bounding box of the deformed points, model units; null without points.
    pub bounds_after: Option<Bounds>,
    /// Number of points that the strokes moved.
    pub moved_points: u64,
    /// Largest displacement of a point, model units.
    pub max_displacement: f64,
    /// Kinds of the strokes, in order.
    pub strokes: Vec<String>,
    /// Wall-clock time of each stage.
    pub seconds: StreamSeconds,
    /// Version of the program.
    pub version: String,
    /// SHA-256 of the recipe's file, in hexadecimal digits.
    pub recipe_sha256: String,
    /// Settings that replaced values of the recipe, `KEY=VALUE`.
    pub overrides: Vec<String>,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Wall-clock time of each stage, seconds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StreamSeconds {
    /// Reading the recipe and the meshes of tools, and sampling their distance grids.
    pub prepare: f64,
    /// Reading points, including the pass for their bounds if one is needed.
    pub read: f64,
    /// Advecting points along the strokes.
    pub advect: f64,
    /// Writing points.
    pub write: f64,
}

impl StreamReport {
    /// A report of a stream that has not started.
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

    /// Adds a chunk of points, in world coordinates before and after the strokes.
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
