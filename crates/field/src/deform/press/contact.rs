//! Contact: where what the tool runs over comes to lie on its surface.
//!
//! In coordinates of the tool at the end of a step, a vertex it has run over lies inside, and the same vertex carried along
//! rigidly lies where it was before the step, outside. On the straight way between the two it stops where the distance
//! first is zero.

use glam::DVec3;
use isochore_mesh::{Distance, DistanceBlock, LANES, PointBlock};
use rayon::prelude::*;

use super::Leg;
use crate::fields::{Tool, pose::Placement};

/// The vertices within reach of a tool, with their distances from it.
#[derive(Debug, Default)]
pub(super) struct Near {
    /// In ascending order.
    pub(super) vertices: Vec<u32>,
    /// Signed distances from the tool; infinite where it is not known.
    pub(super) distances: Vec<f64>,
    /// Gradients of the distance, in world axes.
    pub(super) gradients: Vec<DVec3>,
    /// Indices into `vertices` of those that the tool ran over and took along.
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

/// How what lies in the tool got there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cause {
    /// The tool ran over it: it goes along with the tool.
    Motion,
    /// It was raised into the tool, which has not moved since: it leaves by the shortest way.
    Raising,
}

/// Takes every vertex that lies in the tool at the end of the leg to where it lies on the tool's surface.
pub(super) fn dent(positions: &mut [DVec3], leg: &Leg<'_>, cause: Cause) -> Near {
    let mut near = Near::of(positions, leg.tool, &leg.end);
    near.dented =
        (0..near.vertices.len() as u32).filter(|&index| near.distances[index as usize] < -leg.rounding).collect();
    let searches: Vec<Search> = near
        .dented
        .iter()
        .map(|&index| {
            let position = positions[near.vertices[index as usize] as usize];
            let [from, to] = [&leg.end, &leg.start].map(|placement| placement.to_local(position));
            match cause {
                Cause::Motion => Search::along(from, near.distances[index as usize], to),
                Cause::Raising => Search::out_of(from),
            }
        })
        .collect();
    let found: Vec<Search> =
        searches.par_chunks(LANES).flat_map_iter(|block| search(leg.tool.distance(), block, leg.rounding)).collect();
    for (&index, search) in near.dented.iter().zip(&found) {
        let index = index as usize;
        positions[near.vertices[index] as usize] = leg.end.to_world(search.point());
        near.distances[index] = search.value;
        near.gradients[index] = leg.end.turn_to_world(search.gradient);
        near.evaluations += search.evaluations;
    }
    near
}

/// The search for the first point of a way from inside the tool to outside where the distance is zero.
#[derive(Debug, Clone, Copy)]
struct Search {
    from: DVec3,
    to: DVec3,
    stage: Stage,
    /// Share of the way and distance there, last known inside.
    inside: (f64, f64),
    /// The same, first known outside.
    outside: (f64, f64),
    /// Share of the way that is looked at.
    at: f64,
    /// Beside the way: set once the search has left it.
    aside: Option<DVec3>,
    value: f64,
    gradient: DVec3,
    evaluations: u64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// Looks whether the end of the way is outside at all.
    End,
    /// Goes along the way by steps that cannot jump over the surface.
    March,
    /// Knows a point inside and one outside.
    Bracket,
    /// Leaves the tool by the shortest way.
    Leave,
    Done,
}

/// Shortest step of the march as a share of the way. Larger may jump over what sticks out of a side wall; smaller takes long
/// where the way leads along the surface.
const SHORTEST_STEP: f64 = 1.0 / 32.0;

/// Evaluations at most: the march takes 32, and bisecting every third time halves the bracket to rounding in 160. It only ends
/// what a distance that is not continuous would keep going.
const MAX_EVALUATIONS: u64 = 200;

/// Newton steps at most on the shortest way out. They square the error where the surface is smooth.
const MAX_NEWTON_STEPS: u64 = 20;

/// Of what counts as zero, the share that a search aims at: rounding to world coordinates adds the rest.
const AIM: f64 = 1.0 / 16.0;

impl Search {
    /// The search for the first point of a way that is on the surface.
    fn along(from: DVec3, distance: f64, to: DVec3) -> Self {
        Self {
            from,
            to,
            stage: Stage::End,
            inside: (0.0, distance),
            outside: (1.0, f64::INFINITY),
            at: 1.0,
            aside: None,
            value: distance,
            gradient: DVec3::ZERO,
            evaluations: 0,
        }
    }

    /// The search for a point of the surface near one inside.
    fn out_of(point: DVec3) -> Self {
        Self { stage: Stage::Leave, aside: Some(point), ..Self::along(point, f64::NEG_INFINITY, point) }
    }

    /// The point that is looked at, in tool coordinates.
    fn point(&self) -> DVec3 {
        let on_way = || if self.at == 1.0 { self.to } else { self.from + self.at * (self.to - self.from) };
        self.aside.unwrap_or_else(on_way)
    }

    /// Takes in the distance at [`point`](Self::point) and says where to look next.
    fn learn(&mut self, value: f64, gradient: DVec3, lipschitz: f64, rounding: f64) {
        if self.stage == Stage::Done {
            return;
        }
        (self.value, self.gradient) = (value, gradient);
        self.evaluations += 1;
        match self.stage {
            // What touches the tool stays on it; what is inside all the way, as the middle of a flat edge can be, leaves it.
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
                // Better a rounding outside than inside.
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

/// Carries out the searches of a block side by side.
fn search(distance: &dyn Distance, block: &[Search], rounding: f64) -> Vec<Search> {
    let mut searches = block.to_vec();
    let mut out = DistanceBlock::FAR;
    let lipschitz = distance.lipschitz();
    while searches.iter().any(|search| search.stage != Stage::Done) {
        let points: Vec<DVec3> = searches.iter().map(Search::point).collect();
        distance.sample_into(&PointBlock::gather(&points), &mut out);
        for (lane, search) in searches.iter_mut().enumerate() {
            search.learn(out.value[lane], out.gradient.get(lane), lipschitz, rounding);
        }
    }
    searches
}
