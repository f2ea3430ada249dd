//! Splitting to a longest edge.
//!
//! The split of an edge depends only on that edge: it is halved until the parts are short enough.
//! The two triangles at an edge therefore agree without communication, and every triangle is split
//! independently and in parallel, without repeated passes over the mesh. A triangle is split into
//! two, three or four parts by the number of its long edges, recursively.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::{Cancelled, MeshError, Monitor, SubTriangle, Subdivision, Topology, TriMesh, TriangleSide, TriangleSplit};

/// Triangles that one task splits. A larger value balances worse and delays cancellation; a smaller
/// one allocates more often.
const CHUNK: usize = 2048;

/// Largest number of times that an edge is halved. More would exceed any limit of triangles.
const MOST_HALVINGS: u32 = 30;

/// Errors when splitting a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SplitError {
    /// An index is out of range or a coordinate not finite.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The longest allowed edge is not a positive finite number.
    #[error("the longest edge must be a positive number, not {0}")]
    Length(f64),
    /// The result would have too many triangles.
    #[error("an edge length of {length} takes more than {limit} triangles")]
    TooManyTriangles {
        /// The longest allowed edge.
        length: f64,
        /// The limit.
        limit: usize,
    },
    /// The monitor cancelled the operation.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The longest edge and the number of triangles that the result may have.
#[derive(Debug, Clone, Copy)]
struct Limits {
    longest: f64,
    triangles: usize,
}

/// A corner of a part of a triangle.
#[derive(Debug, Clone, Copy)]
struct Corner {
    vertex: u32,
    /// Barycentric coordinates in the triangle of the mesh.
    weights: DVec3,
    position: DVec3,
}

/// A section of an edge that is divided into equal parts, a power of two of them. The vertices
/// between the parts are numbered consecutively.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// The vertex at the end of the first part of the whole edge.
    first: u32,
    /// The section runs from the start of part `from` to the start of part `to`, in either
    /// direction.
    from: u32,
    to: u32,
}

/// A part of a triangle that may be split further, with its sides 01, 12 and 20.
#[derive(Debug, Clone, Copy)]
struct Part {
    corners: [Corner; 3],
    sides: [Side; 3],
}

/// Edges of the mesh and the vertices on them.
#[derive(Debug)]
struct SplitEdges {
    topology: Topology,
    /// For each edge, the first of the new vertices on it, ordered from its smaller end. Counted
    /// from the end of the original vertices, with the total as last entry.
    first: Vec<u32>,
    /// The original vertices, then those on edges.
    positions: Vec<DVec3>,
}

/// The parts of some triangles.
#[derive(Debug, Default)]
struct Chunk {
    triangles: Vec<SubTriangle>,
    /// Vertices inside triangles, numbered after those on edges.
    inner: Vec<DVec3>,
}

impl Limits {
    /// An upper bound of the number of vertices.
    #[inline(always)]
    fn vertices(self) -> usize {
        self.triangles.saturating_mul(3).min(u32::MAX as usize)
    }
}

impl TriMesh {
    /// Splits triangles until no edge is longer than `longest`, in model units and up to rounding.
    /// No point of the surface moves.
    ///
    /// Edges are halved until they are short enough. A triangle that is split at two edges gets the
    /// shorter of the two possible diagonals. The result has the same bits for any number of
    /// threads. Peak memory is twice the result, at 88 bytes per triangle and 24 per vertex, plus
    /// 60 bytes per original triangle: about 200 bytes per resulting triangle as measured.
    ///
    /// # Errors
    /// [`SplitError`] if `longest` is not a positive finite number, the mesh is invalid, the result
    /// would have more than `limit` triangles, or the monitor cancels.
    ///
    /// ```
    /// use isochore_mesh::{NoProgress, primitives};
    ///
    /// let ball = primitives::icosphere(1.0, 1);
    /// let split = ball.split_to_length(0.1, 100_000, &NoProgress)?;
    /// let fine = ball.subdivided(&split);
    /// assert!(fine.edge_lengths().unwrap().max <= 0.1 * (1.0 + 1e-12));
    /// assert!((fine.volume() - ball.volume()).abs() < 1e-12);
    /// # Ok::<(), isochore_mesh::SplitError>(())
    /// ```
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
        let limits = Limits { longest, triangles: limit };
        let edges = SplitEdges::new(self, limits).ok_or_else(too_many)?;
        let count = AtomicUsize::new(0);
        let chunks: Vec<Chunk> = (0..self.triangles.len().div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let begin = chunk * CHUNK;
                let end = self.triangles.len().min(begin + CHUNK);
                monitor.check("split", begin as f64 / self.triangles.len() as f64)?;
                self.split_chunk(begin..end, &edges, limits, &count).ok_or_else(too_many)
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

    /// Splits the triangles of `range`. `None` if there would be too many triangles.
    fn split_chunk(
        &self,
        range: std::ops::Range<usize>,
        edges: &SplitEdges,
        limits: Limits,
        count: &AtomicUsize,
    ) -> Option<Chunk> {
        // Reserve by an estimate from the edge lengths, so that the list rarely reallocates.
        let expected: usize = range.clone().map(|triangle| edges.expected_triangles(triangle)).sum();
        let mut chunk = Chunk { triangles: Vec::with_capacity(expected.min(limits.triangles)), inner: Vec::new() };
        let mut pending = Vec::new();
        for triangle in range {
            let whole = edges.part(self, triangle);
            if whole.sides.iter().any(Side::is_long) {
                pending.push(whole)
            } else {
                chunk.triangles.push(finished(whole.corners, triangle as u32))
            }
            while let Some(part) = pending.pop() {
                let midpoints = [0, 1, 2].map(|side| part.midpoint(side, edges, &chunk.inner));
                let split = TriangleSplit { corners: part.corners, sides: part.sides, midpoints };
                let distance_squared = |a: &Corner, b: &Corner| a.position.distance_squared(b.position);
                let inner_side = |a: &Corner, b: &Corner| edges.inner_side(a, b, limits, &mut chunk.inner);
                split.parts(distance_squared, inner_side, |corners, sides| {
                    // Most parts need no further split.
                    if sides.iter().any(Side::is_long) {
                        pending.push(Part { corners, sides })
                    } else {
                        chunk.triangles.push(finished(corners, triangle as u32))
                    }
                })?;
                if chunk.triangles.len() + pending.len() > limits.triangles {
                    return None;
                }
            }
        }
        let counted = chunk.triangles.len();
        (count.fetch_add(counted, Ordering::Relaxed) + counted <= limits.triangles).then_some(chunk)
    }
}

impl SplitEdges {
    /// Splits all edges. `None` if there would be too many triangles.
    fn new(mesh: &TriMesh, limits: Limits) -> Option<Self> {
        let topology = Topology::of(mesh);
        let position = |vertex: u32| mesh.positions[vertex as usize];
        let parts_of = |&[a, b]: &[u32; 2]| parts(position(a), position(b), limits.longest);
        let parts: Vec<Option<u32>> = topology.edges.par_iter().map(parts_of).collect();
        let mut first = Vec::with_capacity(parts.len() + 1);
        let mut next: usize = 0;
        for parts in parts {
            first.push(next as u32);
            next += parts? as usize - 1;
            if next > limits.vertices() {
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

    /// A new edge inside a triangle of the mesh, whose vertices are added to `inner`. `None` if
    /// there would be too many.
    #[inline(always)]
    fn inner_side(&self, a: &Corner, b: &Corner, limits: Limits, inner: &mut Vec<DVec3>) -> Option<Side> {
        let parts = parts(a.position, b.position, limits.longest)?;
        let first = self.positions.len() + inner.len();
        if parts > 1 {
            if first + parts as usize > limits.vertices() {
                return None;
            }
            inner.extend(between(a.position, b.position, parts));
        }
        Some(Side { first: first as u32, from: 0, to: parts })
    }

    /// An estimate of the number of parts of a triangle, exact if its sides have equally many
    /// parts.
    fn expected_triangles(&self, triangle: usize) -> usize {
        let parts = |edge: u32| (self.first[edge as usize + 1] - self.first[edge as usize] + 1) as usize;
        let [a, b, c] = self.topology.triangle_edges(triangle).map(parts);
        let longest = a.max(b).max(c);
        longest.saturating_mul((a + b + c - longest).div_ceil(2))
    }

    /// A whole triangle of the mesh.
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
    /// The midpoint of a side, or `None` if the side is short. `inner` holds the vertices inside
    /// triangles.
    #[inline(always)]
    fn midpoint(&self, side: usize, edges: &SplitEdges, inner: &[DVec3]) -> Option<Corner> {
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
    /// Whether the side must be split.
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

/// A part that is not split further.
#[inline(always)]
fn finished([a, b, c]: [Corner; 3], parent: u32) -> SubTriangle {
    SubTriangle { vertices: [a.vertex, b.vertex, c.vertex], parent, corners: [a.weights, b.weights, c.weights] }
}

/// The number of equal parts into which an edge is halved. `None` beyond [`MOST_HALVINGS`].
#[inline(always)]
fn parts(a: DVec3, b: DVec3, longest: f64) -> Option<u32> {
    let length = a.distance(b);
    let halvings = (0..=MOST_HALVINGS).find(|&halvings| length <= longest * f64::from(1_u32 << halvings))?;
    Some(1 << halvings)
}

/// The points between `parts` equal parts of an edge, where `parts` is a power of two.
#[inline(always)]
fn between(a: DVec3, b: DVec3, parts: u32) -> impl Iterator<Item = DVec3> {
    // The fractions are exact.
    let fraction = move |part: u32| f64::from(part) / f64::from(parts);
    (1..parts).map(move |part| a * (1.0 - fraction(part)) + b * fraction(part))
}

#[cfg(test)]
mod tests;
