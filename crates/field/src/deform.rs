//! The deformation of a mesh by strokes: advect, refine, stamp, lock.

use web_time::Instant;

use glam::DVec3;
use isochore_mesh::{Cancelled, ClosedMesh, MeshError, Monitor, Topology, TriMesh, signed_volume};

use crate::{
    JacobianRange, Note, Receipt, RefineOptions, Stamp, StampError, Stroke, StrokeReceipt,
    flow::bits,
    guard::{choose_step, prepare_lock, refine_to_volume},
    lock::Lock,
    press::{PressError, press},
    refine::{Criteria, Refinement, refine, resolve_field, untangle},
    tessellation::Tessellation,
};

/// How to deform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeformOptions {
    /// When to split triangles; none to keep them as they are.
    pub refine: Option<RefineOptions>,
    /// Whether the exact final correction gives back the volume at rest.
    pub lock: bool,
}

impl Default for DeformOptions {
    fn default() -> Self {
        Self { refine: Some(RefineOptions::default()), lock: true }
    }
}

/// A deformed mesh.
#[derive(Debug, Clone)]
pub struct Deformed {
    /// The mesh, refined and deformed.
    pub mesh: TriMesh,
    /// The same triangles at rest.
    pub rest: TriMesh,
    /// The strokes, in time steps as fine as they had to be.
    pub strokes: Vec<Stroke>,
    /// What was done.
    pub receipt: Receipt,
}

/// Why a deformation gave nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DeformError {
    /// The monitor stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The mesh has an index out of range or a coordinate that is not finite.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A coordinate left the range of numbers.
    #[error("vertex {vertex} is carried out of the range of numbers; coordinates or strokes are too large")]
    Overflow {
        /// Index of the vertex, inserted ones included.
        vertex: usize,
    },
    /// A stamp cannot be pressed.
    #[error("stroke {stroke}: {source}")]
    Stamp {
        /// Index of the stroke, from 0.
        stroke: usize,
        /// Why not.
        source: StampError,
    },
    /// The volume of the mesh as given is no number.
    #[error("the volume is beyond the range of numbers; coordinates are too large")]
    VolumeOverflow,
}

/// A lock that moves a vertex by more than this share of the shortest edge at it may fold triangles. Larger stays silent when
/// that happens; smaller cries over nothing.
const NOTABLE_LOCK_SHIFT: f64 = 0.1;

/// A facet error, estimated or measured, beyond this share of the volume is worth a note.
const NOTABLE_FACET_ERROR: f64 = 5e-3;

/// Deforms `mesh` by the strokes, one after the other.
///
/// Every vertex, inserted ones included, follows the flow from where it lies on the mesh as given, or on the mesh that a stamp
/// left: what follows a stamp takes its flat triangles for the true surface. The flow keeps volumes up
/// to the error of the time step (order four); flat triangles do up to the facet error, which refinement holds below
/// [`RefineOptions::volume`] by an estimate; the lock gives back what is left. A volume is kept only where the mesh is closed,
/// and self-intersections of the mesh as given stay.
///
/// The result has the same bits for any number of threads.
///
/// # Errors
/// [`DeformError`].
pub fn deform(
    mesh: &TriMesh,
    strokes: &[Stroke],
    options: &DeformOptions,
    monitor: &dyn Monitor,
) -> Result<Deformed, DeformError> {
    mesh.check_valid()?;
    let topology = Topology::of(mesh);
    let volume_before =
        ClosedMesh::with_topology(mesh, &topology).is_ok().then(|| signed_volume(&mesh.positions, &mesh.triangles));
    if volume_before.is_some_and(|volume| !volume.is_finite()) {
        return Err(DeformError::VolumeOverflow);
    }
    let has_volume = volume_before.is_some_and(|volume| volume != 0.0);
    if let Some(stroke) = strokes.iter().position(|stroke| matches!(stroke, Stroke::Stamp(_)) && !has_volume) {
        return Err(DeformError::Stamp { stroke, source: StampError::NoVolume });
    }
    let mut receipt = Receipt { volume_before, ..Receipt::default() };
    let mut tessellation = Tessellation::new(mesh, &topology);
    drop(topology);
    let criteria = options.refine.as_ref().map(|refine| Criteria::new(refine, &tessellation, volume_before));

    let mut facet_error = 0.0;
    // A stamp is no flow: it acts on the surface that those before it leave, and those after it set out from what it leaves.
    let mut strokes = strokes.to_vec();
    for phase in strokes.split_inclusive_mut(|stroke| matches!(stroke, Stroke::Stamp(_))) {
        let (flows, stamp) = match phase {
            [flows @ .., Stroke::Stamp(stamp)] => (flows, Some(&*stamp)),
            flows => (flows, None),
        };
        facet_error += flow(&mut tessellation, flows, criteria.as_ref(), &mut receipt, monitor)?;
        if let Some(stamp) = stamp {
            imprint(&mut tessellation, stamp, criteria.as_ref(), &mut receipt, monitor)?;
        }
    }
    if let Some(vertex) = tessellation.image.iter().position(|image| !image.is_finite()) {
        return Err(DeformError::Overflow { vertex });
    }
    let mut locked = None;
    if let Some(volume) = volume_before.filter(|_| options.lock) {
        let begin = Instant::now();
        let prepared = prepare_lock(&mut tessellation, since_last_stamp(&strokes), criteria.as_ref(), volume, monitor)?;
        facet_error = prepared.facet_error.unwrap_or(facet_error);
        locked = prepared.locked;
        receipt.notes.extend((prepared.crossing > 0).then_some(Note::LockCrossings { triangles: prepared.crossing }));
        receipt.seconds.lock = begin.elapsed().as_secs_f64();
    }
    receipt.moved_vertices = count_different(&tessellation.rest, &tessellation.image);
    receipt.inserted_vertices = tessellation.rest.len() - mesh.positions.len();

    if let Some(volume) = volume_before {
        let bare = tessellation.image_volume();
        receipt.volume_before_lock = Some(bare);
        receipt.facet_error = Some(facet_error);
        if let Some(change) = relative_change(volume, bare) {
            let share = change.abs().max((facet_error / volume).abs());
            receipt.notes.extend((share > NOTABLE_FACET_ERROR).then_some(Note::FacetError { share }));
        }
    }
    if options.lock {
        lock(&mut tessellation, locked, &mut receipt);
    }
    receipt.volume_after = volume_before.map(|_| signed_volume(&tessellation.image, &tessellation.triangles));
    receipt.max_displacement = tessellation
        .rest
        .iter()
        .zip(&tessellation.image)
        .map(|(rest, image)| rest.distance(*image))
        .fold(0.0, f64::max);

    let (rest, image) = match tessellation.into_subdivision() {
        (Some(subdivision), image) => (mesh.subdivided(&subdivision), image),
        (None, image) => (mesh.clone(), image),
    };
    let mut mesh = TriMesh { positions: image, ..rest.clone() };
    mesh.turn_normals(&rest.positions);
    Ok(Deformed { mesh, rest, strokes, receipt })
}

/// The strokes that the base of the flow still has before it.
fn since_last_stamp(strokes: &[Stroke]) -> &[Stroke] {
    let last = strokes.iter().rposition(|stroke| matches!(stroke, Stroke::Stamp(_)));
    &strokes[last.map_or(0, |last| last + 1)..]
}

/// Carries the mesh through all `strokes`, none of which is a stamp. Returns the facet error.
fn flow(
    mesh: &mut Tessellation,
    strokes: &mut [Stroke],
    criteria: Option<&Criteria>,
    receipt: &mut Receipt,
    monitor: &dyn Monitor,
) -> Result<f64, Cancelled> {
    let mut facet_error = 0.0;
    let volume = mesh.image_volume();
    for index in 0..strokes.len() {
        let jacobian = choose_step(&mut strokes[index], receipt.strokes.len(), mesh, &mut receipt.notes, monitor)?;
        facet_error = apply(mesh, &strokes[..=index], jacobian, criteria, receipt, monitor)?;
    }
    match criteria {
        Some(criteria) => {
            facet_error = refine_to_volume(mesh, strokes, criteria, volume, facet_error, monitor)?;
            Ok(separate(mesh, strokes, criteria, receipt, monitor)?.unwrap_or(facet_error))
        }
        None => Ok(facet_error),
    }
}

/// Presses a stamp into the image and writes its receipt.
fn imprint(
    mesh: &mut Tessellation,
    stamp: &Stamp,
    criteria: Option<&Criteria>,
    receipt: &mut Receipt,
    monitor: &dyn Monitor,
) -> Result<(), DeformError> {
    let stroke = receipt.strokes.len();
    let begin = Instant::now();
    let before = mesh.image.clone();
    let pressed = press(mesh, stamp, criteria, monitor).map_err(|error| match error {
        PressError::Cancelled(cancelled) => DeformError::Cancelled(cancelled),
        PressError::Stamp(source) => DeformError::Stamp { stroke, source },
    })?;
    let known = before.len();
    let moved = count_different(&before, &mesh.image) + count_different(&mesh.rest[known..], &mesh.image[known..]);
    if let Some(criteria) = criteria.filter(|_| pressed.refinement.is_limited) {
        receipt.notes.push(Note::TriangleLimit { stroke, max_triangles: criteria.max_triangles() });
    }
    receipt.notes.extend((!pressed.has_touched).then_some(Note::StampMissed { stroke }));
    receipt.notes.extend(pressed.is_through.then_some(Note::StampThrough { stroke }));
    let seconds = begin.elapsed().as_secs_f64();
    receipt.seconds.advect += seconds;
    conclude(
        mesh,
        receipt,
        StrokeReceipt {
            seconds,
            evaluations: pressed.refinement.evaluations,
            moved,
            inserted: pressed.refinement.inserted,
            jacobian: None,
            volume_change: None,
        },
    );
    Ok(())
}

/// Carries the mesh through the last of `strokes`, refines it, and writes the stroke's receipt. Returns the facet error.
fn apply(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    jacobian: Option<JacobianRange>,
    criteria: Option<&Criteria>,
    receipt: &mut Receipt,
    monitor: &dyn Monitor,
) -> Result<f64, Cancelled> {
    let Some((stroke, past)) = strokes.split_last() else { return Ok(0.0) };
    let begin = Instant::now();
    let resolved = match criteria {
        Some(criteria) => resolve_field(mesh, past, stroke, criteria, monitor)?,
        None => Refinement::default(),
    };
    let resolve_end = Instant::now();
    let advected = mesh.advect(stroke, monitor)?;
    let advect_end = Instant::now();
    let known = mesh.image.len();
    let refined = refine(mesh, strokes, criteria, monitor)?;
    let moved = advected.moved + count_different(&mesh.rest[known..], &mesh.image[known..]);
    let end = Instant::now();

    receipt.seconds.advect += (advect_end - resolve_end).as_secs_f64();
    receipt.seconds.refine += (resolve_end - begin + (end - advect_end)).as_secs_f64();
    if let Some(criteria) = criteria.filter(|_| resolved.is_limited || refined.is_limited) {
        receipt
            .notes
            .push(Note::TriangleLimit { stroke: receipt.strokes.len(), max_triangles: criteria.max_triangles() });
    }
    conclude(
        mesh,
        receipt,
        StrokeReceipt {
            seconds: (end - begin).as_secs_f64(),
            evaluations: resolved.evaluations + advected.evaluations + refined.evaluations,
            moved,
            inserted: resolved.inserted + refined.inserted,
            jacobian,
            volume_change: None,
        },
    );
    Ok(refined.facet_error)
}

/// Adds a stroke to the receipt, with the change of the volume since the one before.
fn conclude(mesh: &mut Tessellation, receipt: &mut Receipt, mut stroke: StrokeReceipt) {
    let volume_so_far: f64 = receipt.strokes.iter().filter_map(|stroke| stroke.volume_change).sum();
    stroke.volume_change = receipt
        .volume_before
        .and_then(|volume| relative_change(volume, mesh.image_volume()))
        .map(|change| change - volume_so_far);
    receipt.strokes.push(stroke);
}

/// Splits what crosses itself in the end. Returns the facet error, if any was split.
fn separate(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    criteria: &Criteria,
    receipt: &mut Receipt,
    monitor: &dyn Monitor,
) -> Result<Option<f64>, Cancelled> {
    let begin = Instant::now();
    let untangled = untangle(mesh, strokes, criteria, monitor)?;
    let facet_error =
        if untangled.inserted > 0 { Some(refine(mesh, strokes, None, monitor)?.facet_error) } else { None };
    receipt.seconds.refine += begin.elapsed().as_secs_f64();
    Ok(facet_error)
}

/// Moves the vertices to where they are `locked`, and writes the receipt.
fn lock(mesh: &mut Tessellation, locked: Option<(Vec<DVec3>, Lock)>, receipt: &mut Receipt) {
    let note = match locked {
        None if receipt.volume_before.is_none() => Some(Note::LockNeedsClosed),
        None => Some(Note::LockSkipped),
        Some((image, lock)) => {
            mesh.image = image;
            receipt.lock_max_shift = Some(lock.max_shift);
            let ratio = lock.max_shift_per_edge;
            (ratio > NOTABLE_LOCK_SHIFT).then_some(Note::LockShift { ratio })
        }
    };
    receipt.notes.extend(note);
}

/// Signed change of a volume as a share of its size, which a mesh inside out has too; none where there is no volume.
fn relative_change(before: f64, after: f64) -> Option<f64> {
    (before != 0.0).then(|| (after - before) / before.abs())
}

fn count_different(before: &[DVec3], after: &[DVec3]) -> usize {
    before.iter().zip(after).filter(|&(&before, &after)| bits(before) != bits(after)).count()
}

#[cfg(test)]
mod tests;
