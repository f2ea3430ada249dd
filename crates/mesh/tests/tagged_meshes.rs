//! A table of meshes with their known properties, and every operation on all of them.

use glam::{DQuat, DVec3, DVec4, Vec2, Vec3};
#[cfg(feature = "io")]
use isochore_mesh::io::{self, Format};
use isochore_mesh::{ClosedMesh, MeshError, SubTriangle, Subdivision, Topology, TriMesh, primitives};

struct Tagged {
    name: &'static str,
    mesh: TriMesh,
    is_closed: bool,
    is_oriented: bool,
    is_manifold: bool,
    is_valid: bool,
    degenerate: &'static [u32],
    duplicate: &'static [u32],
    components: usize,
    /// The error of [`ClosedMesh::new`].
    defect: Option<MeshError>,
}

impl Tagged {
    /// A mesh without defects, except those that are set afterwards.
    fn sound(name: &'static str, mesh: TriMesh) -> Self {
        Self {
            name,
            mesh,
            is_closed: true,
            is_oriented: true,
            is_manifold: true,
            is_valid: true,
            degenerate: &[],
            duplicate: &[],
            components: 1,
            defect: None,
        }
    }
}

fn tetrahedron() -> TriMesh {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    TriMesh::new(positions, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
}

/// Two copies of `mesh`, the second moved by `offset`.
fn twice(mesh: &TriMesh, offset: DVec3) -> TriMesh {
    let count = mesh.positions.len() as u32;
    let moved = mesh.positions.iter().map(|&position| position + offset);
    let renumbered = mesh.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + count));
    TriMesh::new(
        mesh.positions.iter().copied().chain(moved).collect(),
        mesh.triangles.iter().copied().chain(renumbered).collect(),
    )
}

fn seamed() -> TriMesh {
    let mut mesh = primitives::box_mesh(DVec3::ONE, [2, 2, 2]);
    let corners = mesh.triangles.len();
    mesh.corner.uvs = vec![(0..corners).map(|t| [0.0, 0.25, 0.5].map(|u| Vec2::new(u, t as f32))).collect()];
    mesh.corner.normals = (0..corners)
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            [(b - a).cross(c - a).normalize().as_vec3(); 3]
        })
        .collect();
    mesh.corner.colors = vec![[DVec4::ONE, DVec4::ZERO, DVec4::X]; corners];
    mesh.vertex.skin = (0..mesh.positions.len() as u32).map(|v| vec![(v % 3, 0.5), (v % 2 + 3, 0.5)]).collect();
    mesh.materials = vec!["a".into(), "b".into()];
    mesh.triangle_materials = (0..corners as u32).map(|t| t % 2).collect();
    mesh
}

fn table() -> Vec<Tagged> {
    let open = {
        let mut mesh = tetrahedron();
        mesh.triangles.pop();
        Tagged {
            is_closed: false,
            defect: Some(MeshError::Open { edge: [1, 2], triangle: 0 }),
            ..Tagged::sound("open", mesh)
        }
    };
    let misoriented = {
        let mut mesh = tetrahedron();
        mesh.triangles[3] = [1, 3, 2];
        Tagged {
            is_oriented: false,
            defect: Some(MeshError::Misoriented { edge: [1, 2], triangles: [0, 3] }),
            ..Tagged::sound("misoriented", mesh)
        }
    };
    let fin = {
        let mut mesh = tetrahedron();
        mesh.positions.push(DVec3::ONE);
        mesh.triangles.push([1, 2, 4]);
        Tagged {
            is_closed: false,
            is_manifold: false,
            defect: Some(MeshError::NonManifoldEdge { edge: [1, 2], triangles: 3 }),
            ..Tagged::sound("three triangles at an edge", mesh)
        }
    };
    let pinched = {
        let two = twice(&tetrahedron(), DVec3::ZERO);
        let mut mesh = TriMesh::new(two.positions, two.triangles);
        mesh.positions[5..].iter_mut().for_each(|position| *position = -*position);
        mesh.triangles[4..].iter_mut().for_each(|triangle| triangle.swap(1, 2));
        mesh.triangles.iter_mut().flatten().filter(|vertex| **vertex == 4).for_each(|vertex| *vertex = 0);
        Tagged { is_manifold: false, ..Tagged::sound("two fans at a vertex", mesh) }
    };
    let degenerate = {
        let mut mesh = tetrahedron();
        // A corner on the edge from 0 to 1, and the triangle of no area between them.
        mesh.positions.push(DVec3::X * 0.25);
        mesh.triangles[0] = [0, 2, 4];
        mesh.triangles.push([4, 2, 1]);
        mesh.triangles.push([0, 4, 1]);
        Tagged { degenerate: &[5], ..Tagged::sound("zero area", mesh) }
    };
    let collapsed = {
        let mut mesh = tetrahedron();
        mesh.triangles.push([2, 2, 3]);
        Tagged {
            is_closed: false,
            is_manifold: false,
            degenerate: &[4],
            defect: Some(MeshError::RepeatedVertex { triangle: 4, vertex: 2 }),
            ..Tagged::sound("a vertex named twice", mesh)
        }
    };
    let duplicate = {
        let mut mesh = tetrahedron();
        mesh.triangles.push([2, 1, 0]);
        Tagged {
            is_manifold: false,
            duplicate: &[4],
            defect: Some(MeshError::NonManifoldEdge { edge: [0, 1], triangles: 3 }),
            ..Tagged::sound("duplicate triangle", mesh)
        }
    };
    let out_of_range = {
        let mut mesh = tetrahedron();
        mesh.triangles[2][1] = 4;
        Tagged {
            is_closed: false,
            is_oriented: false,
            is_manifold: false,
            is_valid: false,
            defect: Some(MeshError::IndexOutOfRange { triangle: 2, index: 4, vertices: 4 }),
            ..Tagged::sound("index out of range", mesh)
        }
    };
    let infinite = {
        let mut mesh = tetrahedron();
        mesh.positions[3].x = f64::INFINITY;
        let position = mesh.positions[3];
        Tagged {
            is_valid: false,
            defect: Some(MeshError::NonFinite { vertex: 3, position }),
            ..Tagged::sound("infinite coordinate", mesh)
        }
    };
    let empty = Tagged {
        is_closed: false,
        components: 0,
        defect: Some(MeshError::Empty),
        ..Tagged::sound("empty", TriMesh::default())
    };
    let scaled = |name, scale| {
        Tagged::sound(name, primitives::icosphere(1.0, 2).transformed(scale, DQuat::IDENTITY, DVec3::ZERO))
    };
    let two = twice(&tetrahedron(), DVec3::X * 3.0);
    vec![
        Tagged::sound("closed", tetrahedron()),
        Tagged::sound("seamed", seamed()),
        Tagged { components: 2, ..Tagged::sound("two components", two) },
        scaled("huge", 1e300),
        scaled("tiny", 1e-300),
        open,
        misoriented,
        fin,
        pinched,
        degenerate,
        collapsed,
        duplicate,
        out_of_range,
        infinite,
        empty,
    ]
}

/// The valid meshes of the table.
fn valid() -> impl Iterator<Item = Tagged> {
    table().into_iter().filter(|tagged| tagged.is_valid)
}

#[test]
fn check_finds_the_known_defects() {
    for tagged in table() {
        let check = tagged.mesh.check();
        let found = (check.is_closed(), check.is_oriented(), check.is_manifold(), check.is_valid());
        let expected = (tagged.is_closed, tagged.is_oriented, tagged.is_manifold, tagged.is_valid);
        assert_eq!(found, expected, "{}: closed, oriented, manifold, valid", tagged.name);
        // Products of the tiniest coordinates underflow, so that all triangles seem degenerate.
        if tagged.name != "tiny" {
            assert_eq!(check.degenerate_triangles, tagged.degenerate, "{}", tagged.name);
        }
        assert_eq!(check.duplicate_triangles, tagged.duplicate, "{}", tagged.name);
    }
}

#[test]
fn closed_mesh_names_the_defect() {
    for tagged in table() {
        assert_eq!(ClosedMesh::new(&tagged.mesh).err(), tagged.defect, "{}", tagged.name);
        if let Some(defect) = tagged.defect {
            assert_eq!(defect.to_string().lines().count(), 1);
        }
    }
}

#[test]
fn measures_are_numbers() {
    for Tagged { name, mesh, components, .. } in valid() {
        for measure in [mesh.volume(), mesh.area(), mesh.volume_centroid().length()] {
            assert!(!measure.is_nan(), "{name}");
        }
        assert!(mesh.edge_lengths().is_none_or(|lengths| lengths.min <= lengths.mean && lengths.mean <= lengths.max));
        assert!(mesh.angle_range().is_none_or(|[min, max]| 0.0 <= min && max <= std::f64::consts::PI));
        assert_eq!(mesh.components().count, components, "{name}");
        assert!(mesh.vertex_normals().iter().all(|normal| normal.is_finite()), "{name}");
    }
}

#[test]
fn measures_scale_exactly_with_size() {
    let unit = primitives::icosphere(1.0, 2);
    for exponent in [900, -900] {
        let scale = 2.0_f64.powi(exponent);
        let mesh = unit.transformed(scale, DQuat::IDENTITY, DVec3::ZERO);
        // Scaling by a power of two is exact, so all measures scale without a changed bit.
        let lengths = mesh.edge_lengths().unwrap();
        assert_eq!(lengths.mean / scale, unit.edge_lengths().unwrap().mean);
        assert_eq!(mesh.angle_range(), unit.angle_range());
        assert_eq!(mesh.vertex_normals(), unit.vertex_normals());
        assert_eq!(mesh.volume_centroid() / scale, unit.volume_centroid());
    }
}

#[test]
fn flipping_negates_the_volume() {
    for Tagged { name, mesh, .. } in valid() {
        let volume = mesh.volume();
        assert_eq!(mesh.flipped().volume(), -volume, "{name}");
    }
}

#[test]
fn similarity_scales_the_volume() {
    for Tagged { name, mesh, defect, .. } in valid() {
        // The volume of other meshes depends on the center of their bounds.
        if matches!(name, "huge" | "tiny") || defect.is_some() {
            continue;
        }
        let rotation = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, 1.0);
        let volume = mesh.volume();
        for scale in [2.0, -2.0] {
            let moved = mesh.transformed(scale, rotation, DVec3::splat(1e3)).volume();
            // Positions near 1e3 are rounded by 1e-13, which changes the volume by that times the
            // area.
            assert!((moved - 8.0 * volume).abs() < 1e-11, "{name}: {moved}");
        }
    }
}

/// Splits each triangle into four at the midpoints of its edges.
fn in_four(mesh: &TriMesh) -> Subdivision {
    let topology = Topology::of(mesh);
    let count = mesh.positions.len() as u32;
    let midpoint = |ends: &[u32; 2]| {
        let [a, b] = ends.map(|vertex| mesh.positions[vertex as usize]);
        0.5 * a + 0.5 * b
    };
    let positions = mesh.positions.iter().copied().chain(topology.edges.iter().map(midpoint)).collect();
    let mut triangles = Vec::new();
    for (parent, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        let [ab, bc, ca] = topology.triangle_edges(parent).map(|edge| edge + count);
        let corner = [DVec3::X, DVec3::Y, DVec3::Z];
        let [mid_ab, mid_bc, mid_ca] = [(0, 1), (1, 2), (2, 0)].map(|(i, k)| 0.5 * corner[i] + 0.5 * corner[k]);
        let parent = parent as u32;
        triangles.extend(
            [
                ([a, ab, ca], [corner[0], mid_ab, mid_ca]),
                ([b, bc, ab], [corner[1], mid_bc, mid_ab]),
                ([c, ca, bc], [corner[2], mid_ca, mid_bc]),
                ([ab, bc, ca], [mid_ab, mid_bc, mid_ca]),
            ]
            .map(|(vertices, corners)| SubTriangle { vertices, parent, corners }),
        );
    }
    Subdivision { positions, triangles }
}

#[test]
fn subdivision_keeps_shape_and_topology() {
    for Tagged { name, mesh, .. } in valid() {
        let finer = mesh.subdivided(&in_four(&mesh));
        let (before, after) = (mesh.check(), finer.check());
        assert_eq!(after.triangles, 4 * before.triangles);
        if name == "a vertex named twice" {
            // An edge from a vertex to itself cannot be halved.
            continue;
        }
        assert_eq!(after.is_closed(), before.is_closed(), "{name}");
        assert_eq!(after.is_oriented(), before.is_oriented(), "{name}");
        if before.duplicate_triangles.is_empty() {
            // The inner edges of duplicates coincide.
            assert_eq!(finer.euler_characteristic(), mesh.euler_characteristic(), "{name}");
        }
        if before.is_closed() {
            let (before, after) = (mesh.volume(), finer.volume());
            // Both sums are accurate to a few roundings of their terms, which do not cancel. Both
            // overflow alike.
            assert!(before == after || (after - before).abs() <= 1e-14 * before.abs(), "{name}");
        }
    }
}

#[test]
fn subdivision_interpolates_attributes_once() {
    let mesh = seamed();
    let finer = mesh.subdivided(&in_four(&mesh));
    for (child, triangle) in finer.triangles.chunks_exact(4).enumerate() {
        let first = 4 * child;
        assert_eq!(finer.corner.uvs[0][first][0], mesh.corner.uvs[0][child][0]);
        let [a, b, _] = mesh.corner.uvs[0][child];
        assert_eq!(finer.corner.uvs[0][first][1], 0.5 * (a + b));
        assert_eq!(finer.corner.colors[first][1], 0.5 * (DVec4::ONE + DVec4::ZERO));
        assert!(finer.corner.normals[first..first + 4].iter().flatten().all(|n| *n == mesh.corner.normals[child][0]));
        assert!(finer.triangle_materials[first..first + 4].iter().all(|m| *m == mesh.triangle_materials[child]));
        assert_eq!(triangle[0][0], mesh.triangles[child][0]);
    }
    assert_eq!(finer.vertex.skin[..mesh.positions.len()], mesh.vertex.skin);
    for influences in &finer.vertex.skin {
        assert!(influences.len() <= 2);
        let total: f64 = influences.iter().map(|(_, weight)| weight).sum();
        // Two or three roundings of numbers below one.
        assert!((total - 1.0).abs() < 4.0 * f64::EPSILON);
    }
}

/// If attributes are equal on both sides at the ends of an edge, so they are at a new vertex on it.
#[test]
fn subdivision_opens_no_seam() {
    let mut mesh = primitives::icosphere(1.0, 1);
    let normals = mesh.vertex_normals();
    mesh.corner.normals = mesh.triangles.iter().map(|t| t.map(|v| normals[v as usize].as_vec3())).collect();
    mesh.corner.uvs =
        vec![mesh.triangles.iter().map(|t| t.map(|v| normals[v as usize].truncate().as_vec2())).collect()];
    let finer = mesh.subdivided(&in_four(&mesh));
    let mut at_vertex = vec![None; finer.positions.len()];
    for (triangle, vertices) in finer.triangles.iter().enumerate() {
        for (corner, &vertex) in vertices.iter().enumerate() {
            let value = (finer.corner.normals[triangle][corner], finer.corner.uvs[0][triangle][corner]);
            assert_eq!(*at_vertex[vertex as usize].get_or_insert(value), value);
        }
    }
}

#[test]
fn welding_undoes_vertex_splits() {
    for Tagged { name, mesh, .. } in valid() {
        let corners = mesh.triangles.iter().flatten().map(|&vertex| mesh.positions[vertex as usize]).collect();
        let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let soup = TriMesh::new(corners, triangles);
        let has_collapsed = name == "a vertex named twice";
        for welded in [soup.clone().welded(), soup.welded_at_boundary()] {
            assert_eq!(welded.triangles.len() + usize::from(has_collapsed), mesh.triangles.len(), "{name}");
            assert_eq!(welded.volume(), mesh.volume(), "{name}");
            if !has_collapsed {
                assert_eq!(welded.check().is_closed(), mesh.check().is_closed(), "{name}");
            }
        }
    }
}

#[test]
fn differing_colors_move_to_the_corners_on_welding() {
    let mut mesh = TriMesh::new(
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X, DVec3::ZERO, -DVec3::Y],
        vec![[0, 1, 2], [3, 4, 5]],
    );
    mesh.vertex.colors = (0..6).map(|vertex| DVec4::splat(f64::from(vertex))).collect();
    let welded = mesh.welded();
    assert_eq!(welded.positions.len(), 4);
    assert!(welded.vertex.colors.is_empty());
    assert_eq!(welded.corner.colors, [[0.0, 1.0, 2.0].map(DVec4::splat), [3.0, 4.0, 5.0].map(DVec4::splat)]);
}

#[test]
fn turned_normals_keep_hard_edges_and_smooth_ones() {
    // A rotated box: every corner keeps the normal of its face.
    let mut mesh = seamed();
    let rotation = DQuat::from_axis_angle(DVec3::new(2.0, 1.0, 2.0) / 3.0, 2.0);
    let (rest, before) = (mesh.positions.clone(), mesh.corner.normals.clone());
    mesh.positions.iter_mut().for_each(|position| *position = rotation * *position);
    mesh.turn_normals(&rest);
    for (before, after) in before.iter().flatten().zip(mesh.corner.normals.iter().flatten()) {
        // Each of three components is rounded twice, by half an ulp.
        assert!(after.as_dvec3().distance(rotation * before.as_dvec3()) < f64::from(f32::EPSILON));
    }

    // One half of a smooth sphere is stretched: it gets the new vertex normals, the other half is
    // unchanged.
    let mut sphere = primitives::icosphere(1.0, 3);
    let radial = sphere.vertex_normals();
    sphere.corner.normals = sphere.triangles.iter().map(|t| t.map(|v| radial[v as usize].as_vec3())).collect();
    let (rest, before) = (sphere.positions.clone(), sphere.corner.normals.clone());
    sphere.positions.iter_mut().for_each(|position| position.z *= if position.z > 0.0 { 2.0 } else { 1.0 });
    sphere.turn_normals(&rest);
    let expected = sphere.vertex_normals();
    let mut kept = 0;
    for (triangle, vertices) in sphere.triangles.iter().enumerate() {
        for (corner, &vertex) in vertices.iter().enumerate() {
            let normal = sphere.corner.normals[triangle][corner];
            // The radial and the rotated normal are both rounded to single precision, by half an
            // ulp per component.
            assert!(normal.as_dvec3().distance(expected[vertex as usize]) < 2.0 * f64::from(f32::EPSILON));
            kept += usize::from(normal == before[triangle][corner]);
        }
    }
    // The lower half, except the corners next to the equator.
    assert!((1500..1920).contains(&kept), "{kept}");

    let mut bare = tetrahedron();
    bare.turn_normals(&bare.positions.clone());
    assert!(bare.corner.normals.is_empty());
}

/// Authored normals, which differ from the mean of the facets, are rotated with it.
#[test]
fn authored_normals_keep_their_character() {
    let mut mesh = tetrahedron();
    let authored = Vec3::new(2.0, 3.0, 6.0) / 7.0;
    mesh.corner.normals = vec![[authored; 3]; 4];
    let rest = mesh.positions.clone();
    mesh.turn_normals(&rest);
    assert_eq!(mesh.corner.normals, [[authored; 3]; 4]);
    mesh.positions.iter_mut().for_each(|position| *position = DVec3::new(-position.y, position.x, position.z));
    mesh.corner.normals[0] = [Vec3::NEG_Z; 3];
    mesh.turn_normals(&rest);
    // The normal below is on the axis of the quarter turn; its rounding is that of one rotation.
    assert!(mesh.corner.normals[0].iter().all(|normal| normal.distance(Vec3::NEG_Z) < f32::EPSILON));
    assert!(mesh.corner.normals[3].iter().all(|normal| normal.is_normalized() && *normal != authored));
}

#[cfg(feature = "io")]
#[test]
fn every_format_accepts_every_valid_mesh_or_reports_an_error() {
    for Tagged { name, mesh, .. } in table() {
        for format in [Format::Obj, Format::Gltf, Format::Glb, Format::Ply, Format::Stl, Format::Off] {
            let mut bytes = Vec::new();
            match io::write_to(format, &mesh, &mut bytes) {
                Ok(()) => match io::read_bytes(format, &bytes) {
                    Ok(read) => assert!(read.check().is_valid(), "{name} {format:?}"),
                    // No triangles, or all of them collapsed in single precision.
                    Err(error) => assert!(matches!(name, "empty" | "tiny"), "{name} {format:?}: {error}"),
                },
                Err(error) => {
                    let is_expected = !mesh.check().is_valid() || name == "huge";
                    assert!(is_expected, "{name} {format:?}: {error}");
                }
            }
        }
    }
}
