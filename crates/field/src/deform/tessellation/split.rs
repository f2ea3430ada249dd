//! Splitting: the parts of a triangle replace it.

use glam::DVec3;
use isochore_mesh::{TriangleSide, TriangleSplit};
use rustc_hash::FxHashMap;

use super::{ChosenEdges, Cut, Part, Tessellation, WHOLE, midpoints::UNFOLLOWED};

/// A corner of a triangle that is being split.
#[derive(Debug, Clone, Copy)]
struct Corner {
    vertex: u32,
    /// Barycentric coordinates in the input triangle.
    weights: DVec3,
    image: DVec3,
}

/// A new vertex on a side of a triangle.
#[derive(Debug, Clone, Copy)]
struct Inserted {
    vertex: u32,
    cut: Cut,
}

/// A side of a triangle that is being split.
#[derive(Debug, Clone, Copy)]
enum Side {
    /// An unsplit side of the triangle, by its half-edge.
    Whole(u32),
    /// A half of a split side, or a side inside the triangle.
    New,
}

impl TriangleSide for Side {
    fn first(self) -> Self {
        Self::New
    }

    fn second(self) -> Self {
        Self::New
    }

    fn reversed(self) -> Self {
        self
    }
}

/// Triangles that a split has made.
#[derive(Debug)]
pub(crate) struct SplitTriangles {
    /// The parts of all split triangles, in ascending order. The first part of each has its index.
    pub(crate) parts: Vec<u32>,
    /// The split triangle of each part that was added behind the existing triangles, in their order.
    pub(crate) sources: Vec<u32>,
}

impl Tessellation {
    /// Splits the chosen edges and the triangles at them, each into one part more than it has chosen
    /// edges, so that both sides of an edge agree.
    pub(crate) fn split(&mut self, chosen: &ChosenEdges) -> SplitTriangles {
        let known = self.rest.len() as u32;
        let mut split = Vec::with_capacity(2 * chosen.half_edges().len());
        for (&half_edge, cut) in chosen.half_edges().iter().zip(chosen.cuts()) {
            let midpoint = self.midpoints.of_half_edge[half_edge as usize];
            self.rest.push(cut.position(&self.rest));
            self.base.push(self.midpoints.base[midpoint as usize]);
            self.image.push(self.midpoints.image[midpoint as usize]);
            self.midpoints.unused.push(midpoint);
            self.vertex_bounds.invalidate(self.rest.len() - 1);
            split.extend(self.edges.around(half_edge).map(|half_edge| half_edge / 3));
        }
        self.origins.extend_from_slice(chosen.cuts());
        split.sort_unstable();
        split.dedup();
        let first_new = self.triangles.len() as u32;
        // One half-edge on each new edge, by the vertices of the edge.
        let mut new_edges = FxHashMap::default();
        let mut sources = Vec::with_capacity(split.len());
        for &triangle in &split {
            let inserted = self.midpoints_of(triangle as usize).map(|midpoint| {
                let index = chosen.index_of(midpoint)?;
                Some(Inserted { vertex: known + index, cut: chosen.cuts()[index as usize] })
            });
            self.split_triangle(triangle, inserted, &mut new_edges);
            sources.resize(self.triangles.len() - first_new as usize, triangle);
        }
        split.extend(first_new..self.triangles.len() as u32);
        self.report_changed(&split);
        self.unchecked.extend_from_slice(&split);
        SplitTriangles { parts: split, sources }
    }

    /// Replaces a triangle by its parts. `inserted` holds the new vertices on the edges 01, 12 and 20.
    fn split_triangle(
        &mut self,
        triangle: u32,
        inserted: [Option<Inserted>; 3],
        new_edges: &mut FxHashMap<[u32; 2], u32>,
    ) {
        let Part { parent, corners: weights } = self.part(triangle as usize);
        let vertices = self.triangles[triangle as usize];
        let corner = |vertex: u32, weights| Corner { vertex, weights, image: self.image[vertex as usize] };
        let middle = |side: usize| {
            let Inserted { vertex, cut } = inserted[side]?;
            let fraction = cut.fraction_from(vertices[side]);
            Some(corner(vertex, (1.0 - fraction) * weights[side] + fraction * weights[(side + 1) % 3]))
        };
        let whole = [0, 1, 2].map(|side| 3 * triangle + side);
        let split = TriangleSplit {
            corners: [0, 1, 2].map(|index| corner(vertices[index], weights[index])),
            sides: whole.map(Side::Whole),
            midpoints: [0, 1, 2].map(middle),
        };
        let mut parts: Vec<([Corner; 3], [Side; 3])> = Vec::with_capacity(4);
        let distance_squared = |a: &Corner, b: &Corner| a.image.distance_squared(b.image);
        let is_done =
            split.parts(distance_squared, |_, _| Some(Side::New), |corners, sides| parts.push((corners, sides)));
        debug_assert!(is_done.is_some(), "every inner side was given");

        // The first part takes the index of the triangle, so the old half-edges move behind all others
        // until each is replaced by its successor.
        let midpoints = whole.map(|half_edge| self.midpoints.of_half_edge[half_edge as usize]);
        let count = self.triangles.len() + parts.len() - 1;
        self.edges.resize(count + 1);
        let aside = |half_edge: u32| 3 * count as u32 + half_edge % 3;
        for half_edge in whole {
            match inserted[half_edge as usize % 3] {
                None => self.edges.replace(half_edge, aside(half_edge)),
                Some(_) => self.edges.isolate(half_edge),
            }
        }
        for (index, (corners, sides)) in parts.into_iter().enumerate() {
            let at = if index == 0 { triangle } else { self.push_triangle() };
            self.triangles[at as usize] = corners.map(|corner| corner.vertex);
            self.set_part(at as usize, Part { parent, corners: corners.map(|corner| corner.weights) });
            for (half_edge, side) in (3 * at..).zip(sides) {
                match side {
                    Side::Whole(old) => {
                        self.midpoints.of_half_edge[half_edge as usize] = midpoints[old as usize % 3];
                        self.edges.replace(aside(old), half_edge);
                    }
                    Side::New => {
                        self.midpoints.of_half_edge[half_edge as usize] = UNFOLLOWED;
                        let [a, b] = self.ends(half_edge);
                        let other = *new_edges.entry([a.min(b), a.max(b)]).or_insert(half_edge);
                        if other != half_edge {
                            self.edges.join(half_edge, other);
                        }
                    }
                }
            }
        }
        self.edges.resize(count);
    }

    /// Adds an empty triangle and returns its index.
    fn push_triangle(&mut self) -> u32 {
        self.triangles.push([0; 3]);
        self.part_of.push(WHOLE);
        self.midpoints.of_half_edge.extend([UNFOLLOWED; 3]);
        self.gains.push(0.0);
        self.triangles.len() as u32 - 1
    }

    pub(super) fn set_part(&mut self, triangle: usize, part: Part) {
        if self.part_of[triangle] == WHOLE {
            self.part_of[triangle] = self.parts.len() as u32;
            self.parts.push(part);
        } else {
            self.parts[self.part_of[triangle] as usize] = part;
        }
    }
}
