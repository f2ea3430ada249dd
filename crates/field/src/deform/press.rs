//! The press: presses a stamp into a surface, step by step.
//!
//! Each step dents the surface and raises a rim. A vertex inside the tool moves with the tool until it
//! is on its surface, so the tool neither cuts into the vertices nor leaves a gap. The exact balance
//! raises the displaced volume around the contact. A step that would fold triangles is halved.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, section 11.2.6. The source
//! balances products of speeds; this press balances volumes of meshes, which is exact for any length
//! of step.

mod contact;
mod footprint;
mod outline;
mod rim;
mod step_motion;

use contact::Cause;
use glam::DVec3;
use isochore_mesh::{Cancelled, Monitor, signed_volume};

use super::{
    balance::balance,
    refine::{Criteria, Refinement},
    tessellation::Tessellation,
};
use crate::flow::Stamp;
pub(crate) use outline::Outline;
use step_motion::StepMotion;

/// Errors when pressing a [`Stamp`] into a surface.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PressError {
    /// The surface is open or encloses no volume.
    #[error("a stamp cannot raise what it displaces on an open mesh or one without volume; close the mesh")]
    NoVolume,
    /// The tool is inside the surface at its first key.
    #[error("the stamp starts {depth} deep in the surface, at vertex {vertex}; start it outside")]
    StartsInside {
        /// Index of the deepest vertex, inserted ones included.
        vertex: usize,
        /// Its depth in the tool, model units.
        depth: f64,
    },
    /// The surface around the tool cannot take up the displaced volume.
    #[error(
        "the surface around the contact cannot take up the volume that the stamp displaces \
         at {percent:.0} % of its path; \
         widen the tool's support or press less deeply"
    )]
    NoRoom {
        /// Percentage of the path at which the press stopped.
        percent: f64,
    },
}

/// The end of a press before the end of its path.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PressStop {
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    #[error(transparent)]
    Stamp(#[from] PressError),
}

/// Result of pressing a stamp.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pressed {
    /// Refinement, with all evaluations of the distance.
    pub(crate) refinement: Refinement,
    /// Whether the tool touched the surface.
    pub(crate) has_touched: bool,
    /// Whether the tool touched the surface from both sides, as it does when it goes through a sheet.
    pub(crate) is_through: bool,
}

/// Most halvings of a step. A larger value spends long on a stamp that cannot be pressed; a smaller value
/// gives up on relief that is finer than the steps.
const MAX_HALVINGS: i32 = 8;

/// Most rounds of a step. Raised vertices may enter the tool; the volume that they lose on leaving it is
/// raised elsewhere. It shrinks from round to round, so a few suffice. The limit only ends a loop that
/// a defect would keep alive.
const MAX_ROUNDS: usize = 24;

/// Largest change of an edge, relative to its length, when one step raises its ends. Below one, nothing
/// folds. A larger value makes the height of the rim depend on the number of steps; a smaller value
/// takes more steps.
const MOST_STRETCH: f64 = 0.125;

/// Depth to which the tool may start inside the surface, as a fraction of the
/// [relief](Stamp::relief). After an earlier stamp, flat triangles between vertices on the tool cut
/// about as deep into it. A larger value accepts a tool that starts inside; a smaller value refuses to
/// continue from an earlier stamp.
const START_DEPTH: f64 = 0.5;

/// Presses `stamp` into the image. The image is frozen before and after each step. Without `criteria`,
/// no triangle is split. Also returns the outline of the contact.
pub(crate) fn press(
    mesh: &mut Tessellation,
    stamp: &Stamp,
    criteria: Option<&Criteria>,
    monitor: &dyn Monitor,
) -> Result<(Pressed, Outline), PressStop> {
    let mut outline = Outline::default();
    let volume = signed_volume(&mesh.image, &mesh.triangles);
    let mut pressed = Pressed::default();
    let mut ends = stamp.path().step_ends();
    let (duration, steps) = (ends[ends.len() - 1], ends.len());
    let shortest = duration / steps as f64 * f64::powi(0.5, MAX_HALVINGS);
    ends.reverse();
    let mut time = 0.0;
    while let Some(&end) = ends.last() {
        monitor.check("stamp", time / duration)?;
        let motion = StepMotion::new(stamp, time, end);
        mesh.freeze();
        if let Some(criteria) = criteria {
            let rim_edge = if pressed.has_touched { motion.rim_edge() } else { f64::INFINITY };
            pressed.refinement.add(&footprint::resolve(mesh, &motion, rim_edge, criteria, monitor)?);
        }
        if time == 0.0 {
            check_start(&motion, &mesh.image)?;
        }
        let contact = criteria.map(|_| outline::Contact::of(mesh, &motion));
        let step = step(mesh, &motion, volume);
        pressed.add(&step);
        if let Some(contact) = &contact {
            pressed.refinement.evaluations += contact.evaluations;
        }
        if step.is_complete {
            contact.iter().for_each(|contact| outline.add(contact));
            time = end;
            ends.pop();
        } else {
            mesh.image.copy_from_slice(&mesh.base);
            if end - time < shortest {
                return Err(PressError::NoRoom { percent: 100.0 * time / duration }.into());
            }
            ends.push(0.5 * (time + end));
        }
    }
    mesh.freeze();
    Ok((pressed, outline))
}

/// Result of one step of a stamp.
#[derive(Debug, Clone, Copy, Default)]
struct Step {
    /// Whether the step succeeded. If not, the image is invalid and the step must be halved.
    is_complete: bool,
    has_touched: bool,
    is_through: bool,
    /// Evaluations of the distance.
    evaluations: u64,
}

impl Pressed {
    fn add(&mut self, step: &Step) {
        self.refinement.evaluations += step.evaluations;
        self.has_touched |= step.has_touched;
        self.is_through |= step.is_through;
    }
}

/// Dents and raises the image once.
fn step(mesh: &mut Tessellation, motion: &StepMotion<'_>, volume: f64) -> Step {
    let mut step = Step::default();
    for round in 0..MAX_ROUNDS {
        let cause = if round == 0 { Cause::Motion } else { Cause::Raising };
        let near = contact::dent(&mut mesh.image, motion, cause);
        step.evaluations += near.evaluations;
        if near.dented.is_empty() {
            return Step { is_complete: true, ..step };
        }
        let rim = rim::Rim::new(&mesh.image, &mesh.triangles, &near, motion);
        if round == 0 {
            step.has_touched = true;
            step.is_through = rim.is_through;
        }
        let dented = mesh.image.clone();
        if balance(&mut mesh.image, &rim.directions, &mesh.triangles, volume).is_none()
            || is_overstretched(&dented, &mesh.image, &mesh.triangles)
        {
            return step;
        }
    }
    step
}

/// Whether an edge has changed by more than [`MOST_STRETCH`].
fn is_overstretched(before: &[DVec3], after: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    triangles.iter().any(|triangle| {
        let [a, b, c] = triangle.map(|vertex| after[vertex as usize] - before[vertex as usize]);
        if a == b && b == c {
            return false;
        }
        let [p, q, r] = triangle.map(|vertex| before[vertex as usize]);
        [(a - b, p - q), (b - c, q - r), (c - a, r - p)]
            .into_iter()
            .any(|(change, edge)| change.length_squared() > MOST_STRETCH * MOST_STRETCH * edge.length_squared())
    })
}

/// Checks that the tool starts outside the surface.
fn check_start(motion: &StepMotion<'_>, positions: &[DVec3]) -> Result<(), PressError> {
    let near = contact::Near::of(positions, motion.tool, &motion.start);
    let depth = |index: usize| -near.distances[index];
    match (0..near.vertices.len()).max_by(|&a, &b| depth(a).total_cmp(&depth(b))) {
        Some(deepest) if depth(deepest) > START_DEPTH * motion.relief => {
            let vertex = near.vertices[deepest] as usize;
            Err(PressError::StartsInside { vertex, depth: depth(deepest) })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
