//! The press: acts a stamp on a surface, step by step.
//!
//! Each step dents and raises. Vertices that the tool runs over go with it until they lie on its surface, so that it neither
//! cuts into them nor leaves a gap; the volume so displaced is raised around the contact by the exact balance. Where a step
//! would fold triangles it is halved.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, section 11.2.6. There the volumes are products of
//! speeds; here they are those of the meshes, so that nothing is lost at any length of step.

mod contact;
mod footprint;
mod rim;

use contact::Cause;
use glam::DVec3;
use isochore_mesh::{Cancelled, Monitor, signed_volume};

use super::{
    balance::balance,
    refine::{Criteria, Refinement},
    tessellation::Tessellation,
};
use crate::{
    fields::{Tool, pose::Placement},
    flow::Stamp,
};

/// Why a stamp cannot be pressed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PressError {
    /// The surface encloses no volume that could be kept.
    #[error(
        "a stamp raises what it displaces, and an open mesh, or one without volume, has nothing to balance; close it"
    )]
    NoVolume,
    /// The tool is in the surface before it has moved.
    #[error("the stamp starts {depth} deep in the surface, at vertex {vertex}; start it outside")]
    StartsInside {
        /// Index of the vertex that lies deepest, inserted ones included.
        vertex: usize,
        /// How deep, model units.
        depth: f64,
    },
    /// What the tool displaces cannot be raised around it.
    #[error(
        "the surface around the contact cannot take up what the stamp displaces on {percent:.0} % of its way; \
         widen the tool's support or press less deep"
    )]
    NoRoom {
        /// Share of the way at which it stopped.
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

/// What a stamp did.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pressed {
    /// What was split, and all evaluations of the distance.
    pub(crate) refinement: Refinement,
    /// Whether it touched anything.
    pub(crate) has_touched: bool,
    /// Whether it touched the surface from both sides, as when it goes through a sheet.
    pub(crate) is_through: bool,
}

/// A step is halved this often before it is given up. Larger spends long on what will never fit; smaller gives up on relief
/// that is finer than the steps.
const MAX_HALVINGS: i32 = 8;

/// Raised vertices may meet the tool, and what they then give way is raised elsewhere: less each time, so that a few rounds
/// do. It only ends what a defect would keep going.
const MAX_ROUNDS: usize = 24;

/// No edge may change by more than this share of its length by raising its ends in one step: below one, nothing folds. Larger
/// lets the height of the rim depend on the number of steps; smaller takes more steps.
const MOST_STRETCH: f64 = 0.125;

/// Presses `stamp` into the image, which is frozen before and after. `criteria` allow splitting.
pub(crate) fn press(
    mesh: &mut Tessellation,
    stamp: &Stamp,
    criteria: Option<&Criteria>,
    monitor: &dyn Monitor,
) -> Result<Pressed, PressStop> {
    let volume = signed_volume(&mesh.image, &mesh.triangles);
    let mut pressed = Pressed::default();
    let mut ends = stamp.way().step_ends();
    let (duration, steps) = (ends[ends.len() - 1], ends.len());
    let shortest = duration / steps as f64 * f64::powi(0.5, MAX_HALVINGS);
    ends.reverse();
    let mut time = 0.0;
    while let Some(&end) = ends.last() {
        monitor.check("stamp", time / duration)?;
        let leg = Leg::new(stamp, time, end);
        mesh.freeze();
        if let Some(criteria) = criteria {
            let rim_edge = if pressed.has_touched { leg.rim_edge() } else { f64::INFINITY };
            pressed.refinement.add(&footprint::resolve(mesh, &leg, rim_edge, criteria, monitor)?);
        }
        if time == 0.0 {
            leg.check_start(&mesh.image)?;
        }
        let step = step(mesh, &leg, volume);
        pressed.add(&step);
        if step.is_complete {
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
    Ok(pressed)
}

/// Result of one step of a stamp.
#[derive(Debug, Clone, Copy, Default)]
struct Step {
    /// Whether the step was done. If not, the image is of no use and the step must be shorter.
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
fn step(mesh: &mut Tessellation, leg: &Leg<'_>, volume: f64) -> Step {
    let mut step = Step::default();
    for round in 0..MAX_ROUNDS {
        let cause = if round == 0 { Cause::Motion } else { Cause::Raising };
        let near = contact::dent(&mut mesh.image, leg, cause);
        step.evaluations += near.evaluations;
        if near.dented.is_empty() {
            return Step { is_complete: true, ..step };
        }
        let rim = rim::Rim::new(&mesh.image, &mesh.triangles, &near, leg);
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

/// Whether an edge has changed by too much of its length.
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

/// A part of a stamp's way.
#[derive(Debug)]
struct Leg<'a> {
    tool: &'a Tool,
    start: Placement,
    end: Placement,
    /// Longest edge wanted where the tool touches.
    relief: f64,
    /// Distances that rounding cannot tell from zero, model units.
    rounding: f64,
}

/// Roundings of the coordinates at hand that a distance takes up. Larger lets the tool stand in the surface; smaller sees
/// contact come and go by rounding alone.
const ROUNDINGS: f64 = 64.0;

/// Share of the [relief](Stamp::relief) that the tool may stand in the surface where it starts: about as far as flat triangles
/// between vertices that touch it cut into it, left by a stamp before. Larger takes a tool that starts inside for one that
/// touches; smaller refuses to go on from a stamp.
const START_DEPTH: f64 = 0.5;

/// Edges across the support, at least, where something is raised. Fewer make an angular rim; more cost triangles.
const EDGES_ACROSS_RIM: f64 = 8.0;

impl<'a> Leg<'a> {
    fn new(stamp: &'a Stamp, from: f64, to: f64) -> Self {
        let way = stamp.way();
        let [start, end] = [from, to].map(|time| way.pose_at(time));
        let bounds = way.tool().support_bounds();
        let extent = bounds.min.abs().max(bounds.max.abs()).max_element()
            + start.translation.abs().max(end.translation.abs()).max_element();
        Self {
            tool: way.tool(),
            start: Placement::from(&start),
            end: Placement::from(&end),
            relief: stamp.relief(),
            rounding: ROUNDINGS * f64::EPSILON * extent,
        }
    }

    /// Longest edge where the support reaches around a contact, model units.
    fn rim_edge(&self) -> f64 {
        self.tool.support() / EDGES_ACROSS_RIM
    }

    /// Whether the tool is outside where it starts.
    fn check_start(&self, positions: &[DVec3]) -> Result<(), PressError> {
        let near = contact::Near::of(positions, self.tool, &self.start);
        let depth = |index: usize| -near.distances[index];
        match (0..near.vertices.len()).max_by(|&a, &b| depth(a).total_cmp(&depth(b))) {
            Some(deepest) if depth(deepest) > START_DEPTH * self.relief => {
                let vertex = near.vertices[deepest] as usize;
                Err(PressError::StartsInside { vertex, depth: depth(deepest) })
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
