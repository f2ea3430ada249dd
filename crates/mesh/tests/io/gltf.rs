use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use glam::{DVec3, Vec3};
use isochore_mesh::TriMesh;
use isochore_mesh::io::{self, Format};
use serde_json::{Value, json};

use crate::{reread, written};

/// A tetrahedron, oriented outward.
const POSITIONS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const INDICES: [u16; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
/// A placeholder for an image, which is never decoded.
const PICTURE: &[u8] = b"\x89PNG\r\n\x1a\n picture";

/// A document of one tetrahedron with an embedded buffer. Views: 0 positions, 1 indices, 2 image, 3
/// weights, 4 joints, 5 matrices.
fn document() -> Value {
    let mut buffer = Vec::new();
    let mut views = Vec::new();
    let mut push = |bytes: &[u8]| {
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        views.push(json!({ "buffer": 0, "byteOffset": buffer.len(), "byteLength": bytes.len() }));
        buffer.extend_from_slice(bytes);
    };
    push(&POSITIONS.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>());
    push(&INDICES.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>());
    push(PICTURE);
    push(&[0.75_f32, 0.25, 0.0, 0.0].repeat(4).iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>());
    push(&[1, 0, 0, 0].repeat(4));
    push(&[1.0_f32; 32].iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>());
    json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": buffer.len(), "uri": data_uri(&buffer) }],
        "bufferViews": views,
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1] },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" },
            { "bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC4" },
            { "bufferView": 4, "componentType": 5121, "count": 4, "type": "VEC4" },
            { "bufferView": 5, "componentType": 5126, "count": 2, "type": "MAT4" },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "nodes": [{ "mesh": 0 }],
        "scenes": [{ "nodes": [0] }],
        "scene": 0,
    })
}

fn data_uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(bytes))
}

fn read(document: &Value) -> TriMesh {
    io::read_bytes(Format::Gltf, document.to_string().as_bytes()).unwrap()
}

fn error(document: &Value) -> String {
    io::read_bytes(Format::Gltf, document.to_string().as_bytes()).unwrap_err().to_string()
}

#[test]
fn node_transforms_are_applied() {
    let mut document = document();
    let half_turn = [0.0, 0.0, 1.0, 0.0];
    document["nodes"] = json!([
        { "children": [1], "translation": [10, 0, 0] },
        { "mesh": 0, "rotation": half_turn, "scale": [2, 2, 2] },
    ]);
    let mesh = read(&document);
    // A vertex (x, y, z) goes to 2 (−x, −y, z) + (10, 0, 0).
    assert_eq!(mesh.positions[1].round(), DVec3::new(8.0, 0.0, 0.0));
    assert!((mesh.volume() - 8.0 / 6.0).abs() < 1e-12);
}

#[test]
fn mirroring_nodes_reverse_triangles() {
    let mut document = document();
    document["nodes"] = json!([
        { "mesh": 0, "scale": [-1, 1, 1], "translation": [-5, 0, 0] },
        { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] },
    ]);
    document["scenes"] = json!([{ "nodes": [0, 1] }]);
    let mesh = read(&document);
    assert_eq!(mesh.components().count, 2);
    assert!(mesh.check().is_oriented());
    assert!((mesh.volume() - 2.0 / 6.0).abs() < 1e-15);
}

#[test]
fn all_triangle_modes_are_read() {
    let mut document = document();
    let primitive = |mode: u32| json!({ "attributes": { "POSITION": 0 }, "mode": mode });
    document["meshes"][0]["primitives"] = json!([primitive(0), primitive(1), primitive(5)]);
    assert_eq!(read(&document).triangles, [[0, 1, 2], [2, 1, 3]]);
    document["meshes"][0]["primitives"] = json!([primitive(6)]);
    assert_eq!(read(&document).triangles, [[0, 1, 2], [0, 2, 3]]);
    // Without indices, three vertices at a time.
    document["meshes"][0]["primitives"] = json!([primitive(4)]);
    assert_eq!(read(&document).triangles, [[0, 1, 2]]);
}

#[test]
fn several_primitives_share_vertices_and_keep_materials() {
    let mut document = document();
    document["materials"] = json!([{ "name": "clay" }, {}]);
    document["accessors"][1]["count"] = 6.into();
    let mut rest = document["accessors"][1].clone();
    rest["byteOffset"] = 12.into();
    document["accessors"].as_array_mut().unwrap().push(rest);
    document["meshes"][0]["primitives"] = json!([
        { "attributes": { "POSITION": 0 }, "indices": 1, "material": 1 },
        { "attributes": { "POSITION": 0 }, "indices": 5 },
    ]);
    let mesh = read(&document);
    assert!(mesh.check().is_closed());
    assert_eq!(mesh.materials, ["clay", "material1", ""]);
    assert_eq!(mesh.triangle_materials, [1, 1, 2, 2]);
    assert_eq!(reread(Format::Glb, &mesh), mesh);
}

fn textured() -> Value {
    let mut document = document();
    document["images"] = json!([{ "bufferView": 2, "mimeType": "image/png", "name": "bark" }]);
    document["samplers"] = json!([{ "wrapS": 33071 }]);
    document["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    document["materials"] = json!([{
        "name": "wood",
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "roughnessFactor": 0.7 },
        "extensions": { "KHR_materials_sheen": { "sheenRoughnessFactor": 0.5 } },
        "extras": { "note": "kept" },
    }]);
    document["extensionsUsed"] = json!(["KHR_materials_sheen"]);
    document["meshes"][0]["primitives"][0]["material"] = 0.into();
    document
}

/// Bytes of the first image of a binary file.
fn picture_in(glb: &[u8]) -> Vec<u8> {
    let document = gltf::Gltf::from_slice_without_validation(glb).unwrap();
    let image = document.images().next().unwrap();
    let gltf::image::Source::View { view, .. } = image.source() else { panic!("the image is not in the buffer") };
    document.blob.as_ref().unwrap()[view.offset()..][..view.length()].to_vec()
}

#[test]
fn textures_are_written_unchanged() {
    let source = textured();
    let mesh = read(&source);
    let glb = written(Format::Glb, &mesh);
    assert_eq!(picture_in(&glb), PICTURE);
    let json: Value = serde_json::from_slice(&gltf::Glb::from_slice(&glb).unwrap().json).unwrap();
    for name in ["materials", "samplers", "textures", "extensionsUsed"] {
        assert_eq!(json[name], source[name]);
    }
    assert_eq!(json["meshes"][0]["primitives"][0]["material"], 0);
    assert_eq!(reread(Format::Glb, &mesh), mesh);
    assert_eq!(reread(Format::Gltf, &mesh), mesh);
    // A transformation keeps them too.
    assert_eq!(picture_in(&written(Format::Glb, &mesh.transformed(2.0, Default::default(), DVec3::ONE))), PICTURE);
}

#[test]
fn files_beside_the_document_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.gltf");
    let mut document = textured();
    let uri = document["buffers"][0]["uri"].as_str().unwrap().rsplit(',').next().unwrap().to_owned();
    std::fs::write(folder.path().join("the buffer.bin"), BASE64_STANDARD.decode(uri).unwrap()).unwrap();
    document["buffers"][0]["uri"] = "the%20buffer.bin".into();
    std::fs::write(folder.path().join("bark.png"), PICTURE).unwrap();
    document["images"] = json!([{ "uri": "bark.png" }]);
    std::fs::write(&path, document.to_string()).unwrap();
    let mesh = io::read(&path).unwrap();
    assert_eq!(picture_in(&written(Format::Glb, &mesh)), PICTURE);

    document["buffers"][0]["uri"] = "gone.bin".into();
    std::fs::write(&path, document.to_string()).unwrap();
    let message = io::read(&path).unwrap_err().to_string();
    assert!(message.contains("scene.gltf: gone.bin: "), "{message}");
    // A missing image does not cause an error.
    document["buffers"][0]["uri"] = "the%20buffer.bin".into();
    document["images"] = json!([{ "uri": "gone.png" }]);
    std::fs::write(&path, document.to_string()).unwrap();
    let mesh = io::read(&path).unwrap();
    let carried = mesh.assets.gltf.as_ref().unwrap();
    let carried: Value = serde_json::from_str(&carried.json).unwrap();
    assert_eq!(carried["images"][0]["uri"], "gone.png");
    assert!(Path::new(&path).exists());
}

#[test]
fn skin_and_skeleton_are_written() {
    let mut source = document();
    source["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0, "WEIGHTS_0": 2, "JOINTS_0": 3 });
    source["skins"] = json!([{ "joints": [1, 2], "inverseBindMatrices": 4, "skeleton": 1 }]);
    source["nodes"] = json!([
        { "mesh": 0, "skin": 0, "translation": [100, 0, 0] },
        { "name": "hip", "children": [2], "translation": [0, 1, 0] },
        { "name": "knee", "rotation": [0, 0, 0, 1] },
    ]);
    source["scenes"] = json!([{ "nodes": [0, 1] }]);
    source["animations"] = json!([{
        "samplers": [{ "input": 1, "output": 2 }],
        "channels": [
            { "sampler": 0, "target": { "node": 2, "path": "rotation" } },
            { "sampler": 0, "target": { "node": 0, "path": "weights" } },
        ],
    }]);
    let mesh = read(&source);
    // Only its joints place a skinned mesh.
    assert_eq!(mesh.positions[1], DVec3::X);
    assert_eq!(mesh.vertex.skin, vec![vec![(1, 0.75), (0, 0.25)]; 4]);
    let glb = written(Format::Glb, &mesh);
    let document = gltf::Gltf::from_slice(&glb).unwrap();
    let skin = document.skins().next().unwrap();
    let names: Vec<_> = skin.joints().map(|joint| joint.name().unwrap().to_owned()).collect();
    assert_eq!(names, ["hip", "knee"]);
    let matrices = skin.reader(|_| document.blob.as_deref()).read_inverse_bind_matrices().unwrap();
    assert_eq!(matrices.collect::<Vec<_>>(), [[[1.0; 4]; 4]; 2]);
    let node = document.nodes().find(|node| node.mesh().is_some()).unwrap();
    assert_eq!(node.skin().unwrap().index(), 0);
    let scene = document.default_scene().unwrap();
    assert!(scene.nodes().any(|root| root.index() == node.index()));
    assert_eq!(document.animations().next().unwrap().channels().count(), 1);
    assert_eq!(reread(Format::Glb, &mesh).vertex.skin, mesh.vertex.skin);
}

#[test]
fn sparse_and_quantized_accessors_are_read() {
    let mut sparse = document();
    let values: Vec<u8> = [7.0_f32, 8.0, 9.0].iter().flat_map(|value| value.to_le_bytes()).chain([3, 0]).collect();
    sparse["buffers"].as_array_mut().unwrap().push(json!({ "byteLength": 14, "uri": data_uri(&values) }));
    let views = sparse["bufferViews"].as_array_mut().unwrap();
    views.push(json!({ "buffer": 1, "byteLength": 12 }));
    views.push(json!({ "buffer": 1, "byteOffset": 12, "byteLength": 2 }));
    sparse["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": 7, "byteOffset": 0, "componentType": 5123 },
        "values": { "bufferView": 6, "byteOffset": 0 },
    });
    assert_eq!(read(&sparse).positions[3], Vec3::new(7.0, 8.0, 9.0).as_dvec3());

    let mut quantized = document();
    let positions: Vec<u8> = POSITIONS.iter().flat_map(|p| [p[0], p[1], p[2], 0.0]).map(|x| x as u8 * 127).collect();
    quantized["buffers"].as_array_mut().unwrap().push(json!({ "byteLength": 16, "uri": data_uri(&positions) }));
    quantized["bufferViews"][0] = json!({ "buffer": 1, "byteLength": 16, "byteStride": 4 });
    quantized["accessors"][0]["componentType"] = 5120.into();
    quantized["accessors"][0]["normalized"] = true.into();
    quantized["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    assert_eq!(read(&quantized).positions, read(&document()).positions);
}

#[test]
fn faulty_documents_get_clear_errors() {
    let faults: [(&str, Value, &str); 12] = [
        ("/accessors/1/count", json!(13), "accessor 1 reaches beyond buffer view 1"),
        ("/accessors/0/count", json!(3), "mesh 0 names vertex 3, but the primitive has 3"),
        ("/accessors/0/byteOffset", json!(u64::MAX), "accessor 0 reaches beyond buffer view 0"),
        ("/bufferViews/0/byteLength", json!(100_000), "buffer view 0 reaches beyond its buffer"),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "buffer view 0 reaches beyond its buffer"),
        ("/buffers/0/byteLength", json!(100_000), "buffer 0 is truncated: 100000 bytes announced, "),
        ("/buffers/0/uri", json!("data:text/plain,abc"), "data:text/plain,abc: not encoded in base64"),
        ("/nodes/0/children", json!([0]), "node 0 has several parents"),
        ("/nodes/0/mesh", json!(4), "mesh 4 does not exist"),
        ("/scene", json!(4), "scene 4 does not exist"),
        ("/meshes/0/primitives/0/indices", json!(0), "accessor 0 should hold unsigned integers"),
        ("/extensionsRequired", json!(["KHR_draco_mesh_compression"]), "compression by KHR_draco_mesh_compression"),
    ];
    for (pointer, value, message) in faults {
        let mut document = document();
        let (parent, name) = pointer.rsplit_once('/').unwrap();
        document.pointer_mut(parent).unwrap().as_object_mut().unwrap().insert(name.into(), value);
        let found = error(&document);
        assert!(found.starts_with(message), "{pointer}: {found}");
    }
    assert_eq!(error(&json!({ "asset": { "version": "2.0" } })), "the file has no triangles");
}

#[test]
fn names_are_carried() {
    let mut named = document();
    named["meshes"][0]["name"] = "bell".into();
    named["nodes"][0]["name"] = "tower".into();
    named["scenes"][0]["name"] = "village".into();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.gltf");
    let json_of = |mesh: &TriMesh| -> Value { serde_json::from_slice(&written(Format::Gltf, mesh)).unwrap() };
    let names_of = |json: &Value| ["meshes", "nodes", "scenes"].map(|part| json[part][0]["name"].clone());
    std::fs::write(&path, named.to_string()).unwrap();
    assert_eq!(names_of(&json_of(&io::read(&path).unwrap())), ["bell", "tower", "village"]);
    // Without names in the document, the mesh and its node are named after the file.
    std::fs::write(&path, document().to_string()).unwrap();
    assert_eq!(names_of(&json_of(&io::read(&path).unwrap())), [json!("file"), json!("file"), Value::Null]);
    assert_eq!(names_of(&json_of(&read(&document()))), [Value::Null, Value::Null, Value::Null]);
    // A mesh merged from two instances has the name of neither.
    named["nodes"] = json!([{ "mesh": 0, "name": "tower" }, { "mesh": 0, "name": "gate", "translation": [5, 0, 0] }]);
    named["scenes"][0]["nodes"] = json!([0, 1]);
    assert_eq!(names_of(&json_of(&read(&named))), [Value::Null, Value::Null, json!("village")]);
}
