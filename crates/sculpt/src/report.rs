//! The account of a run, as JSON.

use std::collections::BTreeMap;

use isochore_mesh::{ClosedMesh, Monitor, SelfIntersectionError, SelfIntersections, TriMesh};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use web_time::Instant;

use crate::{
    recipe::{Promise, Recipe},
    replay::Replay,
};

/// Name of the promise on the change of the volume.
const VOLUME: &str = "volume";
/// Name of the promise on self-intersections.
const NO_NEW_SELF_INTERSECTIONS: &str = "no_new_self_intersections";

/// What a run did to its target, and what became of the promises.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// The target, placed in the world.
    pub before: Measures,
    /// The written mesh, rounded as its format rounds.
    pub after: Measures,
    /// Signed relative change of the volume on the written mesh; null for an open target.
    pub volume_change: Option<f64>,
    /// The same before the volume lock, on the mesh in memory; null for an open target.
    pub volume_change_before_lock: Option<f64>,
    /// Farthest that the lock moved a vertex, model units; null where there was no lock.
    pub lock_max_shift: Option<f64>,
    /// Farthest that a vertex moved, model units.
    pub max_displacement: f64,
    /// Vertices, inserted ones included, that the strokes moved at all.
    pub moved_vertices: usize,
    /// Vertices that refinement added.
    pub inserted_vertices: usize,
    /// The promises of the recipe, and whether they were kept.
    pub promises: BTreeMap<String, bool>,
    /// The strokes, in order.
    pub strokes: Vec<StrokeReport>,
    /// Wall-clock time of the stages.
    pub seconds: Seconds,
    /// Version of the program.
    pub version: String,
    /// SHA-256 of the recipe's file as it was read, in hexadecimal digits.
    pub recipe_sha256: String,
    /// Settings that won over the recipe, `KEY=VALUE`.
    pub overrides: Vec<String>,
    /// What the user should know beyond the numbers.
    pub warnings: Vec<String>,
}

/// Facts about a mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Measures {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// True where every edge lies between two triangles that agree on which side is outside.
    pub closed: bool,
    /// Enclosed volume, cubic model units; null for an open mesh.
    pub volume: Option<f64>,
    /// Area, square model units.
    pub area: f64,
    /// Bounding box, model units.
    pub bounds: Bounds,
    /// Triangles that intersect another one.
    pub self_intersecting_triangles: usize,
    /// Sum of their areas, square model units.
    pub self_intersecting_area: f64,
}

/// A bounding box, model units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Bounds {
    /// Smallest x, y and z.
    pub min: [f64; 3],
    /// Largest x, y and z.
    pub max: [f64; 3],
}

/// What one stroke did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StrokeReport {
    /// Kind, as in the recipe.
    pub kind: String,
    /// Wall-clock time.
    pub seconds: f64,
    /// Evaluations of the field.
    pub evaluations: u64,
    /// Vertices that it moved.
    pub moved: usize,
    /// Vertices that refinement added for it.
    pub inserted: usize,
    /// Least Jacobian determinant of its flow map at some of the vertices that it moved; one where volumes are kept. Null where
    /// it moved none, or is a stamp.
    pub jacobian_min: Option<f64>,
    /// The largest such determinant.
    pub jacobian_max: Option<f64>,
    /// Signed relative change of the volume by it; null for an open target.
    pub volume_change: Option<f64>,
}

/// Wall-clock seconds by stage.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Seconds {
    /// Reading the recipe and its meshes.
    pub read: f64,
    /// Distance grids of tool meshes.
    pub distance: f64,
    /// Moving vertices along the strokes.
    pub advect: f64,
    /// Splitting triangles.
    pub refine: f64,
    /// Correcting the volume.
    pub lock: f64,
    /// Measuring the meshes for this report.
    pub check: f64,
    /// Writing the meshes and pictures.
    pub write: f64,
}

impl Measures {
    /// Measures `mesh`.
    ///
    /// # Errors
    /// [`SelfIntersectionError`], when the mesh cannot be searched or the monitor asks to stop.
    pub fn of(mesh: &TriMesh, monitor: &dyn Monitor) -> Result<Self, SelfIntersectionError> {
        let closed = ClosedMesh::new(mesh).ok();
        let bounds = mesh.bounds();
        let crossings = SelfIntersections::of(mesh, monitor)?;
        Ok(Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            closed: closed.is_some(),
            volume: closed.map(|mesh| mesh.volume()),
            area: mesh.area(),
            bounds: Bounds { min: bounds.min.to_array(), max: bounds.max.to_array() },
            self_intersecting_triangles: crossings.triangles().len(),
            self_intersecting_area: crossings.area(mesh),
        })
    }
}

/// Where a report's recipe came from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source<'a> {
    /// Contents of the recipe's file.
    pub text: &'a [u8],
    /// Settings that won over it, `KEY=VALUE`.
    pub overrides: &'a [String],
}

impl Report {
    /// The account of `replay`, whose mesh stands in its file as `written`.
    ///
    /// The seconds for reading and writing are for the caller to fill in.
    ///
    /// # Errors
    /// [`SelfIntersectionError`], when the mesh cannot be searched or the monitor asks to stop.
    pub fn new(
        recipe: &Recipe,
        source: Source<'_>,
        replay: &Replay,
        written: &TriMesh,
        monitor: &dyn Monitor,
    ) -> Result<Self, SelfIntersectionError> {
        let start = Instant::now();
        let before = Measures::of(&replay.scene.target, monitor)?;
        let after = Measures::of(written, monitor)?;
        let receipt = &replay.deformed.receipt;
        let stages = receipt.seconds;
        let volume_change = relative_change(before.volume, after.volume);
        let strokes = recipe.strokes.iter().zip(&receipt.strokes).map(|(stroke, receipt)| StrokeReport {
            kind: stroke.kind().to_owned(),
            seconds: receipt.seconds,
            evaluations: receipt.evaluations,
            moved: receipt.moved,
            inserted: receipt.inserted,
            jacobian_min: receipt.jacobian.map(|range| range.min),
            jacobian_max: receipt.jacobian.map(|range| range.max),
            volume_change: receipt.volume_change,
        });
        let notes = receipt.notes.iter().map(ToString::to_string);
        Ok(Self {
            volume_change,
            volume_change_before_lock: relative_change(receipt.volume_before, receipt.volume_before_lock),
            lock_max_shift: receipt.lock_max_shift,
            max_displacement: receipt.max_displacement,
            moved_vertices: receipt.moved_vertices,
            inserted_vertices: receipt.inserted_vertices,
            promises: judge(&recipe.promise, volume_change, &before, &after),
            strokes: strokes.collect(),
            seconds: Seconds {
                distance: replay.scene.distance_seconds,
                advect: stages.advect,
                refine: stages.refine,
                lock: stages.lock,
                check: start.elapsed().as_secs_f64(),
                ..Seconds::default()
            },
            version: env!("CARGO_PKG_VERSION").to_owned(),
            recipe_sha256: sha256(source.text),
            overrides: source.overrides.to_vec(),
            warnings: replay.scene.warnings.iter().cloned().chain(notes).collect(),
            before,
            after,
        })
    }

    /// The promises that were not kept.
    pub fn missed_promises(&self) -> impl Iterator<Item = &str> {
        self.promises.iter().filter(|(_, is_kept)| !**is_kept).map(|(name, _)| name.as_str())
    }
}

/// SHA-256 in hexadecimal digits.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The relative change from one volume to another; none where there is nothing to compare with.
fn relative_change(before: Option<f64>, after: Option<f64>) -> Option<f64> {
    let (before, after) = (before?, after?);
    (before != 0.0).then(|| (after - before) / before.abs())
}

fn judge(promise: &Promise, volume_change: Option<f64>, before: &Measures, after: &Measures) -> BTreeMap<String, bool> {
    let volume = promise.volume.map(|most| {
        // A mesh that lost its volume on the way has not kept it.
        (VOLUME.to_owned(), volume_change.is_some_and(|change| change.abs() <= most))
    });
    let intersections = promise.no_new_self_intersections.then(|| {
        let is_kept = after.self_intersecting_triangles <= before.self_intersecting_triangles;
        (NO_NEW_SELF_INTERSECTIONS.to_owned(), is_kept)
    });
    volume.into_iter().chain(intersections).collect()
}
