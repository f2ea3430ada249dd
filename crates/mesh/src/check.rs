//! What may be wrong with a mesh, by element.

use glam::DVec3;
use robust::{Coord, orient2d};

use crate::{Topology, TriMesh};

/// Everything found wrong with a mesh, each list in ascending order.
///
/// Triangles with an index out of range take no part in the other checks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Check {
    /// Triangles of the mesh, sound or not.
    pub triangles: usize,
    /// Triangles that name a vertex which does not exist.
    pub out_of_range_triangles: Vec<u32>,
    /// Vertices with a coordinate that is infinite or not a number.
    pub non_finite_vertices: Vec<u32>,
    /// Triangles of exactly zero area: a vertex named twice, or corners on one line.
    pub degenerate_triangles: Vec<u32>,
    /// Triangles over the same three vertices as an earlier one, turned either way.
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
    /// True where every edge has at least two triangles and there are triangles at all.
    pub fn is_closed(&self) -> bool {
        self.triangles > 0 && self.out_of_range_triangles.is_empty() && self.boundary_edges.is_empty()
    }

    /// True where neighbors agree on which side is outside.
    pub fn is_oriented(&self) -> bool {
        self.out_of_range_triangles.is_empty() && self.misoriented_edges.is_empty()
    }

    /// True where no edge has more than two triangles and no vertex more than one fan.
    pub fn is_manifold(&self) -> bool {
        self.out_of_range_triangles.is_empty()
            && self.non_manifold_edges.is_empty()
            && self.non_manifold_vertices.is_empty()
    }

    /// True where indices and coordinates can be computed with.
    pub fn is_valid(&self) -> bool {
        self.out_of_range_triangles.is_empty() && self.non_finite_vertices.is_empty()
    }
}

impl TriMesh {
    /// Looks for everything that [`Check`] lists. Takes time linear in the size of the mesh.
    pub fn check(&self) -> Check {
        let vertices = self.positions.len();
        let is_in_range = |triangle: &[u32; 3]| triangle.iter().all(|&vertex| (vertex as usize) < vertices);
        let out_of_range_triangles = indices_where(&self.triangles, |triangle| !is_in_range(triangle));
        let sound: Vec<[u32; 3]>;
        // Numbers of the sound triangles, where they are not all.
        let mut numbers: Vec<u32> = Vec::new();
        let triangles = if out_of_range_triangles.is_empty() {
            &self.triangles
        } else {
            numbers = indices_where(&self.triangles, is_in_range);
            sound = numbers.iter().map(|&triangle| self.triangles[triangle as usize]).collect();
            &sound
        };
        let number = |triangle: u32| numbers.get(triangle as usize).copied().unwrap_or(triangle);

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
            list.iter_mut().for_each(|triangle| *triangle = number(*triangle));
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

    /// Exact, but for products that underflow.
    fn is_degenerate(&self, triangle: [u32; 3]) -> bool {
        let [a, b, c] = triangle.map(|vertex| self.positions[vertex as usize]);
        let lies_on_line = |project: fn(DVec3) -> Coord<f64>| orient2d(project(a), project(b), project(c)) == 0.0;
        (a.is_finite() && b.is_finite() && c.is_finite())
            && lies_on_line(|p| Coord { x: p.x, y: p.y })
            && lies_on_line(|p| Coord { x: p.y, y: p.z })
            && lies_on_line(|p| Coord { x: p.z, y: p.x })
    }
}

/// The vertex that a half-edge starts from.
pub(crate) fn start(triangles: &[[u32; 3]], half_edge: u32) -> u32 {
    triangles[half_edge as usize / 3][half_edge as usize % 3]
}

fn indices_where<T>(items: &[T], is_wanted: impl Fn(&T) -> bool) -> Vec<u32> {
    (0_u32..).zip(items).filter(|(_, item)| is_wanted(item)).map(|(index, _)| index).collect()
}

fn duplicates(triangles: &[[u32; 3]], topology: &Topology) -> Vec<u32> {
    let apex = |half_edge: u32| triangles[half_edge as usize / 3][(half_edge as usize + 2) % 3];
    let mut found = Vec::new();
    // Equal triangles share their edges, so it is enough to compare the third vertices around each edge.
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

/// Vertices whose corners fall into several classes when corners across a shared edge are made one.
fn vertices_with_several_fans(triangles: &[[u32; 3]], topology: &Topology, vertices: usize) -> Vec<u32> {
    let corner_count = 3 * triangles.len();
    let mut parents: Vec<u32> = (0..corner_count as u32).collect();
    fn root(parents: &mut [u32], mut corner: u32) -> u32 {
        while parents[corner as usize] != corner {
            parents[corner as usize] = parents[parents[corner as usize] as usize];
            corner = parents[corner as usize];
        }
        corner
    }
    let next = |half_edge: u32| half_edge - half_edge % 3 + (half_edge + 1) % 3;
    for edge in 0..topology.edges.len() {
        let around = topology.half_edges(edge);
        for &other in &around[1..] {
            let one = around[0];
            // The corner at each end of the edge, in either triangle; a half-edge shares its number with its first corner.
            let pairs = match start(triangles, one) == start(triangles, other) {
                true => [(one, other), (next(one), next(other))],
                false => [(one, next(other)), (next(one), other)],
            };
            for (a, b) in pairs {
                let (a, b) = (root(&mut parents, a), root(&mut parents, b));
                parents[a.max(b) as usize] = a.min(b);
            }
        }
    }
    let mut fans = vec![0_u8; vertices];
    for corner in 0..corner_count as u32 {
        if parents[corner as usize] == corner {
            let fan_count = &mut fans[start(triangles, corner) as usize];
            *fan_count = fan_count.saturating_add(1);
        }
    }
    indices_where(&fans, |&count| count > 1)
}
