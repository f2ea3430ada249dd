//! A mesh at rest and its image under the flow, split together.
//!
//! A new vertex is the midpoint of an edge of the *base*, and its image is the flow map of that
//! midpoint, not the midpoint of the images. That is how a split brings the surface closer to the
//! true image. The base is the mesh at rest until a stamp acts. Then the image is
//! [frozen](Tessellation::freeze) and becomes the base of the strokes that follow, and the rest
//! keeps the origin of every vertex.
//!
//! The cost of a stroke should be proportional to the part of the surface that it touches.
//! Therefore the tessellation lists the triangles that have changed, a split triangle keeps its
//! index for the first of its parts, and each edge stores its half-edges.
//!
//! The tessellation also owns the estimate of the facet error. The criteria that choose edges to
//! split belong to [`refine`](super::refine).

mod blocks;
mod chosen_edges;
mod edge_cycles;
mod facet_error;
mod midpoints;
mod pieces;
mod shape;
mod split;

use glam::DVec3;
use isochore_mesh::{
    Aabb, Cancelled, CompensatedSum, Monitor, SubTriangle, Subdivision, Topology, TriMesh, VolumeFrame,
};
use rayon::prelude::*;

use blocks::Blocks;
pub(crate) use chosen_edges::{ChosenEdges, Cut};
use edge_cycles::EdgeCycles;
pub(crate) use facet_error::FacetError;
use midpoints::{Midpoints, UNFOLLOWED};
pub(crate) use pieces::Piece;
use shape::Shape;
pub(crate) use split::SplitTriangles;

use super::curved_triangle::edge_lengths;
use crate::flow::{
    Stroke,
    advection::{Advected, advect, advect_once, bits},
};

/// In `part_of`: the triangle is a whole triangle of the input mesh.
const WHOLE: u32 = u32::MAX;

/// A triangle is a sliver if its height is less than this fraction of its longest edge. A larger value
/// includes triangles that the image needs long and thin at rest; a smaller value lets slivers get
/// thinner before they are bisected.
const SLIVER: f64 = 0.03;

/// A mesh at rest, its base and image, and the midpoints of those edges that are followed through the flow.
#[derive(Debug, Clone)]
pub(crate) struct Tessellation {
    /// Positions of the vertices on the input mesh.
    pub(crate) rest: Vec<DVec3>,
    /// Positions from which the flow leads to the image.
    pub(crate) base: Vec<DVec3>,
    pub(crate) image: Vec<DVec3>,
    /// Vertex indices. The input triangles, or their first parts, come first.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The point on an edge at which each inserted vertex was made, in the order of the vertices.
    pub(crate) origins: Vec<Cut>,
    /// Index into `parts` for each triangle, or [`WHOLE`].
    part_of: Vec<u32>,
    parts: Vec<Part>,
    edges: EdgeCycles,
    midpoints: Midpoints,
    /// Volume gained by one split of each triangle; zero while its midpoints are not followed.
    gains: Vec<f64>,
    /// Sums of `gains` over blocks of triangles.
    gain_sums: Blocks<f64>,
    /// Boxes and volumes of blocks of triangles.
    shapes: Blocks<Shape>,
    /// Boxes around the images of each block of vertices.
    vertex_bounds: Blocks<Aabb>,
    /// Center of the volumes in `shapes`.
    frame: VolumeFrame,
    /// Triangles whose images have changed since the last estimate, in any order and with repetitions.
    changed: Vec<u32>,
    /// Triangles that have changed since the last search for crossings, likewise.
    unchecked: Vec<u32>,
}

/// The part of an input triangle that a triangle covers.
#[derive(Debug, Clone, Copy)]
struct Part {
    parent: u32,
    /// Barycentric coordinates of the corners in the parent.
    corners: [DVec3; 3],
}

/// Result of advecting the image through one stroke.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AdvectedMesh {
    /// Evaluations of the field.
    pub(crate) evaluations: u64,
    /// Number of vertices that the stroke moved.
    pub(crate) moved: usize,
}

impl Tessellation {
    /// The unsplit triangles of `mesh`, at rest. `topology` is that of `mesh`.
    pub(crate) fn new(mesh: &TriMesh, topology: &Topology) -> Self {
        let count = mesh.triangles.len();
        Self {
            rest: mesh.positions.clone(),
            base: mesh.positions.clone(),
            image: mesh.positions.clone(),
            triangles: mesh.triangles.clone(),
            origins: Vec::new(),
            part_of: vec![WHOLE; count],
            parts: Vec::new(),
            edges: EdgeCycles::new(topology),
            midpoints: Midpoints::none(vec![UNFOLLOWED; 3 * count]),
            gains: vec![0.0; count],
            gain_sums: Blocks::NONE,
            shapes: Blocks::NONE,
            vertex_bounds: Blocks::NONE,
            frame: VolumeFrame::of(&mesh.positions),
            changed: Vec::new(),
            unchecked: Vec::new(),
        }
    }

    /// Makes the image the base of the strokes that follow, and stops following all midpoints.
    pub(crate) fn freeze(&mut self) {
        self.base.clone_from(&self.image);
        if !self.midpoints.base.is_empty() {
            let mut of_half_edge = std::mem::take(&mut self.midpoints.of_half_edge);
            of_half_edge.fill(UNFOLLOWED);
            self.midpoints = Midpoints::none(of_half_edge);
        }
        self.gains.fill(0.0);
        self.gain_sums.clear();
        self.shapes.clear();
        self.vertex_bounds.clear();
        self.changed.clear();
    }

    /// Makes `image`, the positions of the first vertices, the base and the image. All vertices that were
    /// inserted later lie flat between those.
    pub(crate) fn restart_from(&mut self, image: &[DVec3]) {
        let first_inserted = self.rest.len() - self.origins.len();
        self.image.clear();
        self.image.extend_from_slice(image);
        for vertex in image.len()..self.rest.len() {
            let position = self.origins[vertex - first_inserted].position(&self.image);
            self.image.push(position);
        }
        self.freeze();
    }

    /// The deformed mesh, and the same triangles at rest. `mesh` is the input mesh.
    pub(crate) fn into_meshes(self, mesh: &TriMesh) -> (TriMesh, TriMesh) {
        let (rest, image) = match self.into_subdivision() {
            (Some(subdivision), image) => (mesh.subdivided(&subdivision), image),
            (None, image) => (mesh.clone(), image),
        };
        let mut mesh = TriMesh { positions: image, ..rest.clone() };
        mesh.turn_normals(&rest.positions);
        (mesh, rest)
    }

    /// The split of the rest surface, or `None` if there is none, and the images of its vertices.
    fn into_subdivision(self) -> (Option<Subdivision>, Vec<DVec3>) {
        if self.parts.is_empty() {
            return (None, self.image);
        }
        let triangle = |(index, &vertices): (usize, &[u32; 3])| {
            let Part { parent, corners } = self.part(index);
            SubTriangle { vertices, parent, corners }
        };
        let triangles = self.triangles.par_iter().enumerate().map(triangle).collect();
        (Some(Subdivision { triangles, positions: self.rest }), self.image)
    }

    /// Index of the input triangle that contains this triangle.
    pub(crate) fn parent(&self, triangle: usize) -> u32 {
        self.part(triangle).parent
    }

    fn part(&self, triangle: usize) -> Part {
        match self.part_of[triangle] {
            WHOLE => Part { parent: triangle as u32, corners: DVec3::AXES },
            part => self.parts[part as usize],
        }
    }

    /// Advects all images through one more stroke.
    pub(crate) fn advect(&mut self, stroke: &Stroke, monitor: &dyn Monitor) -> Result<AdvectedMesh, Cancelled> {
        let near = self.triangles_in(stroke.reach());
        let vertices = advect_images(&mut self.image, &mut self.vertex_bounds, stroke, monitor)?;
        let midpoints = advect_images(&mut self.midpoints.image, &mut self.midpoints.bounds, stroke, monitor)?;
        let is_moved = flags(self.image.len(), &vertices.moved);
        let is_midpoint_moved = flags(self.midpoints.image.len(), &midpoints.moved);
        let has_changed = |&index: &u32| {
            let midpoints = self.midpoints_of(index as usize);
            self.triangles[index as usize].iter().any(|&vertex| is_moved[vertex as usize])
                || midpoints.iter().any(|&point| point != UNFOLLOWED && is_midpoint_moved[point as usize])
        };
        let changed: Vec<u32> = near.into_par_iter().filter(has_changed).collect();
        self.report_changed(&changed);
        self.unchecked.extend_from_slice(&changed);
        Ok(AdvectedMesh { evaluations: vertices.evaluations + midpoints.evaluations, moved: vertices.moved.len() })
    }

    /// Advects all images again, from the base through `strokes`.
    pub(crate) fn advect_again(&mut self, strokes: &[Stroke], monitor: &dyn Monitor) -> Result<u64, Cancelled> {
        let mut image = self.base.clone();
        let mut midpoints = self.midpoints.base.clone();
        let evaluations = advect(&mut image, strokes, monitor)? + advect(&mut midpoints, strokes, monitor)?;
        self.image = image;
        self.midpoints.image = midpoints;
        self.vertex_bounds.clear();
        self.midpoints.bounds.clear();
        let all: Vec<u32> = (0..self.triangles.len() as u32).collect();
        self.report_changed(&all);
        self.unchecked.extend_from_slice(&all);
        Ok(evaluations)
    }

    /// The triangles that have moved or are new since the last call, in ascending order.
    pub(crate) fn take_unchecked(&mut self) -> Vec<u32> {
        let mut unchecked = std::mem::take(&mut self.unchecked);
        unchecked.par_sort_unstable();
        unchecked.dedup();
        unchecked
    }

    /// Records that triangles have changed.
    fn report_changed(&mut self, triangles: &[u32]) {
        self.changed.extend_from_slice(triangles);
        for &index in triangles {
            self.shapes.invalidate(index as usize);
            self.gain_sums.invalidate(index as usize);
        }
    }

    /// The half-edge that follows in the cycle around its edge.
    pub(crate) fn next_around(&self, half_edge: u32) -> u32 {
        self.edges.next(half_edge)
    }

    /// The triangles with a vertex for which `is_chosen` is true, in ascending order.
    pub(crate) fn triangles_with(&self, is_chosen: impl Fn(usize) -> bool + Sync) -> Vec<u32> {
        let has_chosen = |index: &u32| self.triangles[*index as usize].iter().any(|&vertex| is_chosen(vertex as usize));
        (0..self.triangles.len() as u32).into_par_iter().filter(has_chosen).collect()
    }

    /// Whether a vertex of a triangle has moved from the base.
    pub(crate) fn has_moved(&self, triangle: usize) -> bool {
        self.triangles[triangle].iter().any(|&vertex| self.image[vertex as usize] != self.base[vertex as usize])
    }

    /// Images of the corners of a triangle.
    pub(crate) fn image_of(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.image[vertex as usize])
    }

    /// Base positions of the corners of a triangle.
    pub(crate) fn base_of(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.base[vertex as usize])
    }

    /// Whether a triangle is a [sliver](SLIVER) in the base.
    pub(crate) fn is_sliver_in_base(&self, triangle: usize) -> bool {
        let [a, b, c] = self.base_of(triangle);
        let longest = self.longest_base_edge(triangle);
        (b - a).cross(c - a).length() < SLIVER * longest * longest
    }

    /// Length of the longest edge of a triangle in the base.
    pub(crate) fn longest_base_edge(&self, triangle: usize) -> f64 {
        edge_lengths(&self.base_of(triangle)).into_iter().fold(0.0, f64::max)
    }

    /// Sum of the areas of some triangles at the given positions of the vertices.
    pub(crate) fn area_at(&self, positions: &[DVec3], triangles: &[u32]) -> f64 {
        let corners = |&index: &u32| self.triangles[index as usize].map(|vertex| positions[vertex as usize]);
        triangles.iter().map(|triangle| area(corners(triangle))).sum()
    }

    /// The largest deviation of the midpoint of an edge among the triangles whose edges are followed.
    pub(crate) fn largest_deviation(&self) -> f64 {
        let of = |index| self.curved(index).map(|curved| curved.deviations().map(DVec3::length));
        let largest = |index| of(index).into_iter().flatten().fold(0.0, f64::max);
        (0..self.triangles.len()).into_par_iter().map(largest).reduce(|| 0.0, f64::max)
    }

    /// The first and the last vertex of a half-edge.
    fn ends(&self, half_edge: u32) -> [u32; 2] {
        let triangle = self.triangles[half_edge as usize / 3];
        [triangle[half_edge as usize % 3], triangle[(half_edge as usize + 1) % 3]]
    }
}

/// Advects images through a stroke. `bounds` holds a box for each block of images.
fn advect_images(
    image: &mut [DVec3],
    bounds: &mut Blocks<Aabb>,
    stroke: &Stroke,
    monitor: &dyn Monitor,
) -> Result<Advected, Cancelled> {
    let boxes: Vec<Aabb> = bounds.fill(image.len(), |block| Aabb::of(image[block].iter().copied())).iter().collect();
    let advected = advect_once(image, &boxes, stroke, monitor)?;
    advected.moved.iter().for_each(|&index| bounds.invalidate(index as usize));
    Ok(advected)
}

/// The number of points that differ in any bit.
pub(crate) fn count_different(before: &[DVec3], after: &[DVec3]) -> usize {
    before.iter().zip(after).filter(|&(&before, &after)| bits(before) != bits(after)).count()
}

/// Flags of length `count` that are true at `indices`.
fn flags(count: usize, indices: &[u32]) -> Vec<bool> {
    let mut flags = vec![false; count];
    indices.iter().for_each(|&index| flags[index as usize] = true);
    flags
}

/// Area of a flat triangle.
fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// A compensated sum.
fn sum(terms: impl Iterator<Item = f64>) -> f64 {
    let mut sum = CompensatedSum::default();
    terms.for_each(|term| sum.add(term));
    sum.value()
}

/// The midpoint of an edge. Both orders of the ends give the same bits.
fn middle([a, b]: [u32; 2], positions: &[DVec3]) -> DVec3 {
    0.5 * (positions[a as usize] + positions[b as usize])
}
