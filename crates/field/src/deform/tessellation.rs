//! A mesh at rest and its image under the flow, split together.
//!
//! A vertex that is inserted lies in the middle of an edge of the *base*, and its image is where the flow carries that point,
//! never the middle of the images: that is what brings the surface closer to the true image. The base is the mesh at rest
//! until something that is no flow acts: then the image [is frozen](Tessellation::freeze) and becomes the base of what follows,
//! while the rest goes on to tell where every vertex came from.
//!
//! A stroke touches a part of the surface, and what is done for it should cost what that part costs. So the triangles that have
//! [changed](Tessellation::take_changed) are listed, a triangle that is split keeps its number for the first of its parts, and
//! every edge knows the half-edges along it.

mod blocks;
mod chosen_edges;
mod crossings;
mod edge_cycles;
mod facet_error;
mod midpoints;
mod shape;
mod split;

use glam::DVec3;
use isochore_mesh::{
    Aabb, Cancelled, CompensatedSum, Monitor, SubTriangle, Subdivision, Topology, TriMesh, VolumeFrame,
};
use rayon::prelude::*;

use blocks::Blocks;
pub(crate) use chosen_edges::ChosenEdges;
use edge_cycles::EdgeCycles;
pub(crate) use facet_error::FacetError;
use midpoints::{Midpoints, UNFOLLOWED};
use shape::Shape;

use super::curved_triangle::edge_lengths;
use crate::flow::{
    Stroke,
    advection::{Advected, advect_once, bits},
};

/// The triangle is one of the mesh as read.
const WHOLE: u32 = u32::MAX;

/// A triangle whose height is less than this share of its longest edge is a sliver. Larger takes what the image needs long
/// and thin at rest for slivers; smaller lets real ones get thinner before they are halved.
const SLIVER: f64 = 0.03;

/// A mesh at rest, its base and image, and the midpoints of those edges that are followed through the flow.
#[derive(Debug, Clone)]
pub(crate) struct Tessellation {
    /// Where the vertices lie on the mesh as read.
    pub(crate) rest: Vec<DVec3>,
    /// Where the flow that leads to the image set out.
    pub(crate) base: Vec<DVec3>,
    pub(crate) image: Vec<DVec3>,
    /// Vertex indices; those of the mesh as read, or their first parts, come first.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// By triangle, its number among the parts.
    part_of: Vec<u32>,
    parts: Vec<Part>,
    edges: EdgeCycles,
    midpoints: Midpoints,
    /// By triangle, the volume between it and its curved image, as far as that is known.
    gains: Vec<f64>,
    /// Sums of these, by block of triangles.
    gain_sums: Blocks<f64>,
    /// By block of triangles.
    shapes: Blocks<Shape>,
    /// Boxes around the images of each block of vertices.
    vertex_bounds: Blocks<Aabb>,
    /// In which the volumes of the shapes are.
    frame: VolumeFrame,
    /// Triangles whose images have changed since they were last taken; in any order, some more than once.
    changed: Vec<u32>,
}

/// What of a triangle of the mesh as read a triangle is.
#[derive(Debug, Clone, Copy)]
struct Part {
    parent: u32,
    /// Barycentric coordinates of the corners in the parent.
    corners: [DVec3; 3],
}

/// What a stroke did to the images.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AdvectedMesh {
    /// Evaluations of the field.
    pub(crate) evaluations: u64,
    /// Vertices that it moved.
    pub(crate) moved: usize,
}

impl Tessellation {
    /// The triangles of `mesh` as they are, at rest; `topology` is that of `mesh`.
    pub(crate) fn new(mesh: &TriMesh, topology: &Topology) -> Self {
        let count = mesh.triangles.len();
        Self {
            rest: mesh.positions.clone(),
            base: mesh.positions.clone(),
            image: mesh.positions.clone(),
            triangles: mesh.triangles.clone(),
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
        }
    }

    /// Makes the image the base of what follows, whatever has become of it; no midpoint is followed any more.
    pub(crate) fn freeze(&mut self) {
        self.base.clone_from(&self.image);
        if !self.midpoints.base.is_empty() {
            let mut of_half_edge = std::mem::take(&mut self.midpoints.of_half_edge);
            of_half_edge.fill(UNFOLLOWED);
            self.midpoints = Midpoints::none(of_half_edge);
        }
        self.gains.fill(0.0);
        self.gain_sums.forget_all();
        self.shapes.forget_all();
        self.vertex_bounds.forget_all();
        self.changed.clear();
    }

    /// `mesh`, of which this is the tessellation, deformed, and the same triangles at rest.
    pub(crate) fn into_meshes(self, mesh: &TriMesh) -> (TriMesh, TriMesh) {
        let (rest, image) = match self.into_subdivision() {
            (Some(subdivision), image) => (mesh.subdivided(&subdivision), image),
            (None, image) => (mesh.clone(), image),
        };
        let mut mesh = TriMesh { positions: image, ..rest.clone() };
        mesh.turn_normals(&rest.positions);
        (mesh, rest)
    }

    /// The rest surface, as finely split as this, if it is split at all; and the images of its vertices.
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

    /// The triangle of the mesh as read that holds this one.
    pub(crate) fn parent(&self, triangle: usize) -> u32 {
        self.part(triangle).parent
    }

    fn part(&self, triangle: usize) -> Part {
        match self.part_of[triangle] {
            WHOLE => Part { parent: triangle as u32, corners: DVec3::AXES },
            part => self.parts[part as usize],
        }
    }

    /// Carries all images through one more stroke.
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
        Ok(AdvectedMesh { evaluations: vertices.evaluations + midpoints.evaluations, moved: vertices.moved.len() })
    }

    /// Remembers that triangles have changed.
    fn report_changed(&mut self, triangles: &[u32]) {
        self.changed.extend_from_slice(triangles);
        for &index in triangles {
            self.shapes.forget(index as usize);
            self.gain_sums.forget(index as usize);
        }
    }

    /// The half-edges along the edge of one of them.
    pub(crate) fn next_around(&self, half_edge: u32) -> u32 {
        self.edges.next(half_edge)
    }

    /// Whether a vertex of a triangle is not where it is in the base.
    pub(crate) fn has_moved(&self, triangle: usize) -> bool {
        self.triangles[triangle].iter().any(|&vertex| self.image[vertex as usize] != self.base[vertex as usize])
    }

    /// Images of the corners of a triangle.
    pub(crate) fn image_of(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.image[vertex as usize])
    }

    /// Corners of a triangle in the base.
    pub(crate) fn base_of(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.base[vertex as usize])
    }

    /// Whether a triangle of the base is much lower than long.
    pub(crate) fn is_sliver_in_base(&self, triangle: usize) -> bool {
        let [a, b, c] = self.base_of(triangle);
        let longest = self.longest_base_edge(triangle);
        (b - a).cross(c - a).length() < SLIVER * longest * longest
    }

    /// Length in the base of the longest edge of a triangle.
    pub(crate) fn longest_base_edge(&self, triangle: usize) -> f64 {
        edge_lengths(&self.base_of(triangle)).into_iter().fold(0.0, f64::max)
    }

    /// Sum of the areas of the images of some triangles.
    pub(crate) fn image_area(&self, triangles: &[u32]) -> f64 {
        let area = |&triangle: &u32| {
            let [a, b, c] = self.image_of(triangle as usize);
            0.5 * (b - a).cross(c - a).length()
        };
        triangles.iter().map(area).sum()
    }

    /// The vertices from which and to which a half-edge runs.
    fn ends(&self, half_edge: u32) -> [u32; 2] {
        let triangle = self.triangles[half_edge as usize / 3];
        [triangle[half_edge as usize % 3], triangle[(half_edge as usize + 1) % 3]]
    }
}

/// Carries images through a stroke, of which `bounds` says where each block is.
fn advect_images(
    image: &mut [DVec3],
    bounds: &mut Blocks<Aabb>,
    stroke: &Stroke,
    monitor: &dyn Monitor,
) -> Result<Advected, Cancelled> {
    let boxes: Vec<Aabb> = bounds.know(image.len(), |block| Aabb::of(image[block].iter().copied())).iter().collect();
    let passage = advect_once(image, &boxes, stroke, monitor)?;
    passage.moved.iter().for_each(|&index| bounds.forget(index as usize));
    Ok(passage)
}

/// The number of points that differ in any bit.
pub(crate) fn count_different(before: &[DVec3], after: &[DVec3]) -> usize {
    before.iter().zip(after).filter(|&(&before, &after)| bits(before) != bits(after)).count()
}

/// For each of `count` things whether it is among these.
fn flags(count: usize, indices: &[u32]) -> Vec<bool> {
    let mut is_among = vec![false; count];
    indices.iter().for_each(|&index| is_among[index as usize] = true);
    is_among
}

/// A compensated sum.
fn sum(terms: impl Iterator<Item = f64>) -> f64 {
    let mut sum = CompensatedSum::default();
    terms.for_each(|term| sum.add(term));
    sum.value()
}

/// The middle of an edge; it has the same bits from either end.
fn middle([a, b]: [u32; 2], positions: &[DVec3]) -> DVec3 {
    0.5 * (positions[a as usize] + positions[b as usize])
}
