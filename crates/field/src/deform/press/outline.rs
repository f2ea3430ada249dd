//! The outline: the line on the surface where the contact ends.
//!
//! A surface whose edges cross this line at random gets a saw-toothed outline, because the tool moves whole
//! vertices. The outline is found during one press. Where the tool has a wall, the edges are split on both
//! sides of the outline, and the stamp is pressed again: the outer vertices stay, and the inner ones form the
//! foot of the wall. On slopes the contact grows, and teeth are low.

use std::ops::Range;

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::{
    contact::{Crossing, LeavingEdge, Near, crossings},
    step_motion::StepMotion,
};
use crate::deform::{
    refine::Criteria,
    tessellation::{ChosenEdges, Cut, Tessellation},
};

/// Distance of the vertices on either side of the outline from the tool, in units of the relief. A larger
/// value makes walls lean; a smaller value leaves it to rounding on which side a vertex is.
const BESIDE: f64 = 2e-3;

/// Where an edge is split, as fractions from its inner end. The inner part becomes the wall, so it may be short;
/// an outer end that is close can serve as a vertex of the outline. A larger margin leaves teeth; a smaller
/// one makes triangles without area.
const ON_WALL: Range<f64> = 0.01..0.98;

/// Stretch of an edge across the outline that makes it a wall, which needs vertices at its foot. A larger
/// value leaves the foot of low walls jagged; a smaller value makes slivers where the tool touches at
/// a small angle.
const WALL_STRETCH: f64 = 1.3;

/// Largest cosine between the gradient of the distance and the motion of the tool at a wall. A larger value
/// takes slopes, on which the contact grows, for walls; a smaller value leaves walls with a draft jagged.
const WALL_SLOPE: f64 = 0.3;

/// A later crossing replaces an earlier one unless it is farther inside by more than this fraction of the
/// edge. A larger value accepts a wrong line; a smaller value keeps the direction of the first touch.
const SAME: f64 = 1e-3;

/// Where edges cross the outline of a contact.
#[derive(Debug, Default)]
pub(crate) struct Outline {
    /// The outermost crossing of each edge, by its inner and its outer end.
    crossings: FxHashMap<[u32; 2], Crossing>,
    /// Whether the tool touched each vertex. Vertices behind the last were not touched.
    is_touched: Vec<bool>,
    /// Distance of the vertices on either side, model units.
    beside: f64,
    /// Edges that are not split, because the surface would cross itself there.
    forgotten: FxHashSet<[u32; 2]>,
}

/// The vertices that a split of the outline inserted.
#[derive(Debug)]
pub(crate) struct OutlineSplit {
    /// The first of them.
    first: usize,
    /// The edges of the vertices on the outline, the inner end first.
    edges: Vec<[u32; 2]>,
    /// The cuts of the vertices at the foot of walls, from a touched vertex to one on the outline.
    feet: Vec<Cut>,
}

impl OutlineSplit {
    /// Number of inserted vertices.
    pub(crate) fn inserted(&self) -> usize {
        self.edges.len() + self.feet.len()
    }

    /// The edge whose split inserted a vertex.
    fn edge_of(&self, vertex: u32) -> Option<[u32; 2]> {
        let index = (vertex as usize).checked_sub(self.first)?;
        match self.edges.get(index) {
            Some(&edge) => Some(edge),
            None => self.edge_of(self.feet.get(index - self.edges.len())?.ends[1]),
        }
    }
}

/// Where edges leave the tool at the end of one step.
#[derive(Debug)]
pub(super) struct Contact {
    /// By the ends of the edge, the one inside the tool first.
    crossings: Vec<([u32; 2], Crossing)>,
    /// The vertices inside the tool.
    touched: Vec<u32>,
    beside: f64,
    /// Evaluations of the distance.
    pub(super) evaluations: u64,
}

impl Contact {
    /// Of a step that has not moved `mesh` yet.
    pub(super) fn of(mesh: &Tessellation, motion: &StepMotion<'_>) -> Self {
        let beside = BESIDE * motion.relief;
        let near = Near::of(&mesh.image, motion.tool, &motion.end);
        let mut distances = vec![f64::NAN; mesh.image.len()];
        for (&vertex, &distance) in near.vertices.iter().zip(&near.distances) {
            distances[vertex as usize] = distance;
        }
        let is_inside = |vertex: u32| distances[vertex as usize] < -motion.rounding;
        let is_outside = |vertex: u32| distances[vertex as usize] > beside;
        let mut edges = Vec::new();
        for &[a, b, c] in &mesh.triangles {
            let sides = [[a, b], [b, c], [c, a], [b, a], [c, b], [a, c]];
            edges.extend(sides.into_iter().filter(|&[inner, outer]| is_inside(inner) && is_outside(outer)));
        }
        edges.sort_unstable();
        edges.dedup();
        let leaving = |&[inner, outer]: &[u32; 2]| {
            let [from, to] = [inner, outer].map(|end| motion.end.to_local(mesh.image[end as usize]));
            LeavingEdge { from, to, distance: distances[inner as usize] }
        };
        let (found, evaluations) = crossings(motion, &edges.iter().map(leaving).collect::<Vec<_>>(), beside);
        Self {
            crossings: edges.into_iter().zip(found).collect(),
            touched: near.vertices.into_iter().filter(|&vertex| is_inside(vertex)).collect(),
            beside,
            evaluations: near.evaluations + evaluations,
        }
    }
}

impl Outline {
    /// Adds the contact of one more step.
    pub(super) fn add(&mut self, contact: &Contact) {
        self.beside = contact.beside;
        for &(ends, crossing) in &contact.crossings {
            let known = self.crossings.entry(ends).or_insert(crossing);
            if crossing.fraction >= known.fraction - SAME {
                *known = crossing;
            }
        }
        for &vertex in &contact.touched {
            let count = self.is_touched.len().max(vertex as usize + 1);
            self.is_touched.resize(count, false);
            self.is_touched[vertex as usize] = true;
        }
    }

    /// Puts the vertices of a pressed mesh back to `start`, the images of the first vertices before the
    /// press, and splits the edges on the outline. Returns the inserted vertices; `None` if no edge needs a
    /// split, or if the splits would exceed the limit on triangles.
    pub(crate) fn split(&self, mesh: &mut Tessellation, start: &[DVec3], criteria: &Criteria) -> Option<OutlineSplit> {
        let pressed = mesh.image.clone();
        mesh.restart_from(start);
        let first = mesh.image.len();
        let is_wall = |[a, b]: &[u32; 2], crossing: &mut Crossing| {
            let [before, after] = [&mesh.image, &pressed].map(|image| image[*a as usize].distance(image[*b as usize]));
            after > WALL_STRETCH * before
                && crossing.gradient.dot(crossing.motion).abs() <= WALL_SLOPE
                && ON_WALL.contains(&crossing.fraction)
        };
        let mut walls = self.final_crossings(mesh);
        walls.retain(is_wall);
        let cuts = split_at(mesh, criteria, |ends| walls.get(&ends).map(|crossing| crossing.fraction))?;
        let image = mesh.image.clone();
        let foot = |[touched, vertex]: [u32; 2]| {
            let cut = cuts.get((vertex as usize).checked_sub(first)?)?;
            let slope = walls[&cut.ends].gradient.dot(image[vertex as usize] - image[touched as usize]);
            let fraction = 1.0 - 2.0 * self.beside / slope;
            (self.is_touched(touched) && slope > 0.0 && fraction > ON_WALL.start).then_some(fraction)
        };
        let feet = split_at(mesh, criteria, foot).unwrap_or_default();
        Some(OutlineSplit { first, edges: cuts.iter().map(|cut| cut.ends).collect(), feet })
    }

    /// Forgets the edges whose split made one of `vertices`. Returns whether there were any.
    pub(crate) fn forget(&mut self, split: &OutlineSplit, vertices: impl Iterator<Item = u32>) -> bool {
        let mut has_forgotten = false;
        for vertex in vertices {
            has_forgotten |= split.edge_of(vertex).is_some_and(|edge| self.forgotten.insert(edge));
        }
        has_forgotten
    }

    fn is_touched(&self, vertex: u32) -> bool {
        self.is_touched.get(vertex as usize) == Some(&true)
    }

    /// The crossings of the final outline, by the ends of the edges of `mesh`.
    ///
    /// An edge may have been split after its crossing was found; then the part with the crossing counts.
    /// A crossing whose outer end was touched later is inside the final contact.
    fn final_crossings(&self, mesh: &Tessellation) -> FxHashMap<[u32; 2], Crossing> {
        let first_inserted = mesh.rest.len() - mesh.origins.len();
        let mut inserted = FxHashMap::default();
        for (vertex, cut) in (first_inserted as u32..).zip(&mesh.origins) {
            let [a, b] = cut.ends;
            inserted.insert(cut.ends, (vertex, cut.fraction));
            inserted.insert([b, a], (vertex, 1.0 - cut.fraction));
        }
        let mut cuts = FxHashMap::default();
        for (&(mut ends), &(mut crossing)) in &self.crossings {
            while let Some(&(vertex, at)) = inserted.get(&ends) {
                if crossing.fraction <= at {
                    (ends[1], crossing.fraction) = (vertex, crossing.fraction / at);
                } else {
                    (ends[0], crossing.fraction) = (vertex, (crossing.fraction - at) / (1.0 - at));
                }
            }
            if !self.is_touched(ends[1]) && !self.forgotten.contains(&ends) {
                let known = cuts.entry(ends).or_insert(crossing);
                if crossing.fraction > known.fraction {
                    *known = crossing;
                }
            }
        }
        cuts
    }
}

/// Splits the edges of a frozen mesh for which `fraction_of` the ends, in either order, is not `None`.
/// Returns the cuts in the order of the new vertices, or `None` if there are none or too many.
fn split_at(
    mesh: &mut Tessellation,
    criteria: &Criteria,
    fraction_of: impl Fn([u32; 2]) -> Option<f64>,
) -> Option<Vec<Cut>> {
    let mut chosen = ChosenEdges::default();
    for half_edge in 0..3 * mesh.triangles.len() {
        let triangle = mesh.triangles[half_edge / 3];
        let [a, b] = [triangle[half_edge % 3], triangle[(half_edge + 1) % 3]];
        for ends in [[a, b], [b, a]] {
            if let Some(fraction) = fraction_of(ends) {
                chosen.choose_at(mesh, half_edge as u32, Cut { ends, fraction });
            }
        }
    }
    mesh.move_followed_to_base();
    if chosen.half_edges().is_empty() || mesh.triangles.len() + chosen.added() > criteria.max_triangles() {
        mesh.freeze();
        return None;
    }
    mesh.split(&chosen);
    mesh.freeze();
    Some(chosen.cuts().to_vec())
}
