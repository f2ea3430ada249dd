//! Edge flips on a closed manifold mesh.

use glam::DVec3;
use isochore_mesh::TriMesh;

/// Edges with a dihedral angle above this are features and are kept (cosine of 40°).
const FLATTEST_FEATURE: f64 = 0.766;

/// Largest rotation of a face normal by a flip (cosine of 45°). Smaller values let folds through.
const MOST_TURN: f64 = 0.707;

/// Smallest angle that a flip may make, as a cosine (15°).
const SHARPEST: f64 = 0.966;

/// A mesh with its halfedges: halfedge `3 t + i` runs from corner `i` of triangle `t` to the next corner.
pub(crate) struct Flips<'a> {
    mesh: &'a mut TriMesh,
    /// The opposite halfedge of the same edge.
    twins: Vec<u32>,
    valences: Vec<u32>,
}

/// The two triangles of an edge: it runs from `a` to `b`, with `c` on its left and `d` on its right.
struct Diamond {
    vertices: [u32; 4],
    halfedge: u32,
    twin: u32,
}

impl<'a> Flips<'a> {
    /// # Panics
    /// If an edge does not have exactly two triangles: the grid is too coarse for the solid, or badly aligned with it.
    pub(crate) fn of(mesh: &'a mut TriMesh) -> Self {
        let mut valences = vec![0; mesh.positions.len()];
        let mut edges: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * mesh.triangles.len());
        for (halfedge, &from) in mesh.triangles.as_flattened().iter().enumerate() {
            let to = mesh.triangles[halfedge / 3][(halfedge + 1) % 3];
            valences[from as usize] += 1;
            edges.push((from.min(to), from.max(to), halfedge as u32));
        }
        edges.sort_unstable();
        let mut twins = vec![0; edges.len()];
        for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let &[(_, _, halfedge), (_, _, twin)] = edge else {
                panic!("{} triangles share the edge of vertices {} and {}", edge.len(), edge[0].0, edge[0].1)
            };
            twins[halfedge as usize] = twin;
            twins[twin as usize] = halfedge;
        }
        Self { mesh, twins, valences }
    }

    /// Flips edges if that brings valences closer to six, in one pass over the edges.
    pub(crate) fn improve_valences(&mut self) {
        self.flip_where(|flips, diamond| {
            let [a, b, c, d] = diamond.vertices.map(|vertex| i64::from(flips.valences[vertex as usize]) - 6);
            let square = |excess: i64| excess * excess;
            let now = square(a) + square(b) + square(c) + square(d);
            square(a - 1) + square(b - 1) + square(c + 1) + square(d + 1) < now
        });
    }

    /// Flips edges whose opposite angles sum to more than 180°, until none remains.
    pub(crate) fn make_delaunay(&mut self) {
        // Delaunay flips terminate in the plane; on a curved surface a few edges could alternate forever.
        const MOST_PASSES: usize = 20;
        for _ in 0..MOST_PASSES {
            let flipped = self.flip_where(|flips, diamond| {
                let [a, b, c, d] = flips.corners(diamond);
                let cotangent = |at: DVec3| (a - at).dot(b - at) / (a - at).cross(b - at).length();
                cotangent(c) + cotangent(d) < -1e-9
            });
            if flipped == 0 {
                break;
            }
        }
    }

    /// Flips the edges that `is_wanted` selects if the mesh stays valid, and returns their number.
    fn flip_where(&mut self, is_wanted: impl Fn(&Self, &Diamond) -> bool) -> usize {
        let mut flipped = 0;
        for halfedge in 0..self.twins.len() as u32 {
            let twin = self.twins[halfedge as usize];
            if halfedge < twin {
                let diamond = self.diamond(halfedge, twin);
                if is_wanted(self, &diamond) && self.is_sound(&diamond) {
                    self.flip(&diamond);
                    flipped += 1;
                }
            }
        }
        flipped
    }

    fn diamond(&self, halfedge: u32, twin: u32) -> Diamond {
        let vertices = [halfedge, next(halfedge), next(next(halfedge)), next(next(twin))];
        Diamond { vertices: vertices.map(|halfedge| self.from(halfedge)), halfedge, twin }
    }

    fn from(&self, halfedge: u32) -> u32 {
        self.mesh.triangles[halfedge as usize / 3][halfedge as usize % 3]
    }

    fn corners(&self, diamond: &Diamond) -> [DVec3; 4] {
        diamond.vertices.map(|vertex| self.mesh.positions[vertex as usize])
    }

    /// Whether a flip keeps the mesh manifold, preserves features and folds no face.
    fn is_sound(&self, diamond: &Diamond) -> bool {
        let [a, b, c, d] = self.corners(diamond);
        let normal = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).normalize_or_zero();
        let before = [normal(a, b, c), normal(b, a, d)];
        let after = [normal(c, d, b), normal(d, c, a)];
        let sharpest = |a: DVec3, b: DVec3, c: DVec3| {
            let cosine = |at: DVec3, p: DVec3, q: DVec3| (p - at).normalize_or_zero().dot((q - at).normalize_or_zero());
            cosine(a, b, c).max(cosine(b, c, a)).max(cosine(c, a, b))
        };
        let [vertex_a, vertex_b, vertex_c, vertex_d] = diamond.vertices;
        self.valences[vertex_a as usize] > 4
            && self.valences[vertex_b as usize] > 4
            && before[0].dot(before[1]) > FLATTEST_FEATURE
            && after.iter().all(|after| before.iter().all(|before| after.dot(*before) > MOST_TURN))
            && sharpest(c, d, b).max(sharpest(d, c, a)) < SHARPEST
            && !self.are_neighbors(vertex_c, vertex_d, diamond.halfedge)
    }

    /// Whether an edge joins `c` and `d`; `halfedge` is the one across from `c`.
    fn are_neighbors(&self, c: u32, d: u32, halfedge: u32) -> bool {
        let start = next(next(halfedge));
        debug_assert_eq!(self.from(start), c);
        let mut spoke = start;
        loop {
            if self.from(next(spoke)) == d {
                return true;
            }
            spoke = self.twins[next(next(spoke)) as usize];
            if spoke == start {
                return false;
            }
        }
    }

    /// Replaces the triangles a b c and b a d by c d b and d c a.
    fn flip(&mut self, diamond: &Diamond) {
        let &Diamond { vertices: [a, b, c, d], halfedge, twin } = diamond;
        let (first, second) = (halfedge / 3, twin / 3);
        let [bc, ca] = [next(halfedge), next(next(halfedge))].map(|side| self.twins[side as usize]);
        let [ad, db] = [next(twin), next(next(twin))].map(|side| self.twins[side as usize]);
        self.mesh.triangles[first as usize] = [c, d, b];
        self.mesh.triangles[second as usize] = [d, c, a];
        let sides = [3 * second, db, bc, 3 * first, ca, ad];
        for (i, &other) in sides.iter().enumerate() {
            let side = if i < 3 { 3 * first + i as u32 } else { 3 * second + i as u32 - 3 };
            self.twins[side as usize] = other;
            self.twins[other as usize] = side;
        }
        self.valences[a as usize] -= 1;
        self.valences[b as usize] -= 1;
        self.valences[c as usize] += 1;
        self.valences[d as usize] += 1;
    }
}

/// The halfedge after this one in its triangle.
fn next(halfedge: u32) -> u32 {
    if halfedge % 3 == 2 { halfedge - 2 } else { halfedge + 1 }
}
