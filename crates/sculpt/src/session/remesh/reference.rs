//! The surface before a remesh, to which the present surface is compared.

use glam::DVec3;
use isochore_mesh::{EditTriangle, Foot, NONE, Origin, SurfaceWalk, TriMesh};

use super::{lines::Lines, shape::area_normal};
use crate::session::{
    origin::{blended_origin, nearest_weights},
    surface::Surface,
};

/// Height of an edge over its surroundings, relative to the allowed distance, from which on samples
/// watch it. Larger: ridges may be cut off between samples. Smaller: more samples on curved parts.
const DENSITY: f64 = 0.25;

/// Largest number of pieces into which its height alone divides an edge. Larger: more samples on
/// rough parts. Smaller: ridges may be cut off between samples.
const MOST_PIECES: f64 = 4.0;

/// Part of the square of the allowed distance up to which the middle of an edge shows that all of it
/// is near. Larger: edges between rough parts of the surface could be farther away elsewhere.
/// Smaller: slower.
const CERTAIN: f64 = 0.1;

/// Largest number of pieces into which samples divide an edge. Larger: more memory if a coarse mesh
/// is refined a lot. Smaller: its edges are watched at fewer points.
const MOST_SAMPLES: f64 = 256.0;

/// A copy of the part of a surface that is remeshed. Triangles and vertices are numbered from zero.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    pub(super) triangles: Vec<EditTriangle>,
    pub(super) positions: Vec<DVec3>,
    /// Unit normals of the triangles; zero without area.
    pub(super) normals: Vec<DVec3>,
    pub(super) lines: Lines,
    /// Triangles of the mesh as opened, by triangle.
    pub(super) parents: Vec<u32>,
    /// Entries of `origins`, by corner.
    corners: Vec<[u32; 3]>,
    origins: Vec<Option<Origin>>,
    /// For each vertex, the vertex of the surface.
    pub(super) vertices: Vec<u32>,
    /// Outgoing half-edges of each vertex, one range after the other.
    outgoing: Vec<u32>,
    /// Start of the range of each vertex, and the total.
    starts: Vec<u32>,
}

impl Reference {
    /// Copies the triangles `region`, all of which exist.
    pub(super) fn new(surface: &Surface, region: &[u32], deviation: f64) -> Self {
        let records = surface.topology.triangles();
        let mut of_triangle = vec![NONE; records.len()];
        for (index, &triangle) in region.iter().enumerate() {
            of_triangle[triangle as usize] = index as u32;
        }
        let mut vertices = Numbering::new(surface.positions.items().len());
        let mut renders = Numbering::new(surface.render.items().len());
        let mut triangles = Vec::with_capacity(region.len());
        let mut corners = Vec::with_capacity(region.len());
        for &triangle in region {
            let record = &records[triangle as usize];
            let twins = record.twins.map(|twin| match twin {
                NONE => NONE,
                twin => match of_triangle[twin as usize / 3] {
                    NONE => NONE,
                    beyond => 3 * beyond + twin % 3,
                },
            });
            triangles.push(EditTriangle { vertices: record.vertices.map(|vertex| vertices.number(vertex)), twins });
            corners.push(surface.corners.get(triangle).map(|render| renders.number(render)));
        }
        let positions: Vec<DVec3> = vertices.items.iter().map(|&vertex| surface.position(vertex)).collect();
        let of = |triangle: &EditTriangle| area_normal(&triangle.vertices.map(|vertex| positions[vertex as usize]));
        let normals: Vec<DVec3> = triangles.iter().map(|triangle| of(triangle).normalize_or_zero()).collect();
        let (starts, outgoing) = outgoing(&triangles, positions.len());
        let mut reference = Self {
            parents: region.iter().map(|&triangle| surface.patches.get(triangle).parent).collect(),
            origins: renders.items.iter().map(|&render| surface.render.get(render).origin).collect(),
            vertices: vertices.items,
            triangles,
            positions,
            normals,
            lines: Lines(vec![0; region.len()]),
            corners,
            outgoing,
            starts,
        };
        reference.lines = reference.find_lines(surface, region, deviation);
        reference
    }

    /// The nearest point, searched from triangle `start` without crossing a line.
    #[inline]
    pub(super) fn foot(&self, start: u32, point: DVec3) -> Foot {
        SurfaceWalk::new(&self.triangles, &self.positions)
            .nearest(start, point, |half_edge| self.lines.is_line(half_edge))
    }

    /// Whether a segment is near this surface: its middle, and points between if that is not very
    /// near. `most` is the square of the allowed distance.
    pub(super) fn is_near(&self, start: u32, [a, b]: [DVec3; 2], most: f64) -> bool {
        let foot = self.foot(start, 0.5 * (a + b));
        let is_within = |fraction: f64| self.foot(foot.triangle, a.lerp(b, fraction)).squared <= most;
        foot.squared <= CERTAIN * most || (foot.squared <= most && is_within(0.25) && is_within(0.75))
    }

    /// Positions of the corners of a triangle.
    #[inline]
    pub(super) fn corners_of(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].vertices.map(|vertex| self.positions[vertex as usize])
    }

    /// Outgoing half-edges of a vertex.
    pub(super) fn outgoing(&self, vertex: u32) -> &[u32] {
        let [start, end] = [vertex, vertex + 1].map(|index| self.starts[index as usize] as usize);
        &self.outgoing[start..end]
    }

    /// The point of the mesh as opened from which attributes at a point of this surface are taken.
    pub(super) fn origin(&self, opened: &TriMesh, foot: &Foot) -> Option<Origin> {
        let weights = nearest_weights(foot.point, &self.corners_of(foot.triangle));
        let [a, b, c] = self.corners[foot.triangle as usize].map(|corner| self.origins[corner as usize]);
        Some(blended_origin(opened, [a?, b?, c?], weights, self.parents[foot.triangle as usize]))
    }

    /// Points that a remesh must stay near, each with its triangle: all vertices, and points along
    /// edges that are not flat. `lengths` are target lengths by vertex.
    pub(super) fn samples(&self, lengths: &[f64], deviation: f64) -> Vec<(DVec3, u32)> {
        let with_triangles = (0..self.positions.len() as u32).filter(|&vertex| !self.outgoing(vertex).is_empty());
        let mut samples: Vec<(DVec3, u32)> =
            with_triangles.map(|vertex| (self.positions[vertex as usize], self.outgoing(vertex)[0] / 3)).collect();
        for half_edge in 0..3 * self.triangles.len() as u32 {
            let (triangle, side) = (half_edge as usize / 3, half_edge as usize % 3);
            let twin = self.triangles[triangle].twins[side];
            if twin != NONE && twin < half_edge {
                continue;
            }
            let ends = [side, (side + 1) % 3].map(|corner| self.triangles[triangle].vertices[corner] as usize);
            let [a, b] = ends.map(|end| self.positions[end]);
            let length = a.distance(b);
            let height = match twin {
                NONE => length,
                // Over an edge of the same length that crosses it in the middle.
                twin => 0.25 * length * self.normals[triangle].cross(self.normals[twin as usize / 3]).length(),
            } / (DENSITY * deviation);
            if height < 1.0 {
                continue;
            }
            let spacing = lengths[ends[0]].min(lengths[ends[1]]);
            let pieces = (length / spacing).max(height.min(MOST_PIECES)).clamp(2.0, MOST_SAMPLES).ceil() as u32;
            samples.extend((1..pieces).map(|piece| (a.lerp(b, f64::from(piece) / f64::from(pieces)), triangle as u32)));
        }
        samples
    }

    /// The mean of values at vertices, at a point of a triangle.
    pub(super) fn interpolate(&self, values: &[f64], foot: &Foot) -> f64 {
        let weights = nearest_weights(foot.point, &self.corners_of(foot.triangle)).to_array();
        let vertices = self.triangles[foot.triangle as usize].vertices;
        (0..3).map(|side| weights[side] * values[vertices[side] as usize]).sum()
    }
}

/// Consecutive numbers for elements in the order of their first use.
struct Numbering {
    numbers: Vec<u32>,
    items: Vec<u32>,
}

impl Numbering {
    fn new(count: usize) -> Self {
        Self { numbers: vec![NONE; count], items: Vec::new() }
    }

    fn number(&mut self, item: u32) -> u32 {
        let number = &mut self.numbers[item as usize];
        if *number == NONE {
            *number = self.items.len() as u32;
            self.items.push(item);
        }
        *number
    }
}

/// Outgoing half-edges by vertex: starts of the ranges, and all half-edges.
fn outgoing(triangles: &[EditTriangle], vertices: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0_u32; vertices + 1];
    let corners = || triangles.iter().flat_map(|triangle| triangle.vertices);
    corners().for_each(|vertex| starts[vertex as usize + 1] += 1);
    for vertex in 0..vertices {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut outgoing = vec![NONE; 3 * triangles.len()];
    for (half_edge, vertex) in (0_u32..).zip(corners()) {
        outgoing[next[vertex as usize] as usize] = half_edge;
        next[vertex as usize] += 1;
    }
    (starts, outgoing)
}
