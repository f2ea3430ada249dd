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
mod split;

use std::ops::Range;

use glam::DVec3;
use isochore_mesh::{
    Aabb, Cancelled, CompensatedSum, Monitor, SubTriangle, Subdivision, Topology, TriMesh, VolumeFrame,
};
use rayon::prelude::*;

use blocks::Blocks;
pub(crate) use chosen_edges::ChosenEdges;
use edge_cycles::EdgeCycles;

use crate::{
    Stroke,
    facet_error::{SHARE_SEEN, edge_lengths},
    flow::{self, Advected, CHUNK},
};

/// The edge's midpoint is not followed.
const UNFOLLOWED: u32 = u32::MAX;

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

/// Images of a block of triangles.
#[derive(Debug, Clone, Copy)]
struct Shape {
    /// Box around the corners and the midpoints that are followed.
    bounds: Aabb,
    /// Six times the volume between them and the center of the frame.
    six_volumes: f64,
}

/// What of a triangle of the mesh as read a triangle is.
#[derive(Debug, Clone, Copy)]
struct Part {
    parent: u32,
    /// Barycentric coordinates of the corners in the parent.
    corners: [DVec3; 3],
}

/// Midpoints of edges of the base, and their images.
#[derive(Debug, Clone)]
struct Midpoints {
    /// By half-edge; all along an edge agree.
    of_half_edge: Vec<u32>,
    base: Vec<DVec3>,
    image: Vec<DVec3>,
    /// Boxes around the images of each block of them.
    bounds: Blocks<Aabb>,
    /// Half-edges at those whose image is not known yet.
    pending: Vec<u32>,
    /// Numbers that can be given again.
    unused: Vec<u32>,
}

/// What a stroke did to the images.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AdvectedMesh {
    /// Evaluations of the field.
    pub(crate) evaluations: u64,
    /// Vertices that it moved.
    pub(crate) moved: usize,
}

/// A triangle's image together with the images of its edges' midpoints.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CurvedTriangle {
    /// Images of the corners.
    pub(crate) corners: [DVec3; 3],
    /// Images of the midpoints of the edges 01, 12 and 20.
    pub(crate) midpoints: [DVec3; 3],
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

    /// The rest surface, as finely split as this, if it is split at all; and the images of its vertices.
    pub(crate) fn into_subdivision(self) -> (Option<Subdivision>, Vec<DVec3>) {
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

    /// The triangles in blocks whose images, or those of their midpoints, reach into a box; in ascending order.
    pub(crate) fn triangles_in(&mut self, bounds: Aabb) -> Vec<u32> {
        let count = self.triangles.len();
        let blocks = self.know_shapes().enumerate().filter(|(_, shape)| shape.bounds.overlaps(bounds));
        let triangles = |block: usize| (block * CHUNK) as u32..count.min((block + 1) * CHUNK) as u32;
        blocks.flat_map(|(block, _)| triangles(block)).collect()
    }

    /// Signed volume inside the images of the triangles.
    pub(crate) fn image_volume(&mut self) -> f64 {
        let bounds = self.know_shapes().fold(Aabb::EMPTY, |bounds, shape| bounds.union(shape.bounds));
        // Far from where it was the sum would lose digits.
        if !self.frame.is_centered_in(bounds) {
            self.frame = VolumeFrame::of(&self.image);
            self.shapes.forget_all();
        }
        let six_volumes = sum(self.know_shapes().map(|shape| shape.six_volumes));
        self.frame.volume(six_volumes)
    }

    fn know_shapes(&mut self) -> impl Iterator<Item = Shape> {
        let mut shapes = std::mem::replace(&mut self.shapes, Blocks::NONE);
        let learn = |triangles: Range<usize>| {
            let midpoints = triangles.clone().flat_map(|index| self.midpoints_of(index));
            let midpoints = midpoints.filter(|&midpoint| midpoint != UNFOLLOWED);
            let midpoints = midpoints.map(|midpoint| self.midpoints.image[midpoint as usize]);
            let corners = triangles.clone().flat_map(|index| self.image_of(index));
            Shape {
                bounds: Aabb::of(corners.chain(midpoints)),
                six_volumes: sum(triangles.map(|index| self.frame.six_volumes(self.image_of(index)))),
            }
        };
        shapes.know(self.triangles.len(), learn);
        self.shapes = shapes;
        self.shapes.iter()
    }

    /// Remembers that triangles have changed.
    fn report_changed(&mut self, triangles: &[u32]) {
        self.changed.extend_from_slice(triangles);
        for &index in triangles {
            self.shapes.forget(index as usize);
            self.gain_sums.forget(index as usize);
        }
    }

    /// Triangles whose images, or those of the midpoints at them, have changed since this was last asked, and new ones; in
    /// ascending order.
    pub(crate) fn take_changed(&mut self) -> Vec<u32> {
        let mut changed = std::mem::take(&mut self.changed);
        changed.par_sort_unstable();
        changed.dedup();
        changed
    }

    /// Has triangles be told again as changed.
    pub(crate) fn put_back(&mut self, changed: &[u32]) {
        self.changed.extend_from_slice(changed);
    }

    /// From now on follows the midpoint of the edge of a half-edge, and returns its number. Its image is not known until the
    /// next [`advect_followed`](Self::advect_followed).
    fn follow(&mut self, half_edge: u32) -> u32 {
        let known = self.midpoints.of_half_edge[half_edge as usize];
        if known != UNFOLLOWED {
            return known;
        }
        let middle = middle(self.ends(half_edge), &self.base);
        let midpoints = &mut self.midpoints;
        let number = midpoints.unused.pop().unwrap_or_else(|| {
            midpoints.base.push(DVec3::ZERO);
            midpoints.image.push(DVec3::ZERO);
            midpoints.base.len() as u32 - 1
        });
        midpoints.bounds.forget(number as usize);
        midpoints.base[number as usize] = middle;
        midpoints.image[number as usize] = middle;
        midpoints.pending.push(half_edge);
        self.edges.around(half_edge).for_each(|half_edge| midpoints.of_half_edge[half_edge as usize] = number);
        number
    }

    /// From now on follows the midpoints of a triangle's edges.
    pub(crate) fn follow_edges_of(&mut self, triangle: u32) {
        (0..3).for_each(|side| _ = self.follow(3 * triangle + side));
    }

    /// Carries the midpoints that are newly followed through the `strokes` since the base, which has changed the triangles at
    /// those that move. Returns the evaluations of the fields.
    pub(crate) fn advect_followed(&mut self, strokes: &[Stroke], monitor: &dyn Monitor) -> Result<u64, Cancelled> {
        let midpoints = &mut self.midpoints;
        let pending = std::mem::take(&mut midpoints.pending);
        let number = |half_edge: u32| midpoints.of_half_edge[half_edge as usize] as usize;
        let mut points: Vec<DVec3> = pending.iter().map(|&half_edge| midpoints.base[number(half_edge)]).collect();
        let evaluations = flow::advect(&mut points, strokes, monitor)?;
        let mut changed = Vec::new();
        for (&half_edge, point) in pending.iter().zip(points) {
            let number = midpoints.of_half_edge[half_edge as usize] as usize;
            midpoints.image[number] = point;
            if point != midpoints.base[number] {
                changed.extend(self.edges.around(half_edge).map(|half_edge| half_edge / 3));
            }
        }
        self.report_changed(&changed);
        Ok(evaluations)
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

    /// The triangle's image with its midpoints, if all are followed.
    pub(crate) fn curved(&self, triangle: usize) -> Option<CurvedTriangle> {
        let midpoints = self.midpoints_of(triangle);
        let image = |midpoint: u32| self.midpoints.image[midpoint as usize];
        (!midpoints.contains(&UNFOLLOWED))
            .then(|| CurvedTriangle { corners: self.image_of(triangle), midpoints: midpoints.map(image) })
    }

    /// Sum of the areas of the images of some triangles.
    pub(crate) fn image_area(&self, triangles: &[u32]) -> f64 {
        let area = |&triangle: &u32| {
            let [a, b, c] = self.image_of(triangle as usize);
            0.5 * (b - a).cross(c - a).length()
        };
        triangles.iter().map(area).sum()
    }

    /// Learns the volume between some triangles and their curved images.
    pub(crate) fn update_gains(&mut self, triangles: &[u32]) {
        let gain = |&index: &u32| self.curved(index as usize).map_or(0.0, |curved| curved.volume_gain());
        let gains: Vec<f64> = triangles.par_iter().map(gain).collect();
        for (&index, gain) in triangles.iter().zip(gains) {
            self.gains[index as usize] = gain;
            self.gain_sums.forget(index as usize);
        }
    }

    /// By triangle, the volume gained by splitting it once at the images of its midpoints.
    pub(crate) fn gains(&self) -> &[f64] {
        &self.gains
    }

    /// Estimated signed volume between the flat triangles and the curved image.
    pub(crate) fn facet_error(&mut self) -> f64 {
        let gains = &self.gains;
        let sums = self.gain_sums.know(gains.len(), |triangles| sum(gains[triangles].iter().copied()));
        sum(sums.iter()) / SHARE_SEEN
    }

    /// The midpoints of a triangle's edges 01, 12 and 20.
    fn midpoints_of(&self, triangle: usize) -> [u32; 3] {
        std::array::from_fn(|side| self.midpoints.of_half_edge[3 * triangle + side])
    }

    /// The vertices from which and to which a half-edge runs.
    fn ends(&self, half_edge: u32) -> [u32; 2] {
        let triangle = self.triangles[half_edge as usize / 3];
        [triangle[half_edge as usize % 3], triangle[(half_edge as usize + 1) % 3]]
    }
}

impl Midpoints {
    /// None is followed at these half-edges.
    fn none(of_half_edge: Vec<u32>) -> Self {
        Self {
            of_half_edge,
            base: Vec::new(),
            image: Vec::new(),
            bounds: Blocks::NONE,
            pending: Vec::new(),
            unused: Vec::new(),
        }
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
    let passage = flow::advect_once(image, &boxes, stroke, monitor)?;
    passage.moved.iter().for_each(|&index| bounds.forget(index as usize));
    Ok(passage)
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
