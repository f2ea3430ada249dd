//! Splitting to a longest edge.
//!
//! Whether and where an edge is split depends on that edge alone: into halves, until they are short enough. So both triangles at
//! an edge agree without knowing each other, and every triangle is split on its own, in parallel and without rounds over the
//! mesh: into two, three or four by the number of its long edges, and so on.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::{Cancelled, MeshError, Monitor, SubTriangle, Subdivision, Topology, TriMesh, TriangleSide, TriangleSplit};

/// Triangles that one task splits. Larger balances worse and hears a cancellation later; smaller allocates more often.
const CHUNK: usize = 2048;

/// An edge is halved this often at most; more would pass any number of triangles.
const MOST_HALVINGS: u32 = 30;

/// Why a mesh is not split.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SplitError {
    /// An index is out of range or a coordinate not finite.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The longest edge allowed is not a positive number.
    #[error("the longest edge must be a positive number, not {0}")]
    Length(f64),
    /// There would be too many triangles.
    #[error("an edge length of {length} takes more than {limit} triangles")]
    TooManyTriangles {
        /// The longest edge allowed.
        length: f64,
        /// The limit.
        limit: usize,
    },
    /// The monitor stopped the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A corner of a triangle that may be split on.
#[derive(Debug, Clone, Copy)]
struct Corner {
    vertex: u32,
    /// Barycentric coordinates in the triangle of the mesh.
    weights: DVec3,
    position: DVec3,
}

/// A stretch of an edge of equal parts, a power of two of them, between which its vertices are numbered one after the other.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// The vertex behind the first part of the whole edge.
    first: u32,
    /// Numbers of the parts between which it runs, in either direction.
    from: u32,
    to: u32,
}

/// A triangle that may be split on, with its sides 01, 12 and 20.
#[derive(Debug, Clone, Copy)]
struct Part {
    corners: [Corner; 3],
    sides: [Side; 3],
}

/// Edges of the mesh and the vertices on them.
#[derive(Debug)]
struct SplitEdges {
    topology: Topology,
    /// By edge, the first of the vertices on it, from its smaller end on, counted from the mesh's own; then their number.
    first: Vec<u32>,
    /// The vertices of the mesh, then those on its edges.
    positions: Vec<DVec3>,
}

/// What became of some triangles.
#[derive(Debug, Default)]
struct Chunk {
    triangles: Vec<SubTriangle>,
    /// Vertices inside triangles, numbered behind those on edges.
    inner: Vec<DVec3>,
}

impl TriMesh {
    /// Splits triangles until no edge is longer than `longest`, model units, up to rounding. No point of the surface moves.
    ///
    /// Edges are halved until they are short enough. Of the two ways to split a triangle at two of its edges the one with the
    /// shorter diagonal is taken. The result has the same bits for any number of threads. While it works it holds what it
    /// returns twice, 88 bytes a triangle and 24 a vertex each time, and 60 bytes a triangle of the mesh: measured, about 200
    /// bytes for each triangle that there is in the end.
    ///
    /// # Errors
    /// [`SplitError`]; `limit` is the largest number of triangles allowed.
    pub fn split_to_length(
        &self,
        longest: f64,
        limit: usize,
        monitor: &dyn Monitor,
    ) -> Result<Subdivision, SplitError> {
        if !(longest > 0.0 && longest.is_finite()) {
            return Err(SplitError::Length(longest));
        }
        self.check_valid()?;
        let too_many = || SplitError::TooManyTriangles { length: longest, limit };
        let edges = SplitEdges::new(self, longest, limit).ok_or_else(too_many)?;
        let count = AtomicUsize::new(0);
        let chunks: Vec<Chunk> = (0..self.triangles.len().div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let begin = chunk * CHUNK;
                let end = self.triangles.len().min(begin + CHUNK);
                monitor.check("split", begin as f64 / self.triangles.len() as f64)?;
                self.split_chunk(begin..end, &edges, longest, limit, &count).ok_or_else(too_many)
            })
            .collect::<Result<_, SplitError>>()?;

        let mut subdivision = Subdivision { positions: edges.positions, triangles: Vec::new() };
        let outer = subdivision.positions.len();
        let total = outer + chunks.iter().map(|chunk| chunk.inner.len()).sum::<usize>();
        if total > u32::MAX as usize {
            return Err(too_many());
        }
        subdivision.positions.reserve_exact(total - outer);
        subdivision.triangles.reserve_exact(count.into_inner());
        for chunk in chunks {
            let shift = (subdivision.positions.len() - outer) as u32;
            let shifted = |vertex: u32| if vertex as usize >= outer { vertex + shift } else { vertex };
            subdivision.triangles.extend(
                (chunk.triangles.iter()).map(|part| SubTriangle { vertices: part.vertices.map(shifted), ..*part }),
            );
            subdivision.positions.extend_from_slice(&chunk.inner);
        }
        Ok(subdivision)
    }

    /// None when there would be too many triangles.
    fn split_chunk(
        &self,
        range: std::ops::Range<usize>,
        edges: &SplitEdges,
        longest: f64,
        limit: usize,
        count: &AtomicUsize,
    ) -> Option<Chunk> {
        // What the lengths of the edges let expect, so that little is moved.
        let expected: usize = range.clone().map(|triangle| edges.expected_triangles(triangle)).sum();
        let mut chunk = Chunk { triangles: Vec::with_capacity(expected.min(limit)), inner: Vec::new() };
        let mut pending = Vec::new();
        for triangle in range {
            let whole = edges.part(self, triangle);
            match whole.sides.iter().any(Side::is_long) {
                true => pending.push(whole),
                false => chunk.triangles.push(finished(whole.corners, triangle as u32)),
            }
            while let Some(part) = pending.pop() {
                let middles = [0, 1, 2].map(|side| part.middle(side, edges, &chunk.inner));
                let split = TriangleSplit { corners: part.corners, sides: part.sides, middles };
                let distance_squared = |a: &Corner, b: &Corner| a.position.distance_squared(b.position);
                let inner_side = |a: &Corner, b: &Corner| edges.inner_side(a, b, longest, limit, &mut chunk.inner);
                split.parts(distance_squared, inner_side, |corners, sides| {
                    // Most parts are done at once.
                    match sides.iter().any(Side::is_long) {
                        true => pending.push(Part { corners, sides }),
                        false => chunk.triangles.push(finished(corners, triangle as u32)),
                    }
                })?;
                if chunk.triangles.len() + pending.len() > limit {
                    return None;
                }
            }
        }
        let counted = chunk.triangles.len();
        (count.fetch_add(counted, Ordering::Relaxed) + counted <= limit).then_some(chunk)
    }
}

impl SplitEdges {
    /// None when there would be too many triangles.
    fn new(mesh: &TriMesh, longest: f64, limit: usize) -> Option<Self> {
        let topology = Topology::of(mesh);
        let parts_of = |&[a, b]: &[u32; 2]| parts(mesh.positions[a as usize], mesh.positions[b as usize], longest);
        let parts: Vec<Option<u32>> = topology.edges.par_iter().map(parts_of).collect();
        let mut first = Vec::with_capacity(parts.len() + 1);
        let mut next: usize = 0;
        for parts in parts {
            first.push(next as u32);
            next += parts? as usize - 1;
            if next > limit.saturating_mul(3).min(u32::MAX as usize) {
                return None;
            }
        }
        first.push(next as u32);
        let mut positions = Vec::with_capacity(mesh.positions.len() + next);
        positions.extend_from_slice(&mesh.positions);
        for (edge, &[a, b]) in topology.edges.iter().enumerate() {
            let parts = first[edge + 1] - first[edge] + 1;
            positions.extend(between(mesh.positions[a as usize], mesh.positions[b as usize], parts));
        }
        Some(Self { topology, first, positions })
    }

    /// A new edge inside a triangle of the mesh, its vertices added to `inner`. None when there would be too many.
    #[inline(always)]
    fn inner_side(&self, a: &Corner, b: &Corner, longest: f64, limit: usize, inner: &mut Vec<DVec3>) -> Option<Side> {
        let parts = parts(a.position, b.position, longest)?;
        let first = self.positions.len() + inner.len();
        if parts > 1 {
            if first + parts as usize > limit.saturating_mul(3).min(u32::MAX as usize) {
                return None;
            }
            inner.extend(between(a.position, b.position, parts));
        }
        Some(Side { first: first as u32, from: 0, to: parts })
    }

    /// About the number of triangles that one of the mesh is split into: exact where all its sides have the same parts.
    fn expected_triangles(&self, triangle: usize) -> usize {
        let parts = |edge: u32| (self.first[edge as usize + 1] - self.first[edge as usize] + 1) as usize;
        let [a, b, c] = self.topology.triangle_edges(triangle).map(parts);
        let longest = a.max(b).max(c);
        longest.saturating_mul((a + b + c - longest).div_ceil(2))
    }

    /// A triangle of the mesh, whole.
    fn part(&self, mesh: &TriMesh, triangle: usize) -> Part {
        let vertices = mesh.triangles[triangle];
        let position = |corner: usize| mesh.positions[vertices[corner] as usize];
        let corner = |corner: usize, weights| Corner { vertex: vertices[corner], weights, position: position(corner) };
        let edges = self.topology.triangle_edges(triangle);
        let side = |side: usize| {
            let edge = edges[side] as usize;
            let whole = Side {
                first: mesh.positions.len() as u32 + self.first[edge],
                from: 0,
                to: self.first[edge + 1] - self.first[edge] + 1,
            };
            if vertices[side] <= vertices[(side + 1) % 3] { whole } else { whole.reversed() }
        };
        Part {
            corners: [corner(0, DVec3::X), corner(1, DVec3::Y), corner(2, DVec3::Z)],
            sides: [side(0), side(1), side(2)],
        }
    }
}

impl Part {
    /// The middle of a side, if that is to be split. `inner` are the vertices inside triangles.
    #[inline(always)]
    fn middle(&self, side: usize, edges: &SplitEdges, inner: &[DVec3]) -> Option<Corner> {
        let Side { first, from, to } = self.sides[side];
        if !self.sides[side].is_long() {
            return None;
        }
        let vertex = first + (from + to) / 2 - 1;
        let position = match (vertex as usize).checked_sub(edges.positions.len()) {
            None => edges.positions[vertex as usize],
            Some(index) => inner[index],
        };
        let weights = 0.5 * (self.corners[side].weights + self.corners[(side + 1) % 3].weights);
        Some(Corner { vertex, weights, position })
    }
}

impl Side {
    /// Whether it is to be split.
    #[inline(always)]
    fn is_long(&self) -> bool {
        self.from.abs_diff(self.to) > 1
    }
}

impl TriangleSide for Side {
    #[inline(always)]
    fn first(self) -> Self {
        Self { to: (self.from + self.to) / 2, ..self }
    }

    #[inline(always)]
    fn second(self) -> Self {
        Self { from: (self.from + self.to) / 2, ..self }
    }

    #[inline(always)]
    fn reversed(self) -> Self {
        Self { from: self.to, to: self.from, ..self }
    }
}

/// A triangle that is not split on.
#[inline(always)]
fn finished([a, b, c]: [Corner; 3], parent: u32) -> SubTriangle {
    SubTriangle { vertices: [a.vertex, b.vertex, c.vertex], parent, corners: [a.weights, b.weights, c.weights] }
}

/// The equal parts into which an edge is halved until they are short enough; none beyond [`MOST_HALVINGS`].
#[inline(always)]
fn parts(a: DVec3, b: DVec3, longest: f64) -> Option<u32> {
    let length = a.distance(b);
    let halvings = (0..=MOST_HALVINGS).find(|&halvings| length <= longest * f64::from(1_u32 << halvings))?;
    Some(1 << halvings)
}

/// The points between this power of two of equal parts of an edge.
#[inline(always)]
fn between(a: DVec3, b: DVec3, parts: u32) -> impl Iterator<Item = DVec3> {
    // The shares are exact.
    let share = move |part: u32| f64::from(part) / f64::from(parts);
    (1..parts).map(move |part| a * (1.0 - share(part)) + b * share(part))
}

#[cfg(test)]
mod tests;
