//! Reports of replays, written as JSON.

use std::collections::BTreeMap;

use isochore_field::{JacobianRange, Receipt};
use isochore_mesh::{ClosedMesh, Monitor, SelfIntersectionError, SelfIntersections, TriMesh};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use web_time::Instant;

use crate::{
    recipe::{Promise, Recipe},
    replay::Replay,
};

/// Measurements of a replay, and whether the promises hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// Target in world coordinates.
    pub before: Measures,
    /// Written mesh, with the rounding of its format.
    pub after: Measures,
    /// Signed relative change of the volume, measured on the written mesh; null for an open target.
    pub volume_change: Option<f64>,
    /// Signed relative change of the volume before the volume lock, measured on the mesh in memory;
    /// null for an open target.
    pub volume_change_before_lock: Option<f64>,
    /// Largest displacement of a vertex by the volume lock, model units; null without a lock.
    pub lock_max_shift: Option<f64>,
    /// Largest ratio of a displacement by the volume lock to the shortest edge at the vertex; null
    /// without a lock.
    pub lock_max_shift_per_edge: Option<f64>,
    /// Largest displacement of a vertex, model units.
    pub max_displacement: f64,
    /// Vertices that the strokes moved, including inserted ones.
    pub moved_vertices: usize,
    /// Vertices that refinement inserted.
    pub inserted_vertices: usize,
    /// How often the result so far became the surface from which the next strokes started.
    pub rebases: usize,
    /// Sum over the rebases of the largest distance by which each moved the surface, model units.
    pub rebase_deviation: f64,
    /// Triangles that cross others although the target's triangles do not.
    pub certificate: Certificate,
    /// Promises of the recipe by name, and whether they hold.
    pub promises: BTreeMap<String, bool>,
    /// Strokes in order.
    pub strokes: Vec<StrokeReport>,
    /// Wall-clock time of each stage.
    pub seconds: Seconds,
    /// Version of the program.
    pub version: String,
    /// SHA-256 of the recipe's file, in hexadecimal digits.
    pub recipe_sha256: String,
    /// Settings that replaced values of the recipe, `KEY=VALUE`.
    pub overrides: Vec<String>,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Measurements of a mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Measures {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Whether every edge has two triangles with consistent orientation.
    pub closed: bool,
    /// Enclosed volume, cubic model units; null for an open mesh.
    pub volume: Option<f64>,
    /// Surface area, square model units.
    pub area: f64,
    /// Bounding box, model units.
    pub bounds: Bounds,
    /// Number of triangles that intersect another one.
    pub self_intersecting_triangles: usize,
    /// Total area of the self-intersecting triangles, square model units.
    pub self_intersecting_area: f64,
    /// Fraction of the triangles whose smallest angle is below 5 degrees.
    pub angle_below_5_degrees: f64,
}

/// Search for triangles that cross although the target's triangles that contain them do not.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Certificate {
    /// Number of such triangles in the mesh in memory.
    pub new_crossings: usize,
    /// Pairs of triangles with overlapping boxes that were tested.
    pub pairs_tested: u64,
    /// Number of such triangles in the written mesh, with the rounding of its format.
    pub after_rounding: usize,
}

/// Closest sheets where a stroke ended, because they would have crossed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SheetsReport {
    /// Distance between the sheets, model units.
    pub gap: f64,
    /// Point midway between them, model units.
    pub at: [f64; 3],
}

/// Bounding box, model units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Bounds {
    /// Minimum x, y and z.
    pub min: [f64; 3],
    /// Maximum x, y and z.
    pub max: [f64; 3],
}

/// Measurements of one stroke.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StrokeReport {
    /// Kind of the stroke, as in the recipe.
    pub kind: String,
    /// Wall-clock time, seconds.
    pub seconds: f64,
    /// Number of evaluations of the field.
    pub evaluations: u64,
    /// Number of vertices that the stroke moved.
    pub moved: usize,
    /// Number of vertices that refinement inserted for the stroke.
    pub inserted: usize,
    /// Smallest Jacobian determinant of the flow map, sampled at moved vertices; 1 for a map that
    /// preserves volume. Null if the stroke moved no vertex or is a stamp.
    pub jacobian_min: Option<f64>,
    /// Largest Jacobian determinant of the flow map, sampled as for `jacobian_min`.
    pub jacobian_max: Option<f64>,
    /// Signed relative change of the volume by the stroke; null for an open target.
    pub volume_change: Option<f64>,
    /// Fraction of the stroke's path, from 0 to 1, at which it ended because the surface would have
    /// crossed itself; absent for a complete stroke.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stopped_at: Option<f64>,
    /// Sheets that would have crossed; absent for a complete stroke.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sheets: Option<SheetsReport>,
}

/// Wall-clock time of each stage, seconds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Seconds {
    /// Reading the recipe and its meshes.
    pub read: f64,
    /// Sampling the distance grids of tool meshes.
    pub distance: f64,
    /// Advecting vertices along the strokes.
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
    /// ```
    /// use isochore_mesh::{NoProgress, primitives};
    /// use isochore_sculpt::Measures;
    ///
    /// let measures = Measures::of(&primitives::icosphere(1.0, 3), &NoProgress)?;
    /// assert!(measures.closed && measures.self_intersecting_triangles == 0);
    /// # Ok::<(), isochore_mesh::SelfIntersectionError>(())
    /// ```
    ///
    /// # Errors
    /// [`SelfIntersectionError`], if the mesh cannot be searched or the monitor asks to stop.
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
            angle_below_5_degrees: fraction_of_slivers(mesh),
        })
    }
}

/// Text of a recipe, with the settings that override it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source<'a> {
    /// Contents of the recipe's file.
    pub text: &'a [u8],
    /// Settings that replaced its values, `KEY=VALUE`.
    pub overrides: &'a [String],
}

impl Report {
    /// Reports on `replay`. `written` is its mesh as stored in the file, with the rounding of the
    /// format.
    ///
    /// The caller fills in the seconds for reading and writing.
    ///
    /// # Errors
    /// [`SelfIntersectionError`], if the mesh cannot be searched or the monitor asks to stop.
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
            stopped_at: receipt.stopped_at,
            sheets: receipt.sheets.map(|sheets| SheetsReport { gap: sheets.gap, at: sheets.at.to_array() }),
        });
        let certificate = Certificate {
            new_crossings: receipt.new_crossings,
            pairs_tested: receipt.pairs_tested,
            after_rounding: crossings_after_rounding(replay, written, &after, monitor)?,
        };
        let notes = receipt.notes.iter().map(ToString::to_string);
        Ok(Self {
            volume_change,
            volume_change_before_lock: relative_change(receipt.volume_before, receipt.volume_before_lock),
            lock_max_shift: receipt.lock_max_shift,
            lock_max_shift_per_edge: receipt.lock_max_shift_per_edge,
            max_displacement: receipt.max_displacement,
            moved_vertices: receipt.moved_vertices,
            inserted_vertices: receipt.inserted_vertices,
            rebases: receipt.rebases,
            rebase_deviation: receipt.rebase_deviation,
            promises: check_promises(&recipe.promise, volume_change, &certificate, receipt),
            certificate,
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

    /// Names of the promises that do not hold.
    pub fn missed_promises(&self) -> impl Iterator<Item = &str> {
        self.promises.iter().filter(|(_, holds)| !**holds).map(|(name, _)| name.as_str())
    }
}

/// SHA-256 in hexadecimal digits.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Relative change from one volume to another, or `None` if one is missing or the first is zero.
fn relative_change(before: Option<f64>, after: Option<f64>) -> Option<f64> {
    let (before, after) = (before?, after?);
    (before != 0.0).then(|| (after - before) / before.abs())
}

/// The promises that the recipe asks for, by their keys, and whether they hold.
fn check_promises(
    promise: &Promise,
    volume_change: Option<f64>,
    certificate: &Certificate,
    receipt: &Receipt,
) -> BTreeMap<String, bool> {
    let strokes = &receipt.strokes;
    let is_positive = |range: JacobianRange| range.min > 0.0;
    let shift = receipt.lock_max_shift_per_edge.unwrap_or(0.0);
    let asked = [
        // An open mesh has no volume, so it breaks the promise.
        ("volume", promise.volume.map(|limit| volume_change.is_some_and(|change| change.abs() <= limit))),
        ("no_new_self_intersections", promise.no_new_self_intersections.then_some(certificate.after_rounding == 0)),
        (
            "positive_jacobian",
            promise.positive_jacobian.then(|| strokes.iter().filter_map(|stroke| stroke.jacobian).all(is_positive)),
        ),
        ("lock_within_half_edge", promise.lock_within_half_edge.then_some(shift <= 0.5)),
        (
            "strokes_completed",
            promise.strokes_completed.then(|| strokes.iter().all(|stroke| stroke.stopped_at.is_none())),
        ),
    ];
    asked.into_iter().filter_map(|(name, holds)| Some((name.to_owned(), holds?))).collect()
}

/// New crossings of the written mesh. Those that rounding adds are counted by the triangles that
/// intersect others, because a file does not store which target triangle contains a triangle.
fn crossings_after_rounding(
    replay: &Replay,
    written: &TriMesh,
    after: &Measures,
    monitor: &dyn Monitor,
) -> Result<usize, SelfIntersectionError> {
    let deformed = &replay.deformed;
    let new_crossings = deformed.receipt.new_crossings;
    if after.self_intersecting_triangles == 0 || written.positions == deformed.mesh.positions {
        return Ok(new_crossings);
    }
    let exact = SelfIntersections::of(&deformed.mesh, monitor)?.triangles().len();
    Ok((new_crossings + after.self_intersecting_triangles).saturating_sub(exact))
}

/// Fraction of the triangles whose smallest angle is below five degrees.
fn fraction_of_slivers(mesh: &TriMesh) -> f64 {
    // The smallest angle is opposite to the shortest side; its sine is twice the area over the
    // product of the other two sides.
    let limit = libm::sin(5_f64.to_radians());
    let is_sliver = |index: &usize| {
        let [a, b, c] = mesh.corners(*index);
        let mut sides = [a.distance(b), b.distance(c), c.distance(a)];
        sides.sort_unstable_by(f64::total_cmp);
        let sine = (b - a).cross(c - a).length() / (sides[1] * sides[2]);
        // A triangle without area has an angle of zero.
        sine.is_nan() || sine < limit
    };
    let count = (0..mesh.triangles.len()).into_par_iter().filter(is_sliver).count();
    count as f64 / mesh.triangles.len().max(1) as f64
}
