//! Closed, outward-oriented meshes of simple shapes.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, USizeVec3};
use rustc_hash::FxHashMap;

use crate::TriMesh;

/// A sphere about the origin: an icosahedron whose triangles are split into four, `subdivisions`
/// times.
///
/// It has 20 · 4ⁿ triangles for n subdivisions. Coordinates are computed on the unit sphere, then
/// scaled.
///
/// ```
/// let ball = isochore_mesh::primitives::icosphere(2.0, 3);
/// assert_eq!(ball.triangles.len(), 20 * 64);
/// assert!(ball.positions.iter().all(|position| (position.length() - 2.0).abs() < 1e-14));
/// ```
///
/// # Panics
/// If it would have more than 2³¹ vertices (above 13 subdivisions).
pub fn icosphere(radius: f64, subdivisions: u32) -> TriMesh {
    assert!(subdivisions <= 13, "an icosphere of {subdivisions} subdivisions has too many vertices");
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut positions: Vec<DVec3> = [
        [-1.0, golden, 0.0],
        [1.0, golden, 0.0],
        [-1.0, -golden, 0.0],
        [1.0, -golden, 0.0],
        [0.0, -1.0, golden],
        [0.0, 1.0, golden],
        [0.0, -1.0, -golden],
        [0.0, 1.0, -golden],
        [golden, 0.0, -1.0],
        [golden, 0.0, 1.0],
        [-golden, 0.0, -1.0],
        [-golden, 0.0, 1.0],
    ]
    .map(|corner| DVec3::from_array(corner).normalize())
    .to_vec();
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..subdivisions {
        let mut midpoints = FxHashMap::default();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for &[a, b, c] in &triangles {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[from, to]| {
                *midpoints.entry([from.min(to), from.max(to)]).or_insert_with(|| {
                    positions.push((positions[from as usize] + positions[to as usize]).normalize());
                    positions.len() as u32 - 1
                })
            });
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    positions.iter_mut().for_each(|position| *position *= radius);
    TriMesh::new(positions, triangles)
}

/// A sphere about the origin with its poles on the z axis, `longitude` segments around the axis and
/// `latitude` segments from pole to pole.
///
/// Each pole is one vertex; there are 2 · longitude · (latitude − 1) triangles.
///
/// # Panics
/// If `longitude` is below 3 or `latitude` below 2.
pub fn latitude_longitude_sphere(radius: f64, longitude: usize, latitude: usize) -> TriMesh {
    assert!(longitude >= 3 && latitude >= 2, "a sphere needs 3 segments around and 2 from pole to pole");
    let mut positions = vec![DVec3::new(0.0, 0.0, radius)];
    for ring in 1..latitude {
        let (sin_polar, cos_polar) = libm::sincos(PI * ring as f64 / latitude as f64);
        for segment in 0..longitude {
            let (sin, cos) = libm::sincos(TAU * segment as f64 / longitude as f64);
            positions.push(radius * DVec3::new(sin_polar * cos, sin_polar * sin, cos_polar));
        }
    }
    let last = positions.len() as u32;
    positions.push(DVec3::new(0.0, 0.0, -radius));

    let at = |ring: usize, segment: usize| (1 + (ring - 1) * longitude + segment % longitude) as u32;
    let mut triangles = Vec::with_capacity(2 * longitude * (latitude - 1));
    for segment in 0..longitude {
        triangles.push([0, at(1, segment), at(1, segment + 1)]);
    }
    for ring in 1..latitude - 1 {
        for segment in 0..longitude {
            let [a, b] = [at(ring, segment), at(ring + 1, segment)];
            let [c, d] = [at(ring + 1, segment + 1), at(ring, segment + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    for segment in 0..longitude {
        triangles.push([at(latitude - 1, segment), last, at(latitude - 1, segment + 1)]);
    }
    TriMesh::new(positions, triangles)
}

/// A box about the origin whose faces are grids of `segments` cells along x, y and z.
///
/// Faces have common vertices along the edges of the box. The diagonals of all cells of a face are
/// parallel.
///
/// ```
/// use glam::DVec3;
///
/// let mesh = isochore_mesh::primitives::box_mesh(DVec3::new(1.0, 0.5, 0.5), [4, 2, 2]);
/// assert_eq!(mesh.triangles.len(), 2 * (4 * 2 * 4 + 2 * 2 * 2));
/// assert_eq!(mesh.volume(), 2.0);
/// ```
///
/// # Panics
/// If a number of segments is zero.
pub fn box_mesh(half_extents: DVec3, segments: [usize; 3]) -> TriMesh {
    assert!(segments.iter().all(|&count| count > 0), "a box needs a segment along every axis");
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    let mut vertices = FxHashMap::default();
    let mut vertex_at = |cell: [usize; 3]| {
        *vertices.entry(cell).or_insert_with(|| {
            let fraction = USizeVec3::from_array(cell).as_dvec3() / USizeVec3::from_array(segments).as_dvec3();
            positions.push(half_extents * (2.0 * fraction - 1.0));
            positions.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        // u × v points along the axis: outward at the far face and inward at the near one.
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for is_far in [false, true] {
            for row in 0..segments[v] {
                for column in 0..segments[u] {
                    let mut corner = |du: usize, dv: usize| {
                        let mut cell = [0; 3];
                        cell[axis] = if is_far { segments[axis] } else { 0 };
                        cell[u] = column + du;
                        cell[v] = row + dv;
                        vertex_at(cell)
                    };
                    let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    triangles.extend(if is_far { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
                }
            }
        }
    }
    TriMesh::new(positions, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ClosedMesh;

    /// Volume of a mesh that is checked to be closed, oriented and free of defects.
    fn sound_volume(mesh: &TriMesh) -> f64 {
        let check = mesh.check();
        assert!(check.is_closed() && check.is_oriented() && check.is_manifold() && check.is_valid());
        assert!(check.degenerate_triangles.is_empty() && check.duplicate_triangles.is_empty());
        assert_eq!(mesh.euler_characteristic(), 2);
        ClosedMesh::new(mesh).unwrap().volume()
    }

    // The relative tolerance is 1e-14: coordinates are accurate to 2 ulp each, and a volume is
    // cubic in them. Golden volumes are independent computations in double precision.
    fn assert_golden(volume: f64, golden: f64) {
        assert!((volume - golden).abs() < 1e-14 * golden, "{volume} is not {golden}");
    }

    #[test]
    fn icospheres_have_golden_volumes() {
        let golden = [
            3.65871220851216,
            4.047044679978849,
            4.152740817093057,
            4.179738947994641,
            4.186524949278792,
            4.188223738179637,
        ];
        for (subdivisions, golden) in (1..).zip(golden) {
            let sphere = icosphere(1.0, subdivisions);
            assert_eq!(sphere.triangles.len(), 20 << (2 * subdivisions));
            assert_golden(sound_volume(&sphere), golden);
        }
        assert_golden(sound_volume(&icosphere(3.0, 2)), 27.0 * golden[1]);
    }

    #[test]
    fn latitude_longitude_sphere_has_golden_volume() {
        let sphere = latitude_longitude_sphere(1.0, 80, 71);
        assert_eq!(sphere.triangles.len(), 11_200);
        assert_golden(sound_volume(&sphere), 4.182437273960657);
        sound_volume(&latitude_longitude_sphere(1.0, 3, 2));
    }

    #[test]
    fn box_has_exact_volume() {
        let mesh = box_mesh(DVec3::ONE, [40, 60, 60]);
        assert_eq!(mesh.triangles.len(), 2 * 2 * (40 * 60 + 60 * 60 + 60 * 40));
        assert_golden(sound_volume(&mesh), 8.0);
        assert_eq!(sound_volume(&box_mesh(DVec3::new(1.0, 2.0, 0.5), [1, 1, 1])), 8.0);
    }

    /// The twist by a total of 90° moves every vertex exactly, so only the facets change the
    /// volume. The change depends on the diagonals of the cells.
    #[test]
    fn twisted_box_has_golden_facet_error() {
        let mut mesh = box_mesh(DVec3::ONE, [40, 60, 60]);
        for position in &mut mesh.positions {
            let (sin, cos) = libm::sincos(PI / 4.0 * position.z);
            *position =
                DVec3::new(cos * position.x - sin * position.y, sin * position.x + cos * position.y, position.z);
        }
        let change = (mesh.volume() - 8.0) / 8.0;
        // The golden value is given to seven digits.
        assert!((change - -1.142250e-4).abs() < 0.5e-10, "{change:e}");
    }
}
