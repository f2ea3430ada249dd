//! Contact: the points of the tool's surface to which a step moves the vertices inside the tool.
//!
//! Take the coordinates of the tool at the end of a step. A vertex that the tool has run over is inside.
//! If the vertex had moved rigidly with the tool, it would still be outside. On the line between
//! these two positions the vertex goes to the first point where the distance is zero.

use glam::DVec3;
use isochore_mesh::{Distance, DistanceBlock, LANES, PointBlock};
use rayon::prelude::*;

use super::step_motion::StepMotion;
use crate::fields::{Tool, pose::Placement};

/// The vertices near a tool, with their distances from it.
#[derive(Debug, Default)]
pub(super) struct Near {
    /// In ascending order.
    pub(super) vertices: Vec<u32>,
    /// Signed distances from the tool; infinite beyond the samples of a grid.
    pub(super) distances: Vec<f64>,
    /// Gradients of the distance, in world axes.
    pub(super) gradients: Vec<DVec3>,
    /// Indices into `vertices` of those that were inside the tool and moved to its surface.
    pub(super) dented: Vec<u32>,
    /// Evaluations of the distance.
    pub(super) evaluations: u64,
}

impl Near {
    /// The vertices in the box around the support of `tool`.
    pub(super) fn of(positions: &[DVec3], tool: &Tool, placement: &Placement) -> Self {
        let bounds = tool.support_bounds();
        let is_near = |&vertex: &u32| bounds.distance(placement.to_local(positions[vertex as usize])) == 0.0;
        let vertices: Vec<u32> = (0..positions.len() as u32).into_par_iter().filter(is_near).collect();
        let points: Vec<DVec3> = vertices.iter().map(|&vertex| positions[vertex as usize]).collect();
        let (distances, gradients) = sample(tool, placement, &points);
        let evaluations = points.len() as u64;
        Self { vertices, distances, gradients, dented: Vec::new(), evaluations }
    }
}

/// Distances of world points from a tool, and their gradients in world axes.
pub(super) fn sample(tool: &Tool, placement: &Placement, points: &[DVec3]) -> (Vec<f64>, Vec<DVec3>) {
    let block = |points: &[DVec3]| {
        let local: Vec<DVec3> = points.iter().map(|&point| placement.to_local(point)).collect();
        let mut out = DistanceBlock::FAR;
        tool.distance().sample_into(&PointBlock::gather(&local), &mut out);
        let lanes = 0..points.len();
        lanes.map(|lane| (out.value[lane], placement.turn_to_world(out.gradient.get(lane)))).collect::<Vec<_>>()
    };
    points.par_chunks(LANES).flat_map_iter(block).unzip()
}

/// Why a vertex is inside the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cause {
    /// The tool ran over it, so it moves with the tool.
    Motion,
    /// The rim raised it into the tool, which has not moved since, so it takes the shortest path out.
    Raising,
}

/// Moves every vertex inside the tool at the end of the step to the surface of the tool.
pub(super) fn dent(positions: &mut [DVec3], motion: &StepMotion<'_>, cause: Cause) -> Near {
    let mut near = Near::of(positions, motion.tool, &motion.end);
    near.dented =
        (0..near.vertices.len() as u32).filter(|&index| near.distances[index as usize] < -motion.rounding).collect();
    let searches: Vec<Search> = near
        .dented
        .iter()
        .map(|&index| {
            let position = positions[near.vertices[index as usize] as usize];
            let [from, to] = [&motion.end, &motion.start].map(|placement| placement.to_local(position));
            match cause {
                Cause::Motion => Search::along(from, near.distances[index as usize], to),
                Cause::Raising => Search::out_of(from),
            }
        })
        .collect();
    let found: Vec<Search> = searches
        .par_chunks(LANES)
        .flat_map_iter(|block| search(motion.tool.distance(), block, motion.rounding))
        .collect();
    for (&index, search) in near.dented.iter().zip(&found) {
        let index = index as usize;
        positions[near.vertices[index] as usize] = motion.end.to_world(search.point());
        near.distances[index] = search.value;
        near.gradients[index] = motion.end.turn_to_world(search.gradient);
        near.evaluations += search.evaluations;
    }
    near
}

/// An edge that leaves the tool, in tool coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeavingEdge {
    /// Inside the tool.
    pub(super) from: DVec3,
    /// Outside the tool.
    pub(super) to: DVec3,
    /// Distance at `from`.
    pub(super) distance: f64,
}

/// Where an edge passes the tool's surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    /// Fraction of the edge from its inner end.
    pub(super) fraction: f64,
    /// Gradient of the distance there, in world axes.
    pub(super) gradient: DVec3,
    /// Direction in which the tool moves there.
    pub(super) motion: DVec3,
}

/// Where each edge reaches the distance `offset` from the tool at the end of a step, and the number of
/// evaluations of the distance.
pub(super) fn crossings(motion: &StepMotion<'_>, edges: &[LeavingEdge], offset: f64) -> (Vec<Crossing>, u64) {
    let along = |edge: &LeavingEdge| Search { offset, ..Search::along(edge.from, edge.distance - offset, edge.to) };
    let searches: Vec<Search> = edges.iter().map(along).collect();
    let found: Vec<Search> = searches
        .par_chunks(LANES)
        .flat_map_iter(|block| search(motion.tool.distance(), block, motion.rounding))
        .collect();
    let crossing = |search: &Search| {
        let [before, after] = [&motion.start, &motion.end].map(|placement| placement.to_world(search.point()));
        Crossing {
            fraction: search.at,
            gradient: motion.end.turn_to_world(search.gradient),
            motion: (after - before).normalize_or_zero(),
        }
    };
    (found.iter().map(crossing).collect(), found.iter().map(|search| search.evaluations).sum())
}

/// A search for the first zero of the distance on a line from inside the tool to outside.
///
/// Positions on the line are fractions of its length.
#[derive(Debug, Clone, Copy)]
struct Search {
    from: DVec3,
    to: DVec3,
    stage: Stage,
    /// Position and distance of the last known point inside.
    inside: (f64, f64),
    /// Position and distance of the first known point outside.
    outside: (f64, f64),
    /// Position to evaluate next.
    at: f64,
    /// Point to evaluate next once the search has left the line.
    aside: Option<DVec3>,
    /// Distance that counts as zero.
    offset: f64,
    value: f64,
    gradient: DVec3,
    evaluations: u64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// Checks whether the end of the line is outside.
    End,
    /// Marches along the line by steps that cannot pass the surface.
    March,
    /// Shrinks the bracket between a point inside and a point outside.
    Bracket,
    /// Takes Newton steps along the gradient, out of the tool.
    Leave,
    Done,
}

/// Shortest step of the march, as a fraction of the line. A larger value may pass over details of a
/// side wall; a smaller value takes long if the line runs along the surface.
const SHORTEST_STEP: f64 = 1.0 / 32.0;

/// Most evaluations. The march takes 32, and a bisection at every third evaluation shrinks the bracket to
/// rounding in 160. The limit only ends a search in a discontinuous distance.
const MAX_EVALUATIONS: u64 = 200;

/// Most Newton steps on the shortest path out. Each squares the error if the surface is smooth.
const MAX_NEWTON_STEPS: u64 = 20;

/// A search aims at this fraction of the distance that counts as zero. The conversion to world
/// coordinates adds rounding, which needs the margin.
const AIM: f64 = 1.0 / 16.0;

impl Search {
    /// A search for the first point of a line that is on the surface.
    fn along(from: DVec3, distance: f64, to: DVec3) -> Self {
        Self {
            from,
            to,
            stage: Stage::End,
            inside: (0.0, distance),
            outside: (1.0, f64::INFINITY),
            at: 1.0,
            aside: None,
            offset: 0.0,
            value: distance,
            gradient: DVec3::ZERO,
            evaluations: 0,
        }
    }

    /// A search for a point of the surface near a point inside.
    fn out_of(point: DVec3) -> Self {
        Self { stage: Stage::Leave, aside: Some(point), ..Self::along(point, f64::NEG_INFINITY, point) }
    }

    /// The point to evaluate next, in tool coordinates.
    fn point(&self) -> DVec3 {
        let on_line = || if self.at == 1.0 { self.to } else { self.from + self.at * (self.to - self.from) };
        self.aside.unwrap_or_else(on_line)
    }

    /// Processes the distance at [`point`](Self::point) and chooses the next point.
    fn update(&mut self, value: f64, gradient: DVec3, lipschitz: f64, rounding: f64) {
        if self.stage == Stage::Done {
            return;
        }
        let value = value - self.offset;
        (self.value, self.gradient) = (value, gradient);
        self.evaluations += 1;
        match self.stage {
            // A vertex that touches the tool stays on it. The whole line can be inside, as for the
            // midpoint of a flat edge; such a vertex takes the shortest path out.
            Stage::End if value.abs() <= AIM * rounding => return self.stage = Stage::Done,
            Stage::End if value < 0.0 => self.stage = Stage::Leave,
            Stage::End => {
                self.outside.1 = value;
                self.stage = Stage::March;
            }
            Stage::March | Stage::Bracket => {
                if value.abs() <= AIM * rounding {
                    return self.stage = Stage::Done;
                }
                *(if value < 0.0 { &mut self.inside } else { &mut self.outside }) = (self.at, value);
                if value >= 0.0 {
                    self.stage = Stage::Bracket;
                }
            }
            Stage::Leave | Stage::Done => {}
        }
        if self.stage == Stage::March {
            let length = self.from.distance(self.to);
            let step = (-self.inside.1 / (lipschitz * length)).max(SHORTEST_STEP);
            self.at = self.inside.0 + step;
            if self.at >= 1.0 {
                self.stage = Stage::Bracket;
            }
        }
        if self.stage == Stage::Bracket {
            let ((low, below), (high, above)) = (self.inside, self.outside);
            let secant = low + (high - low) * (-below / (above - below));
            let is_good = !self.evaluations.is_multiple_of(3) && secant > low && secant < high;
            let next = if is_good { secant } else { 0.5 * (low + high) };
            let is_narrow = !(next > low && next < high);
            if is_narrow || self.evaluations >= MAX_EVALUATIONS {
                // The outer end of the bracket is off by rounding only, and not inside.
                (self.at, self.value) = self.outside;
                return self.stage = Stage::Done;
            } else {
                self.at = next;
            }
        }
        if self.stage == Stage::Leave {
            let slope = gradient.length_squared();
            if value.abs() <= AIM * rounding || slope == 0.0 || self.evaluations > MAX_NEWTON_STEPS {
                self.stage = Stage::Done;
            } else {
                self.aside = Some(self.point() - value / slope * gradient);
            }
        }
    }
}

/// Runs the searches of a block together, one lane each.
fn search(distance: &dyn Distance, block: &[Search], rounding: f64) -> Vec<Search> {
    let mut searches = block.to_vec();
    let mut out = DistanceBlock::FAR;
    let lipschitz = distance.lipschitz();
    while searches.iter().any(|search| search.stage != Stage::Done) {
        let points: Vec<DVec3> = searches.iter().map(Search::point).collect();
        distance.sample_into(&PointBlock::gather(&points), &mut out);
        for (lane, search) in searches.iter_mut().enumerate() {
            search.update(out.value[lane], out.gradient.get(lane), lipschitz, rounding);
        }
    }
    searches
}
