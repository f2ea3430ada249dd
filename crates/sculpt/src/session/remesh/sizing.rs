//! Target lengths of edges, by vertex of the surface before the remesh.

use std::{cmp::Reverse, collections::BinaryHeap};

use glam::DVec3;
use isochore_mesh::{NONE, next_half_edge, previous_half_edge};
use rayon::prelude::*;

use super::{
    change::SLIVER,
    collapses::SHORT,
    reference::Reference,
    remesher::Remesher,
    shape::{area_normal, smallest_sine2},
};

/// Ratio of the height of an arc over its chord to the allowed deviation, for edges of the target
/// length. Larger: edges have to be split or kept because triangles deviate too much. Smaller: more
/// triangles than the deviation asks for.
const CHORD: f64 = 0.6;

/// Area of an equilateral triangle with sides of length one.
const REGULAR: f64 = 0.433_012_701_892_219_3;

/// Vertices that the search for a flat neighborhood visits. Larger: slower on dense scans. Smaller:
/// one remesh cannot coarsen them as much.
const MOST_VISITED: usize = 400;

/// Factor by which an edge may exceed the neighborhood that was searched. Larger: features farther
/// away are found only when edits are refused. Smaller: slower coarsening of plane regions.
const BEYOND: f64 = 2.0;

/// Edges of a line, on either side of a vertex, that the search for a straight part visits; see
/// [`MOST_VISITED`].
const MOST_LINE_STEPS: usize = 12;

/// Shortest target length as a multiple of the allowed deviation. Larger: details of that size are
/// lost. Smaller: edges are made that the deviation does not need.
const SHORTEST: f64 = 2.0;

/// Change of the target length per distance. Larger: thin triangles where the length changes.
/// Smaller: more triangles.
const GRADATION: f64 = 0.3;

/// Vertices that one task examines. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 256;

/// Target lengths such that flat triangles are within `deviation` of the surface.
pub(super) fn adaptive(reference: &Reference, deviation: f64) -> Vec<f64> {
    let count = reference.positions.len();
    let survey = Survey::new(reference, deviation);
    let mut lengths = vec![0.0; count];
    lengths.par_chunks_mut(CHUNK).enumerate().for_each_init(
        || Scratch { seen_by: vec![0; count], ..Scratch::default() },
        |scratch, (chunk, lengths)| {
            for (index, length) in lengths.iter_mut().enumerate() {
                *length = survey.length_at((chunk * CHUNK + index) as u32, scratch);
            }
        },
    );
    grade(reference, &mut lengths);
    lengths
}

/// Shortest target length, relative to the first one, at edges that cannot be collapsed. Larger: thin
/// triangles remain there. Smaller: a single short edge makes many small triangles.
const LEAST_FRACTION: f64 = 0.35;

impl Remesher<'_> {
    /// Reduces target lengths at thin triangles with a short edge that cannot be collapsed, so that
    /// their other edges become shorter as well.
    pub(super) fn shorten_targets(&mut self) {
        let topology = &self.surface.topology;
        let mut has_changed = false;
        for triangle in self.alive() {
            let Some(corners) = self.surface.corners_of(triangle) else { continue };
            if smallest_sine2(&corners) >= SLIVER {
                continue;
            }
            let length = |edge: u32| {
                self.surface.position(topology.start(edge)).distance(self.surface.position(topology.end(edge)))
            };
            let shortest = (3 * triangle..3 * triangle + 3)
                .map(|edge| (length(edge), edge))
                .reduce(|best, other| if other.0 < best.0 { other } else { best });
            let Some((shortest, _)) = shortest.filter(|&(_, edge)| self.ratio(edge) < SHORT) else { continue };
            let anchor = self.anchors[triangle as usize] as usize;
            for vertex in self.reference.triangles[anchor].vertices {
                let known = &mut self.reference_lengths[vertex as usize];
                let target = shortest.max(LEAST_FRACTION * self.first_lengths[vertex as usize]);
                if target < *known {
                    *known = target;
                    has_changed = true;
                }
            }
        }
        if !has_changed {
            return;
        }
        grade(&self.reference, &mut self.reference_lengths);
        for vertex in 0..self.lengths.len() as u32 {
            let outgoing = topology.outgoing(vertex);
            if outgoing != NONE {
                let foot = self.reference.foot(self.anchors[outgoing as usize / 3], self.surface.position(vertex));
                self.lengths[vertex as usize] = self.reference.interpolate(&self.reference_lengths, &foot);
            }
        }
    }
}

/// Reduces lengths until they change by at most [`GRADATION`] times the distance along edges.
fn grade(reference: &Reference, lengths: &mut [f64]) {
    // Lengths are positive, so that the order of their bits is the order of the numbers.
    let mut pending: BinaryHeap<Reverse<(u64, u32)>> =
        lengths.iter().zip(0..).map(|(length, vertex)| Reverse((length.to_bits(), vertex))).collect();
    while let Some(Reverse((bits, vertex))) = pending.pop() {
        let length = f64::from_bits(bits);
        if length > lengths[vertex as usize] {
            continue;
        }
        for &half_edge in reference.outgoing(vertex) {
            let [_, one, other] = vertices_from(reference, half_edge);
            for neighbor in [one, other] {
                let distance = reference.positions[vertex as usize].distance(reference.positions[neighbor as usize]);
                let most = length + GRADATION * distance;
                if most < lengths[neighbor as usize] {
                    lengths[neighbor as usize] = most;
                    pending.push(Reverse((most.to_bits(), neighbor)));
                }
            }
        }
    }
}

/// Vertices of the triangle of a half-edge, starting with its own start.
fn vertices_from(reference: &Reference, half_edge: u32) -> [u32; 3] {
    let triangle = &reference.triangles[half_edge as usize / 3];
    let side = half_edge as usize % 3;
    [0, 1, 2].map(|step| triangle.vertices[(side + step) % 3])
}

/// Search for the size of flat neighborhoods.
struct Survey<'a> {
    reference: &'a Reference,
    deviation: f64,
    /// Area normals of the vertices; zero on lines, where the normal is ambiguous.
    normals: Vec<DVec3>,
    is_on_line: Vec<bool>,
}

#[derive(Default)]
struct Scratch {
    /// The last search, from one, that has visited a vertex.
    seen_by: Vec<u32>,
    search: u32,
    visited: Vec<u32>,
}

impl<'a> Survey<'a> {
    fn new(reference: &'a Reference, deviation: f64) -> Self {
        let mut is_on_line = vec![false; reference.positions.len()];
        let mut normals = vec![DVec3::ZERO; reference.positions.len()];
        for (triangle, record) in (0..).zip(&reference.triangles) {
            let normal = area_normal(&reference.corners_of(triangle));
            record.vertices.iter().for_each(|&vertex| normals[vertex as usize] += normal);
            for side in 0..3 {
                if reference.lines.is_line(3 * triangle + side as u32) {
                    is_on_line[record.vertices[side] as usize] = true;
                    is_on_line[record.vertices[(side + 1) % 3] as usize] = true;
                }
            }
        }
        normals
            .iter_mut()
            .zip(&is_on_line)
            .filter(|(_, on_line)| **on_line)
            .for_each(|(normal, _)| *normal = DVec3::ZERO);
        Self { reference, deviation, normals, is_on_line }
    }

    fn length_at(&self, vertex: u32, scratch: &mut Scratch) -> f64 {
        let outgoing = self.reference.outgoing(vertex);
        let length = if self.is_on_line[vertex as usize] {
            self.straight_length(vertex)
        } else {
            self.flat_radius(vertex, scratch)
        };
        let area = |&half_edge: &u32| 0.5 * area_normal(&self.reference.corners_of(half_edge / 3)).length();
        let regular = (outgoing.iter().map(area).sum::<f64>() / (REGULAR * outgoing.len() as f64)).sqrt();
        length.max(regular).max(SHORTEST * self.deviation).min(f64::MAX)
    }

    /// The length of a chord of the line through a vertex that is [`CHORD`] deviations away from the
    /// vertex. Infinite at ends and crossings of lines.
    fn straight_length(&self, vertex: u32) -> f64 {
        let positions = &self.reference.positions;
        let center = positions[vertex as usize];
        let [Some(one), Some(other), None] = self.line_neighbors(vertex, vertex) else { return f64::INFINITY };
        let (mut ends, mut last, mut longest) = ([one, other], [vertex; 2], 0.0);
        for step in 0..MOST_LINE_STEPS {
            let [from, to] = ends.map(|end| positions[end as usize]);
            let chord = to - from;
            let length = chord.length();
            let height = (center - from).cross(chord).length() / length;
            let factor = (CHORD * self.deviation / height).sqrt();
            // Also after rounding, and where the line turns back.
            if !(factor >= 1.0 && length > longest) {
                return if length > longest { f64::max(longest, length * factor) } else { longest };
            }
            longest = length;
            if step + 1 == MOST_LINE_STEPS {
                return length * factor.min(BEYOND);
            }
            for side in 0..2 {
                let [Some(next), None, None] = self.line_neighbors(ends[side], last[side]) else {
                    return length * factor.min(BEYOND);
                };
                last[side] = std::mem::replace(&mut ends[side], next);
            }
        }
        longest
    }

    /// Up to three neighbors of a vertex along lines, except `known`.
    fn line_neighbors(&self, vertex: u32, known: u32) -> [Option<u32>; 3] {
        let mut found = [None; 3];
        let mut count = 0;
        for &half_edge in self.reference.outgoing(vertex) {
            let [_, ahead, behind] = vertices_from(self.reference, half_edge);
            for (edge, neighbor) in [(half_edge, ahead), (previous_half_edge(half_edge), behind)] {
                let is_new = neighbor != known && !found.contains(&Some(neighbor));
                if is_new && count < 3 && self.reference.lines.is_line(edge) {
                    found[count] = Some(neighbor);
                    count += 1;
                }
            }
        }
        found
    }

    /// The distance from a vertex at which the surface is 4 [`CHORD`] deviations from its tangent
    /// plane. An edge of this length is [`CHORD`] deviations below an arc that has the same
    /// curvature. Unlike a curvature, it ignores noise that is small compared with the deviation.
    fn flat_radius(&self, vertex: u32, scratch: &mut Scratch) -> f64 {
        let positions = &self.reference.positions;
        let (center, tolerance) = (positions[vertex as usize], 4.0 * CHORD * self.deviation);
        scratch.search += 1;
        scratch.visited.clear();
        scratch.visited.push(vertex);
        scratch.seen_by[vertex as usize] = scratch.search;
        let (mut ring, mut radius, mut normal) = (0, 0.0, DVec3::ZERO);
        loop {
            let end = scratch.visited.len();
            for index in ring..end {
                let inner = scratch.visited[index];
                normal += self.normals[inner as usize];
                if !self.is_on_line[inner as usize] {
                    self.visit_around(inner, scratch);
                }
            }
            let added = scratch.visited.len() - end;
            if added == 0 {
                return BEYOND * radius;
            }
            let distances = scratch.visited[end..].iter().map(|&outer| positions[outer as usize].distance(center));
            let next_radius = distances.sum::<f64>() / added as f64;
            let direction = normal.normalize_or_zero();
            let (mut low, mut high) = (0.0_f64, 0.0_f64);
            for &visited in &scratch.visited {
                let height = direction.dot(positions[visited as usize] - center);
                (low, high) = (low.min(height), high.max(height));
            }
            // Heights grow with the square of the distance.
            let factor = (tolerance / (high - low)).sqrt();
            if factor < 1.0 {
                return radius.max(next_radius * factor);
            }
            radius = radius.max(next_radius);
            if scratch.visited.len() > MOST_VISITED {
                return radius * factor.min(BEYOND);
            }
            ring = end;
        }
    }

    fn visit_around(&self, vertex: u32, scratch: &mut Scratch) {
        for &half_edge in self.reference.outgoing(vertex) {
            for edge in [half_edge, next_half_edge(half_edge)] {
                let [_, other, _] = vertices_from(self.reference, edge);
                let seen_by = &mut scratch.seen_by[other as usize];
                if *seen_by != scratch.search {
                    *seen_by = scratch.search;
                    scratch.visited.push(other);
                }
            }
        }
    }
}
