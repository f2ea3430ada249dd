//! A mesh at rest and its image under the flow, split together.
//!
//! A vertex that is inserted lies in the middle of an edge of the *base*, and its image is where the flow carries that point,
//! never the middle of the images: that is what brings the surface closer to the true image. The base is the mesh at rest
//! until something that is no flow acts: then the image [is frozen](Tessellation::freeze) and becomes the base of what follows,
//! while the rest goes on to tell where every vertex came from.

use glam::DVec3;
use isochore_mesh::{Cancelled, Monitor, SelfIntersectionError, SelfIntersections, SubTriangle, Subdivision, TriMesh};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::{Stroke, facet_error::edge_lengths, flow};

/// The edge's midpoint is not followed.
const UNTRACKED: u32 = u32::MAX;

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
    pub(crate) triangles: Vec<SubTriangle>,
    /// For each triangle the midpoints of its edges 01, 12 and 20.
    midpoints_of: Vec<[u32; 3]>,
    midpoints: Midpoints,
}

/// Midpoints of edges of the base, and their images.
#[derive(Debug, Clone, Default)]
struct Midpoints {
    of_edge: FxHashMap<[u32; 2], u32>,
    base: Vec<DVec3>,
    image: Vec<DVec3>,
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
    /// The triangles of `mesh` as they are, at rest.
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        let triangles: Vec<SubTriangle> = (0u32..)
            .zip(&mesh.triangles)
            .map(|(parent, &vertices)| SubTriangle { vertices, parent, corners: [DVec3::X, DVec3::Y, DVec3::Z] })
            .collect();
        Self {
            rest: mesh.positions.clone(),
            base: mesh.positions.clone(),
            image: mesh.positions.clone(),
            midpoints_of: vec![[UNTRACKED; 3]; triangles.len()],
            triangles,
            midpoints: Midpoints::default(),
        }
    }

    /// Makes the image the base of what follows; no midpoint is followed any more.
    pub(crate) fn freeze(&mut self) {
        self.base.clone_from(&self.image);
        self.midpoints = Midpoints::default();
        self.midpoints_of.fill([UNTRACKED; 3]);
    }

    /// Vertex indices of all triangles.
    pub(crate) fn indices(&self) -> Vec<[u32; 3]> {
        self.triangles.iter().map(|triangle| triangle.vertices).collect()
    }

    /// The rest surface, as finely split as this.
    pub(crate) fn into_subdivision(self) -> (Subdivision, Vec<DVec3>) {
        (Subdivision { positions: self.rest, triangles: self.triangles }, self.image)
    }

    /// Carries all images through one more stroke; returns the evaluations of the field.
    pub(crate) fn advance(&mut self, stroke: &Stroke, monitor: &dyn Monitor) -> Result<u64, Cancelled> {
        let stroke = std::slice::from_ref(stroke);
        Ok(flow::advance(&mut self.image, stroke, monitor)?
            + flow::advance(&mut self.midpoints.image, stroke, monitor)?)
    }

    /// From now on follows the edge midpoints of every triangle for which `is_wanted`, carried through the `strokes` since the
    /// base.
    /// Returns the evaluations of the fields.
    pub(crate) fn track(
        &mut self,
        strokes: &[Stroke],
        is_wanted: impl Fn(&Self, usize) -> bool,
        monitor: &dyn Monitor,
    ) -> Result<u64, Cancelled> {
        let known = self.midpoints.base.len();
        let mut is_tracked_vertex = vec![false; self.rest.len()];
        for index in 0..self.triangles.len() {
            let vertices = self.triangles[index].vertices;
            if self.midpoints_of[index].contains(&UNTRACKED) && is_wanted(self, index) {
                self.midpoints_of[index] = edges(vertices).map(|edge| self.midpoints.find_or_insert(edge, &self.base));
            }
            if !self.midpoints_of[index].contains(&UNTRACKED) {
                vertices.into_iter().for_each(|vertex| is_tracked_vertex[vertex as usize] = true);
            }
        }
        // Both sides of an edge must know its midpoint, or splitting one would tear the surface.
        for (triangle, midpoints) in self.triangles.iter().zip(&mut self.midpoints_of) {
            for (edge, midpoint) in edges(triangle.vertices).into_iter().zip(midpoints) {
                if *midpoint == UNTRACKED && edge.iter().all(|&vertex| is_tracked_vertex[vertex as usize]) {
                    *midpoint = self.midpoints.find(edge).unwrap_or(UNTRACKED);
                }
            }
        }
        self.midpoints.image.extend_from_slice(&self.midpoints.base[known..]);
        flow::advance(&mut self.midpoints.image[known..], strokes, monitor)
    }

    /// The number of midpoints that are or were followed; they are numbered below this.
    pub(crate) fn midpoint_count(&self) -> usize {
        self.midpoints.base.len()
    }

    /// The midpoints of a triangle's edges 01, 12 and 20, if all are followed.
    pub(crate) fn midpoints_of(&self, triangle: usize) -> Option<[u32; 3]> {
        let midpoints = self.midpoints_of[triangle];
        (!midpoints.contains(&UNTRACKED)).then_some(midpoints)
    }

    /// Images of the corners of a triangle.
    pub(crate) fn image_of(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].vertices.map(|vertex| self.image[vertex as usize])
    }

    /// Corners of a triangle in the base.
    pub(crate) fn base_of(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].vertices.map(|vertex| self.base[vertex as usize])
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
        let midpoints = self.midpoints_of(triangle)?.map(|midpoint| self.midpoints.image[midpoint as usize]);
        Some(CurvedTriangle { corners: self.image_of(triangle), midpoints })
    }

    /// Triangles whose images cross others, while in the base nothing crosses within the triangles of the mesh as read that
    /// hold them; in ascending order.
    pub(crate) fn new_crossings(&self, monitor: &dyn Monitor) -> Result<Vec<u32>, Cancelled> {
        let found = crossing_pairs(&self.image, self.indices(), monitor)?;
        if found.is_empty() {
            return Ok(Vec::new());
        }
        let in_base: FxHashSet<[u32; 2]> =
            crossing_pairs(&self.base, self.indices(), monitor)?.into_iter().map(|pair| self.parents(pair)).collect();
        let mut crossing: Vec<u32> =
            found.into_iter().filter(|&pair| !in_base.contains(&self.parents(pair))).flatten().collect();
        crossing.sort_unstable();
        crossing.dedup();
        Ok(crossing)
    }

    /// Sum of the areas of the images of some triangles.
    pub(crate) fn image_area(&self, triangles: &[u32]) -> f64 {
        let area = |&triangle: &u32| {
            let [a, b, c] = self.image_of(triangle as usize);
            0.5 * (b - a).cross(c - a).length()
        };
        triangles.iter().map(area).sum()
    }

    fn parents(&self, pair: [u32; 2]) -> [u32; 2] {
        let [a, b] = pair.map(|triangle| self.triangles[triangle as usize].parent);
        [a.min(b), a.max(b)]
    }

    /// Whether an edge of the triangle is chosen.
    pub(crate) fn is_triangle_split(&self, triangle: usize, is_split: &[bool]) -> bool {
        self.midpoints_of[triangle].iter().any(|&midpoint| chosen(is_split, midpoint))
    }

    /// Triangles that [`split`](Self::split) would leave.
    pub(crate) fn triangles_after(&self, is_split: &[bool]) -> usize {
        let added = |midpoints: &[u32; 3]| midpoints.iter().filter(|&&midpoint| chosen(is_split, midpoint)).count();
        self.triangles.len() + self.midpoints_of.iter().map(added).sum::<usize>()
    }

    /// Splits the edges whose midpoints are chosen, and every triangle at them: into two, three or four by the number of its
    /// chosen edges, so that both sides of an edge agree. Returns the number of vertices inserted.
    pub(crate) fn split(&mut self, is_split: &[bool]) -> usize {
        let before = self.rest.len();
        let mut vertex_of = vec![UNTRACKED; is_split.len()];
        let mut triangles = Vec::with_capacity(self.triangles_after(is_split));
        let mut midpoints_of = Vec::with_capacity(triangles.capacity());
        for (triangle, midpoints) in self.triangles.iter().zip(&self.midpoints_of) {
            let edges = edges(triangle.vertices);
            let inserted: [Option<u32>; 3] = std::array::from_fn(|edge| {
                let midpoint = midpoints[edge];
                chosen(is_split, midpoint).then(|| {
                    let vertex = &mut vertex_of[midpoint as usize];
                    if *vertex == UNTRACKED {
                        *vertex = self.rest.len() as u32;
                        self.rest.push(middle(edges[edge], &self.rest));
                        self.base.push(self.midpoints.base[midpoint as usize]);
                        self.image.push(self.midpoints.image[midpoint as usize]);
                    }
                    *vertex
                })
            });
            if inserted == [None; 3] {
                triangles.push(*triangle);
                midpoints_of.push(*midpoints);
            } else {
                split_triangle(triangle, inserted, &self.image, &mut triangles);
                midpoints_of.resize(triangles.len(), [UNTRACKED; 3]);
            }
        }
        self.triangles = triangles;
        self.midpoints_of = midpoints_of;
        self.rest.len() - before
    }
}

impl Midpoints {
    fn find(&self, [a, b]: [u32; 2]) -> Option<u32> {
        self.of_edge.get(&[a.min(b), a.max(b)]).copied()
    }

    fn find_or_insert(&mut self, [a, b]: [u32; 2], base: &[DVec3]) -> u32 {
        *self.of_edge.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            self.base.push(middle([a, b], base));
            self.base.len() as u32 - 1
        })
    }
}

fn crossing_pairs(
    positions: &[DVec3],
    triangles: Vec<[u32; 3]>,
    monitor: &dyn Monitor,
) -> Result<Vec<[u32; 2]>, Cancelled> {
    match SelfIntersections::of(&TriMesh::new(positions.to_vec(), triangles), monitor) {
        Ok(found) => Ok(found.pairs().to_vec()),
        Err(SelfIntersectionError::Cancelled(cancelled)) => Err(cancelled),
        // A mesh that cannot be searched is reported where it is checked; there is nothing to split here.
        Err(_) => Ok(Vec::new()),
    }
}

/// The directed edges 01, 12 and 20 of a triangle.
fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// The middle of an edge; it has the same bits from either end.
fn middle([a, b]: [u32; 2], positions: &[DVec3]) -> DVec3 {
    0.5 * (positions[a as usize] + positions[b as usize])
}

fn chosen(is_split: &[bool], midpoint: u32) -> bool {
    midpoint != UNTRACKED && is_split[midpoint as usize]
}

/// Appends the parts of `triangle`, whose edges 01, 12 and 20 have got the vertices `inserted`.
fn split_triangle(triangle: &SubTriangle, inserted: [Option<u32>; 3], image: &[DVec3], parts: &mut Vec<SubTriangle>) {
    // Turned so that the cases need one pattern each.
    let turns = match inserted {
        [Some(_), None, None] | [Some(_), Some(_), None] | [Some(_), Some(_), Some(_)] => 0,
        [None, Some(_), _] => 1,
        _ => 2,
    };
    let turned = |index: usize| (index + turns) % 3;
    let corner = |index: usize| (triangle.vertices[turned(index)], triangle.corners[turned(index)]);
    let inserted_at = |index: usize| {
        let weights = 0.5 * (triangle.corners[turned(index)] + triangle.corners[turned(index + 1)]);
        inserted[turned(index)].map(|vertex| (vertex, weights))
    };
    let mut push = |part: [(u32, DVec3); 3]| {
        parts.push(SubTriangle { vertices: part.map(|p| p.0), corners: part.map(|p| p.1), parent: triangle.parent });
    };
    let [a, b, c] = [corner(0), corner(1), corner(2)];
    match (inserted_at(0), inserted_at(1), inserted_at(2)) {
        (Some(ab), Some(bc), Some(ca)) => {
            push([a, ab, ca]);
            push([ab, b, bc]);
            push([ca, bc, c]);
            push([ab, bc, ca]);
        }
        (Some(ab), Some(bc), None) => {
            push([ab, b, bc]);
            let position = |p: (u32, DVec3)| image[p.0 as usize];
            if position(a).distance_squared(position(bc)) < position(ab).distance_squared(position(c)) {
                push([a, ab, bc]);
                push([a, bc, c]);
            } else {
                push([a, ab, c]);
                push([ab, bc, c]);
            }
        }
        (Some(ab), None, None) => {
            push([a, ab, c]);
            push([ab, b, c]);
        }
        _ => push([a, b, c]),
    }
}
