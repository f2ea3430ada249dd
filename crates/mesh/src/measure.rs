//! Volume, area, lengths and angles.

use glam::DVec3;
use petgraph::unionfind::UnionFind;

use crate::compensated_sum::sum_terms;
use crate::{Aabb, Topology, TriMesh};

/// Shortest, mean and longest edge, in model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeLengths {
    /// Length of the shortest edge.
    pub min: f64,
    /// Mean over the edges, each counted once.
    pub mean: f64,
    /// Length of the longest edge.
    pub max: f64,
}

/// Connected components of a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Components {
    /// Number of components.
    pub count: usize,
    /// The component of each triangle. Components are numbered by first occurrence.
    pub of_triangle: Vec<u32>,
}

/// Signed volume inside `triangles`, which index `positions`; see [`TriMesh::volume`].
///
/// # Panics
/// If an index is out of range.
pub fn signed_volume(positions: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let frame = VolumeFrame::of(positions);
    let [six_volumes] = sum_terms(triangles.len(), |triangle| {
        [frame.six_volumes(triangles[triangle].map(|vertex| positions[vertex as usize]))]
    });
    frame.volume(six_volumes)
}

/// Measures. They panic if an index is out of range; [`TriMesh::check`] finds such triangles.
impl TriMesh {
    /// The bounding box of all vertices.
    pub fn bounds(&self) -> Aabb {
        Aabb::of(self.positions.iter().copied())
    }

    /// Signed volume in cubic model units, positive if triangles are counter-clockwise seen from
    /// outside.
    ///
    /// It is the compensated sum of the tetrahedra between the triangles and the center of
    /// [`bounds`](Self::bounds), with the same bits for any number of threads. For an open mesh it
    /// depends on that center and has no geometric meaning.
    ///
    /// ```
    /// use glam::DVec3;
    /// use isochore_mesh::primitives;
    ///
    /// let mesh = primitives::box_mesh(DVec3::new(1.0, 2.0, 3.0), [1, 1, 1]);
    /// assert_eq!(mesh.volume(), 48.0);
    /// assert_eq!(mesh.area(), 88.0);
    /// assert_eq!(mesh.volume_centroid(), DVec3::ZERO);
    /// ```
    pub fn volume(&self) -> f64 {
        signed_volume(&self.positions, &self.triangles)
    }

    /// Centroid of the enclosed volume, or the center of the bounds if the volume vanishes up to
    /// rounding.
    pub fn volume_centroid(&self) -> DVec3 {
        self.volume_and_centroid(self.bounds()).1
    }

    /// [`volume`](Self::volume) and [`volume_centroid`](Self::volume_centroid) in one pass, given
    /// `bounds`.
    pub(crate) fn volume_and_centroid(&self, bounds: Aabb) -> (f64, DVec3) {
        let frame = VolumeFrame::around(bounds);
        // Plain sums of a few terms lose a few bits of these terms, not of the total, and are
        // faster.
        let [six_volumes, x, y, z] = sum_terms(self.triangles.len().div_ceil(SUMMED_PLAINLY), |part| {
            let first = part * SUMMED_PLAINLY;
            let triangles = &self.triangles[first..self.triangles.len().min(first + SUMMED_PLAINLY)];
            let (mut six_volumes, mut moments) = (0.0, DVec3::ZERO);
            for triangle in triangles {
                let [a, b, c] = *triangle;
                let local = |vertex: u32| frame.local(self.positions[vertex as usize]);
                let (a, b, c) = (local(a), local(b), local(c));
                let six_volume = a.dot(b.cross(c));
                six_volumes += six_volume;
                moments += (a + b + c) * six_volume;
            }
            [six_volumes, moments.x, moments.y, moments.z]
        });
        let centroid = if six_volumes.abs() < NO_VOLUME {
            frame.center
        } else {
            frame.world(DVec3::new(x, y, z) / (4.0 * six_volumes))
        };
        (frame.volume(six_volumes), centroid)
    }

    /// Total area in square model units.
    pub fn area(&self) -> f64 {
        let frame = VolumeFrame::of(&self.positions);
        let [twice_area] = sum_terms(self.triangles.len(), |triangle| {
            let [a, b, c] = self.corners(triangle).map(|corner| frame.local(corner));
            [(b - a).cross(c - a).length()]
        });
        0.5 * twice_area * frame.scale * frame.scale
    }

    /// Lengths of the edges. `None` for a mesh without triangles.
    pub fn edge_lengths(&self) -> Option<EdgeLengths> {
        let edges = Topology::of(self).edges;
        if edges.is_empty() {
            return None;
        }
        let frame = VolumeFrame::of(&self.positions);
        let length = |edge: usize| {
            let [a, b] = edges[edge].map(|vertex| self.positions[vertex as usize]);
            ((b - a) / frame.scale).length()
        };
        let (mut min, mut max) = (f64::INFINITY, 0.0_f64);
        for edge in 0..edges.len() {
            (min, max) = (min.min(length(edge)), max.max(length(edge)));
        }
        let [sum] = sum_terms(edges.len(), |edge| [length(edge)]);
        let mean = sum / edges.len() as f64;
        Some(EdgeLengths { min: min * frame.scale, mean: mean * frame.scale, max: max * frame.scale })
    }

    /// Interior angles of `triangle` in radians, in the order of its vertices. Their sum is π
    /// unless two corners coincide.
    pub fn triangle_angles(&self, triangle: usize) -> [f64; 3] {
        let [a, b, c] = self.corners(triangle);
        [angle_between(b - a, c - a), angle_between(c - b, a - b), angle_between(a - c, b - c)]
    }

    /// Smallest and largest angle of any triangle, in radians. `None` for a mesh without triangles.
    pub fn angle_range(&self) -> Option<[f64; 2]> {
        let angles = (0..self.triangles.len()).flat_map(|triangle| self.triangle_angles(triangle));
        angles.fold(None, |range, angle| {
            let [min, max] = range.unwrap_or([angle; 2]);
            Some([min.min(angle), max.max(angle)])
        })
    }

    /// Connected components of the surface. Different components have no common vertex.
    ///
    /// ```
    /// use glam::DVec3;
    /// use isochore_mesh::TriMesh;
    ///
    /// let mesh = TriMesh::new(vec![DVec3::ZERO; 6], vec![[3, 4, 5], [0, 1, 2], [5, 4, 3]]);
    /// assert_eq!(mesh.components().count, 2);
    /// assert_eq!(mesh.components().of_triangle, [0, 1, 0]);
    /// ```
    pub fn components(&self) -> Components {
        let mut sets = UnionFind::<u32>::new(self.positions.len());
        for &[a, b, c] in &self.triangles {
            sets.union(a, b);
            sets.union(a, c);
        }
        // Numbers follow the order of the triangles, so they do not depend on the representatives.
        const UNNUMBERED: u32 = u32::MAX;
        let mut numbers = vec![UNNUMBERED; self.positions.len()];
        let mut count = 0;
        let mut of_triangle = Vec::with_capacity(self.triangles.len());
        for &[a, ..] in &self.triangles {
            let representative = sets.find_mut(a) as usize;
            if numbers[representative] == UNNUMBERED {
                numbers[representative] = count;
                count += 1;
            }
            of_triangle.push(numbers[representative]);
        }
        Components { count: count as usize, of_triangle }
    }

    /// Euler characteristic: used vertices − edges + triangles. It is 2 for a sphere and 0 for a
    /// torus.
    pub fn euler_characteristic(&self) -> i64 {
        let mut is_used = vec![false; self.positions.len()];
        self.triangles.iter().flatten().for_each(|&vertex| is_used[vertex as usize] = true);
        let vertices = is_used.into_iter().filter(|&used| used).count();
        vertices as i64 - Topology::of(self).edges.len() as i64 + self.triangles.len() as i64
    }
}

/// A mesh has no volume centroid if six times its volume, in units of the cubed scale of its
/// [`VolumeFrame`], is below this value. With a larger value thin sheets lose their centroid; with
/// a smaller one the centroid of a flat mesh is rounding noise outside of its bounds.
const NO_VOLUME: f64 = 1e-12;

/// Triangles whose moments are summed without compensation. With a larger value their rounding
/// errors accumulate; a smaller one is slower.
const SUMMED_PLAINLY: usize = 16;

/// Coordinates relative to the center of the bounds, in units of a power of two near their size.
/// Products of three coordinates of a huge or tiny mesh then neither overflow nor underflow. The
/// scaling is exact.
#[derive(Debug, Clone, Copy)]
pub struct VolumeFrame {
    center: DVec3,
    /// A power of two.
    scale: f64,
}

impl VolumeFrame {
    /// The frame about the center of the bounding box of `positions`.
    pub fn of(positions: &[DVec3]) -> Self {
        Self::around(Aabb::of(positions.iter().copied()))
    }

    /// The frame about the center of `bounds`.
    fn around(bounds: Aabb) -> Self {
        let center = 0.5 * bounds.min + 0.5 * bounds.max;
        let half_size = (0.5 * bounds.max - 0.5 * bounds.min).max_element();
        if !(half_size > 0.0 && half_size.is_finite()) {
            return Self { center: if center.is_finite() { center } else { DVec3::ZERO }, scale: 1.0 };
        }
        let (_, exponent) = libm::frexp(half_size);
        Self { center, scale: libm::ldexp(1.0, exponent.clamp(-1021, 1023)) }
    }

    /// Six times the signed volume of the tetrahedron between a triangle and the center, in units
    /// of the frame.
    pub fn six_volumes(&self, corners: [DVec3; 3]) -> f64 {
        let [a, b, c] = corners.map(|corner| self.local(corner));
        a.dot(b.cross(c))
    }

    /// Converts a sum of [`six_volumes`](Self::six_volumes) to a volume in cubic model units.
    pub fn volume(&self, six_volumes: f64) -> f64 {
        six_volumes / 6.0 * self.scale * self.scale * self.scale
    }

    /// Whether a box contains the center.
    pub fn is_centered_in(&self, bounds: Aabb) -> bool {
        bounds.distance(self.center) == 0.0
    }

    fn local(&self, point: DVec3) -> DVec3 {
        // As exact as a division, because the scale is a power of two.
        (point - self.center) * (1.0 / self.scale)
    }

    fn world(&self, point: DVec3) -> DVec3 {
        point * self.scale + self.center
    }
}

/// Angle between two vectors, 0 to π, accurate for small angles too. Zero if a vector is zero.
pub(crate) fn angle_between(u: DVec3, v: DVec3) -> f64 {
    let (u, v) = (of_unit_size(u), of_unit_size(v));
    libm::atan2(u.cross(v).length(), u.dot(v))
}

/// Unit normal of a triangle, or zero if its area is zero.
pub(crate) fn triangle_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    of_unit_size(b - a).cross(of_unit_size(c - a)).normalize_or_zero()
}

/// `vector` scaled to a largest component of one, so that its products neither overflow nor
/// underflow. Zero stays zero.
fn of_unit_size(vector: DVec3) -> DVec3 {
    let size = vector.abs().max_element();
    if size > 0.0 && size.is_finite() { vector / size } else { DVec3::ZERO }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};

    use super::*;
    use crate::primitives;

    #[test]
    fn box_measures_are_exact() {
        let mut mesh = primitives::box_mesh(DVec3::new(1.0, 2.0, 3.0), [1, 2, 3]);
        // A power of two, so that the translation is exact.
        let offset = DVec3::splat(1_048_576.0);
        mesh.positions.iter_mut().for_each(|position| *position += offset);
        assert_eq!(mesh.volume(), 48.0);
        assert_eq!(mesh.area(), 88.0);
        assert_eq!(mesh.volume_centroid(), offset);
        assert_eq!(
            mesh.bounds(),
            Aabb { min: offset - DVec3::new(1.0, 2.0, 3.0), max: offset + DVec3::new(1.0, 2.0, 3.0) }
        );
        assert_eq!(mesh.components().count, 1);
        let lengths = mesh.edge_lengths().unwrap();
        assert_eq!((lengths.min, lengths.max), (2.0, 2.0 * SQRT_2));
        assert_eq!(mesh.angle_range(), Some([FRAC_PI_4, FRAC_PI_2]));
    }

    #[test]
    fn centroid_of_a_tetrahedron_and_of_a_flat_mesh() {
        // The centroid of a tetrahedron is the mean of its corners.
        let corners = vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0, DVec3::Z * 4.0];
        let mut mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
        assert_eq!(mesh.volume_centroid(), DVec3::ONE);
        // A flat mesh has the center of its bounds.
        mesh.triangles.truncate(1);
        mesh.positions.truncate(3);
        assert_eq!(mesh.volume_centroid(), DVec3::new(2.0, 2.0, 0.0));
    }

    #[test]
    fn volume_is_accurate_far_from_the_origin() {
        // Coordinates on a grid of 2⁻²⁰, which a translation by 1024 preserves exactly.
        let mut mesh = primitives::icosphere(1.0, 5);
        let grid = f64::from(1 << 20);
        mesh.positions.iter_mut().for_each(|position| *position = (*position * grid).round() / grid);
        let volume = mesh.volume();
        mesh.positions.iter_mut().for_each(|position| *position += 1024.0);
        // The center of the bounds moves exactly, so the volume keeps its bits.
        assert_eq!(mesh.volume(), volume);
    }

    #[test]
    fn components_are_numbered_by_first_occurrence() {
        let positions = vec![DVec3::ZERO; 9];
        let mesh = TriMesh::new(positions, vec![[6, 7, 8], [0, 1, 2], [3, 4, 5], [2, 5, 1]]);
        let components = mesh.components();
        assert_eq!((components.count, components.of_triangle), (2, vec![0, 1, 1, 1]));
    }
}
