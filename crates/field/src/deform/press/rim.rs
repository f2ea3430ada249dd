//! The rim: the vertices that are raised around the contact, and their directions.
//!
//! A vertex at distance d from the tool, u = d/R, is raised along its normal in proportion to the bump
//! 16 u² (1−u)². The bump is zero at the tool and at the end of its support. Only the struck side is
//! raised: the vertices that are connected to the contact and whose normals face the same side as the
//! normal of the contact.

use glam::DVec3;
use petgraph::unionfind::UnionFind;
use rustc_hash::FxHashMap;

use super::{contact::Near, step_motion::StepMotion};

/// Directions in which vertices are raised.
#[derive(Debug)]
pub(super) struct Rim {
    /// One for each vertex; the longest is about one.
    pub(super) directions: Vec<DVec3>,
    /// Whether the tool meets the surface from both sides.
    pub(super) is_through: bool,
}

/// Cosine of the angle between the normals of a vertex and the contact at which the vertex is raised
/// fully; the rise fades to zero at a right angle. A larger value lowers the rim on round bodies; a
/// smaller value makes a crease at the end of the rim.
const FACING: f64 = 0.5;

/// Least fraction of the dented area, projected along the normals of the tool, that is struck from the
/// far side when the tool goes through a sheet. A larger value misses sheets of uneven thickness; a
/// smaller value mistakes rough surfaces for sheets.
const FAR_SIDE: f64 = 0.1;

/// Vertices that are closer to each other than this, in units of the relief, are raised alike. Their normals
/// differ as much as those of vertices farther apart, which would fold the triangles between them. A larger
/// value makes facets; a smaller value takes shorter steps.
const SHORT: f64 = 0.1;

/// Marks a vertex that is not near the tool.
const NONE: u32 = u32::MAX;

impl Rim {
    pub(super) fn new(positions: &[DVec3], triangles: &[[u32; 3]], near: &Near, motion: &StepMotion<'_>) -> Self {
        let mut near_index = vec![NONE; positions.len()];
        for (index, &vertex) in (0..).zip(&near.vertices) {
            near_index[vertex as usize] = index;
        }
        let near_indices = |triangle: &[u32; 3]| triangle.map(|vertex| near_index[vertex as usize]);
        let around = || triangles.iter().filter(|triangle| near_indices(triangle) != [NONE; 3]);

        let mut normals = vec![DVec3::ZERO; near.vertices.len()];
        for triangle in around() {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            let normal = (b - a).cross(c - a);
            for index in near_indices(triangle).into_iter().filter(|&index| index != NONE) {
                normals[index as usize] += normal;
            }
        }
        let is_contact = |index: usize| near.distances[index].abs() <= motion.rounding;
        let toward = (0..normals.len()).filter(|&index| is_contact(index)).map(|index| normals[index]).sum::<DVec3>();
        let toward = toward.normalize_or_zero();
        let mut areas = [0.0; 2];
        for &index in &near.dented {
            let area = normals[index as usize].dot(near.gradients[index as usize].normalize_or_zero());
            areas[usize::from(area > 0.0)] += area.abs();
        }
        let is_through = areas[0].min(areas[1]) > FAR_SIDE * (areas[0] + areas[1]);
        normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());

        // A tool that is enclosed by the surface has no struck side. Then the whole connected part is raised.
        let facing = |index: usize| if toward == DVec3::ZERO { 1.0 } else { normals[index].dot(toward) };
        let support = motion.tool.support();
        let is_eligible: Vec<bool> = (0..normals.len())
            .map(|index| is_contact(index) || (near.distances[index] < support && facing(index) > 0.0))
            .collect();
        let mut components = UnionFind::<u32>::new(normals.len());
        for triangle in around() {
            let [a, b, c] = near_indices(triangle);
            for (a, b) in [(a, b), (b, c), (c, a)] {
                if a != NONE && b != NONE && is_eligible[a as usize] && is_eligible[b as usize] {
                    components.union(a, b);
                }
            }
        }
        let mut is_struck = vec![false; normals.len()];
        for index in (0..normals.len()).filter(|&index| is_contact(index)) {
            is_struck[components.find_mut(index as u32) as usize] = true;
        }
        let mut raised = vec![DVec3::ZERO; normals.len()];
        for (index, raised) in raised.iter_mut().enumerate() {
            if is_eligible[index] && is_struck[components.find_mut(index as u32) as usize] {
                let weight = bump(near.distances[index] / support) * fade(facing(index) / FACING);
                *raised = weight * normals[index];
            }
        }
        let short = SHORT * motion.relief;
        let sides = around().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let is_short = |[a, b]: &[u32; 2]| positions[*a as usize].distance(positions[*b as usize]) < short;
        let short_edges = sides.filter(is_short).map(|edge| edge.map(|vertex| near_index[vertex as usize]));
        average_over(&mut raised, short_edges.filter(|edge| !edge.contains(&NONE)));
        let mut directions = vec![DVec3::ZERO; positions.len()];
        for (&vertex, direction) in near.vertices.iter().zip(raised) {
            directions[vertex as usize] = direction;
        }
        Self { directions, is_through }
    }
}

/// Gives all vertices that are connected by `edges` the mean of their directions.
fn average_over(directions: &mut [DVec3], edges: impl Iterator<Item = [u32; 2]>) {
    let mut clusters = UnionFind::<u32>::new(directions.len());
    let mut connected = Vec::new();
    for [a, b] in edges {
        clusters.union(a, b);
        connected.extend([a, b]);
    }
    connected.sort_unstable();
    connected.dedup();
    let mut sums: FxHashMap<u32, (DVec3, f64)> = FxHashMap::default();
    for &vertex in &connected {
        let (sum, count) = sums.entry(clusters.find_mut(vertex)).or_default();
        *sum += directions[vertex as usize];
        *count += 1.0;
    }
    for &vertex in &connected {
        let (sum, count) = sums[&clusters.find_mut(vertex)];
        directions[vertex as usize] = sum / count;
    }
}

/// 16 u² (1−u)²: one at half the support, with zero value and slope at both ends.
fn bump(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    16.0 * (u * (1.0 - u)) * (u * (1.0 - u))
}

/// Smooth step from zero at 0 to one at 1, with zero slope at both.
fn fade(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
