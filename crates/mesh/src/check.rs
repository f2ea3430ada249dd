//! Defects of a mesh, by element.

use glam::DVec3;
use petgraph::unionfind::UnionFind;
use robust::{Coord, orient2d};

use crate::{Topology, TriMesh};

/// The defects of a mesh, each list in ascending order.
///
/// Triangles with an index out of range are excluded from the other checks.
///
/// ```
/// let mut mesh = isochore_mesh::primitives::icosphere(1.0, 0);
/// assert!(mesh.check().is_closed() && mesh.check().is_manifold());
/// mesh.triangles[3].swap(1, 2);
/// let check = mesh.check();
/// assert!(!check.is_oriented());
/// assert_eq!(check.misoriented_edges.len(), 3);
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Check {
    /// Number of triangles, valid or not.
    pub triangles: usize,
    /// Triangles with a vertex index out of range.
    pub out_of_range_triangles: Vec<u32>,
    /// Vertices with a coordinate that is infinite or NaN.
    pub non_finite_vertices: Vec<u32>,
    /// Triangles of exactly zero area: a repeated vertex, or collinear corners.
    pub degenerate_triangles: Vec<u32>,
    /// Triangles with the same three vertices as an earlier one, in either orientation.
    pub duplicate_triangles: Vec<u32>,
    /// Edges with one triangle.
    pub boundary_edges: Vec<[u32; 2]>,
    /// Edges with more than two triangles.
    pub non_manifold_edges: Vec<[u32; 2]>,
    /// Vertices whose triangles form more than one fan.
    pub non_manifold_vertices: Vec<u32>,
    /// Edges whose two triangles run along them in the same direction.
    pub misoriented_edges: Vec<[u32; 2]>,
}

impl Check {
    /// Whether the mesh has triangles and every edge has at least two of them.
    pub fn is_closed(&self) -> bool {
        self.triangles > 0 && self.out_of_range_triangles.is_empty() && self.boundary_edges.is_empty()
    }

    /// Whether neighboring triangles agree on the outside.
    pub fn is_oriented(&self) -> bool {
        self.out_of_range_triangles.is_empty() && self.misoriented_edges.is_empty()
    }

    /// Whether no edge has more than two triangles and no vertex more than one fan.
    pub fn is_manifold(&self) -> bool {
        self.out_of_range_triangles.is_empty()
            && self.non_manifold_edges.is_empty()
            && self.non_manifold_vertices.is_empty()
    }

    /// Whether all indices are in range and all coordinates finite.
    pub fn is_valid(&self) -> bool {
        self.out_of_range_triangles.is_empty() && self.non_finite_vertices.is_empty()
    }
}

impl TriMesh {
    /// Finds all defects that [`Check`] lists, in linear time. Degeneracy is tested exactly, except
    /// if products of coordinates underflow.
    pub fn check(&self) -> Check {
        let vertices = self.positions.len();
        let is_in_range = |triangle: &[u32; 3]| triangle.iter().all(|&vertex| (vertex as usize) < vertices);
        let out_of_range_triangles = indices_where(&self.triangles, |triangle| !is_in_range(triangle));
        let valid: Vec<[u32; 3]>;
        // Original indices of the valid triangles; empty if all are valid.
        let mut originals: Vec<u32> = Vec::new();
        let triangles = if out_of_range_triangles.is_empty() {
            &self.triangles
        } else {
            originals = indices_where(&self.triangles, is_in_range);
            valid = originals.iter().map(|&triangle| self.triangles[triangle as usize]).collect();
            &valid
        };
        let original = |triangle: u32| originals.get(triangle as usize).copied().unwrap_or(triangle);

        let topology = Topology::of_triangles(triangles, vertices);
        let mut check = Check {
            triangles: self.triangles.len(),
            out_of_range_triangles,
            non_finite_vertices: indices_where(&self.positions, |position| !position.is_finite()),
            degenerate_triangles: indices_where(triangles, |&triangle| self.is_degenerate(triangle)),
            duplicate_triangles: duplicates(triangles, &topology),
            ..Check::default()
        };
        for list in [&mut check.degenerate_triangles, &mut check.duplicate_triangles] {
            list.iter_mut().for_each(|triangle| *triangle = original(*triangle));
        }
        for (edge, &ends) in topology.edges.iter().enumerate() {
            match *topology.half_edges(edge) {
                [_] => check.boundary_edges.push(ends),
                [a, b] if start(triangles, a) == start(triangles, b) => check.misoriented_edges.push(ends),
                [_, _] => {}
                _ => check.non_manifold_edges.push(ends),
            }
        }
        check.non_manifold_vertices = vertices_with_several_fans(triangles, &topology, vertices);
        check
    }

    /// Whether the corners are collinear: exactly, except if products of coordinates underflow.
    fn is_degenerate(&self, triangle: [u32; 3]) -> bool {
        let [a, b, c] = triangle.map(|vertex| self.positions[vertex as usize]);
        // Three points are collinear if and only if their projections onto all coordinate planes
        // are.
        let is_collinear = |project: fn(DVec3) -> Coord<f64>| orient2d(project(a), project(b), project(c)) == 0.0;
        (a.is_finite() && b.is_finite() && c.is_finite())
            && is_collinear(|p| Coord { x: p.x, y: p.y })
            && is_collinear(|p| Coord { x: p.y, y: p.z })
            && is_collinear(|p| Coord { x: p.z, y: p.x })
    }
}

/// The start vertex of a half-edge.
pub(crate) fn start(triangles: &[[u32; 3]], half_edge: u32) -> u32 {
    triangles[half_edge as usize / 3][half_edge as usize % 3]
}

fn indices_where<T>(items: &[T], predicate: impl Fn(&T) -> bool) -> Vec<u32> {
    (0_u32..).zip(items).filter(|(_, item)| predicate(item)).map(|(index, _)| index).collect()
}

fn duplicates(triangles: &[[u32; 3]], topology: &Topology) -> Vec<u32> {
    let apex = |half_edge: u32| triangles[half_edge as usize / 3][(half_edge as usize + 2) % 3];
    let mut found = Vec::new();
    // Equal triangles have common edges, so it suffices to compare the third vertices around each
    // edge.
    for edge in 0..topology.edges.len() {
        match *topology.half_edges(edge) {
            [_] => {}
            [a, b] if apex(a) != apex(b) => {}
            ref around => {
                let mut apexes: Vec<_> = around.iter().map(|&half_edge| (apex(half_edge), half_edge / 3)).collect();
                apexes.sort_unstable();
                apexes.dedup();
                found.extend(apexes.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| pair[1].1));
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// Vertices whose corners form several classes when corners across each edge are united.
fn vertices_with_several_fans(triangles: &[[u32; 3]], topology: &Topology, vertices: usize) -> Vec<u32> {
    let corner_count = 3 * triangles.len();
    let mut fans_of_corners = UnionFind::<u32>::new(corner_count);
    let next = |half_edge: u32| half_edge - half_edge % 3 + (half_edge + 1) % 3;
    for edge in 0..topology.edges.len() {
        let around = topology.half_edges(edge);
        for &other in &around[1..] {
            let one = around[0];
            // The corners at each end of the edge in the two triangles. A half-edge has the index
            // of the corner that it starts from.
            let pairs = if start(triangles, one) == start(triangles, other) {
                [(one, other), (next(one), next(other))]
            } else {
                [(one, next(other)), (next(one), other)]
            };
            for (a, b) in pairs {
                fans_of_corners.union(a, b);
            }
        }
    }
    let mut fans = vec![0_u8; vertices];
    for corner in 0..corner_count as u32 {
        // Every set of corners belongs to one vertex, so it is counted once, at its representative.
        if fans_of_corners.find_mut(corner) == corner {
            let fan_count = &mut fans[start(triangles, corner) as usize];
            *fan_count = fan_count.saturating_add(1);
        }
    }
    indices_where(&fans, |&count| count > 1)
}
