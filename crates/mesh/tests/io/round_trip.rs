use std::sync::Arc;

use glam::{DVec3, DVec4, Vec2};
use isochore_mesh::io::Format;
use isochore_mesh::{Assets, TriMesh, primitives};
use proptest::array::uniform3;
use proptest::prelude::*;

use crate::{FORMATS, reread, seamed_box};

/// The part of `mesh` that `format` stores.
fn kept(format: Format, mesh: &TriMesh) -> TriMesh {
    let mut kept = format.stored(mesh);
    if matches!(format, Format::Stl | Format::Off) {
        return TriMesh::new(kept.positions, kept.triangles);
    }
    if format == Format::Ply {
        kept.triangle_materials.clear();
        kept.materials.clear();
    }
    kept
}

/// `mesh` with its vertices numbered by first use, as a reader of STL numbers them.
fn numbered_by_use(mesh: &TriMesh) -> TriMesh {
    let mut numbers = vec![None; mesh.positions.len()];
    let mut positions = Vec::new();
    let mut number = |vertex: u32| {
        *numbers[vertex as usize].get_or_insert_with(|| {
            positions.push(mesh.positions[vertex as usize]);
            positions.len() as u32 - 1
        })
    };
    let triangles = mesh.triangles.iter().map(|triangle| triangle.map(&mut number)).collect();
    TriMesh::new(positions, triangles)
}

fn assert_round_trips(format: Format, mesh: &TriMesh) {
    let mut expected = kept(format, mesh);
    if format == Format::Stl {
        expected = numbered_by_use(&expected);
    }
    let mut found = reread(format, mesh);
    // Names of materials become carried assets.
    found.assets = Assets::default();
    assert_eq!(found, expected, "{format:?}");
}

#[test]
fn bare_mesh_round_trips_exactly() {
    for format in FORMATS {
        assert_round_trips(format, &primitives::icosphere(0.1, 3));
        assert_round_trips(format, &primitives::latitude_longitude_sphere(1e10, 9, 5));
    }
}

#[test]
fn seams_colors_and_materials_round_trip() {
    let mesh = seamed_box();
    assert!(mesh.check().is_closed());
    for format in FORMATS {
        assert_round_trips(format, &mesh);
        assert!(reread(format, &mesh).check().is_closed());
    }
}

#[test]
fn corner_colors_round_trip() {
    let mut mesh = seamed_box();
    mesh.vertex.colors.clear();
    mesh.corner.colors = (0..mesh.triangles.len()).map(|t| [DVec4::new(t as f64 / 64.0, 0.0, 1.0, 0.5); 3]).collect();
    for format in [Format::Glb, Format::Gltf, Format::Ply] {
        assert_round_trips(format, &mesh);
    }
    // Multiples of 1/255 are written as bytes.
    mesh.corner.colors = (0..mesh.triangles.len()).map(|t| [DVec4::splat(t as f64 / 255.0); 3]).collect();
    assert_round_trips(Format::Ply, &mesh);
}

#[test]
fn smooth_attributes_round_trip_without_splitting() {
    let mut mesh = primitives::icosphere(1.0, 2);
    let normals = mesh.vertex_normals();
    mesh.corner.normals = mesh.triangles.iter().map(|t| t.map(|v| normals[v as usize].as_vec3())).collect();
    for format in [Format::Obj, Format::Ply] {
        assert_round_trips(format, &mesh);
    }
    let found = reread(Format::Glb, &mesh);
    assert_eq!(found.positions, Format::Glb.stored(&mesh).positions);
    for (found, expected) in found.corner.normals.iter().flatten().zip(mesh.corner.normals.iter().flatten()) {
        // The writer normalizes them, which rounds each of three components by half an ulp.
        assert!(found.distance(*expected) < 2.0 * f32::EPSILON);
    }
}

#[test]
fn unused_vertices_and_uv_sets_round_trip() {
    let mut mesh = seamed_box();
    mesh.positions.insert(0, DVec3::new(9.0, 9.0, 9.0));
    mesh.vertex.colors.insert(0, DVec4::ONE);
    mesh.triangles.iter_mut().flatten().for_each(|vertex| *vertex += 1);
    mesh.corner.uvs.push(mesh.corner.uvs[0].iter().map(|uvs| uvs.map(|uv| uv * 0.5)).collect());
    assert_round_trips(Format::Glb, &mesh);
    mesh.corner.uvs.pop();
    assert_round_trips(Format::Obj, &mesh);
    assert_round_trips(Format::Ply, &mesh);
}

#[test]
fn stored_volume_is_the_volume_of_the_file() {
    let mesh = primitives::icosphere(0.1, 3);
    for format in [Format::Obj, Format::Glb, Format::Gltf, Format::Ply, Format::Off] {
        assert_eq!(format.stored(&mesh).volume().to_bits(), reread(format, &mesh).volume().to_bits());
    }
    assert_ne!(Format::Glb.stored(&mesh).volume(), mesh.volume());
}

#[test]
fn carried_documents_survive_a_second_round() {
    let mesh = reread(Format::Glb, &seamed_box());
    assert!(mesh.assets.gltf.is_some());
    let again = reread(Format::Glb, &mesh);
    assert_eq!(again, mesh);
    assert!(!Arc::ptr_eq(again.assets.gltf.as_ref().unwrap(), mesh.assets.gltf.as_ref().unwrap()));
}

/// Any finite number, and often a simple one.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>().prop_filter("finite", |value| value.is_finite()), (-4..4).prop_map(f64::from), -1.0..1.0,]
}

/// Any finite number in single precision, and often a simple one.
fn single() -> impl Strategy<Value = f32> {
    number().prop_map(|value| value as f32).prop_filter("finite", |value| value.is_finite())
}

/// Triangles of any orientation over vertices at any distinct positions.
fn any_mesh() -> impl Strategy<Value = TriMesh> {
    let positions = prop::collection::vec([number(), number(), number()].prop_map(DVec3::from_array), 3..20);
    let distinct = positions.prop_map(|positions| {
        let mut kept: Vec<DVec3> = Vec::new();
        positions.into_iter().for_each(|position| {
            if !kept.contains(&position) {
                kept.push(position)
            }
        });
        kept
    });
    let distinct = distinct.prop_filter("three vertices", |positions| positions.len() >= 3);
    (distinct, prop::collection::vec((uniform3(any::<prop::sample::Index>()), uniform3([single(), single()])), 1..30))
        .prop_map(|(positions, corners)| {
            let count = positions.len();
            let triangles = corners.iter().map(|(vertices, _)| {
                let first = vertices[0].index(count);
                let second = (first + 1 + vertices[1].index(count - 1)) % count;
                let third = (0..count).filter(|&v| v != first && v != second).nth(vertices[2].index(count - 2));
                [first as u32, second as u32, third.unwrap() as u32]
            });
            let mut mesh = TriMesh::new(positions, triangles.collect());
            mesh.corner.uvs = vec![corners.iter().map(|(_, uvs)| uvs.map(Vec2::from_array)).collect()];
            mesh
        })
}

proptest! {
    #[test]
    fn any_mesh_round_trips_in_double_precision(mesh in any_mesh()) {
        for format in [Format::Obj, Format::Ply, Format::Off] {
            assert_round_trips(format, &mesh);
        }
    }

    #[test]
    fn any_mesh_of_single_precision_round_trips_in_gltf(mut mesh in any_mesh()) {
        // Round to single precision, and skip meshes whose vertices then coincide.
        let round = |value: f64| f64::from(value.clamp(-1e30, 1e30) as f32);
        mesh.positions.iter_mut().for_each(|position| *position = position.map(round));
        let positions = &mesh.positions;
        prop_assume!((1..positions.len()).all(|vertex| !positions[..vertex].contains(&positions[vertex])));
        for format in [Format::Glb, Format::Gltf] {
            assert_round_trips(format, &mesh);
        }
    }
}
