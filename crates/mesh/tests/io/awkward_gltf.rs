//! Sets of texture coordinates and extensions of glTF.

use isochore_mesh::TriMesh;
use isochore_mesh::io::{self, Format};
use serde_json::{Value, json};

use crate::{seamed_box, written};

fn document(mesh: &TriMesh) -> Value {
    serde_json::from_slice(&written(Format::Gltf, mesh)).unwrap()
}

fn read(document: &Value) -> Result<TriMesh, String> {
    io::read_bytes(Format::Gltf, document.to_string().as_bytes()).map_err(|error| error.to_string())
}

/// Renames the set of texture coordinates of every primitive.
fn rename_set(document: &mut Value, set: u32) {
    for primitive in document["meshes"][0]["primitives"].as_array_mut().unwrap() {
        let attributes = primitive["attributes"].as_object_mut().unwrap();
        let accessor = attributes.remove("TEXCOORD_0").unwrap();
        attributes.insert(format!("TEXCOORD_{set}"), accessor);
    }
}

#[test]
fn materials_follow_their_uv_sets() {
    for set in [1, 3, 7] {
        let mut document = document(&seamed_box());
        rename_set(&mut document, set);
        document["materials"][0]["pbrMetallicRoughness"] =
            json!({ "baseColorTexture": { "index": 0, "texCoord": set } });
        document["materials"][0]["normalTexture"] = json!({ "index": 0 });
        document["textures"] = json!([{ "source": 0 }]);
        document["images"] = json!([{ "uri": "data:image/png;base64,AAAA" }]);
        let mesh = read(&document).unwrap();
        assert_eq!(mesh.corner.uvs, seamed_box().corner.uvs);
        let material = &self::document(&mesh)["materials"][0];
        assert_eq!(material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"], 0);
        // This texture used set 0, which the mesh does not have.
        assert_eq!(material["normalTexture"]["texCoord"], 1);
    }
}

#[test]
fn primitives_keep_their_own_uv_sets() {
    let mut document = document(&seamed_box());
    let attributes = document["meshes"][0]["primitives"][1]["attributes"].as_object_mut().unwrap();
    let accessor = attributes.remove("TEXCOORD_0").unwrap();
    attributes.insert("TEXCOORD_1".into(), accessor);
    let mesh = read(&document).unwrap();
    let [first, second] = &mesh.corner.uvs[..] else { panic!("{} sets", mesh.corner.uvs.len()) };
    for ((first, second), material) in first.iter().zip(second).zip(&mesh.triangle_materials) {
        let [own, other] = if *material == 0 { [first, second] } else { [second, first] };
        assert!(own.iter().all(|uv| *uv != glam::Vec2::ZERO) && *other == [glam::Vec2::ZERO; 3]);
    }
}

#[test]
fn required_extensions_must_be_known() {
    for (name, is_known) in [
        ("KHR_materials_unlit", true),
        ("KHR_texture_transform", true),
        ("KHR_mesh_quantization", true),
        ("VENDOR_nurbs", false),
        ("KHR_new_geometry", false),
        ("KHR_draco_mesh_compression", false),
    ] {
        let mut document = document(&seamed_box());
        document["extensionsUsed"] = json!([name]);
        document["extensionsRequired"] = json!([name]);
        match read(&document) {
            Ok(_) => assert!(is_known, "{name}"),
            Err(error) => assert!(!is_known && error.contains(name), "{error}"),
        }
        document.as_object_mut().unwrap().remove("extensionsRequired");
        assert!(read(&document).is_ok(), "{name}");
    }
}

#[test]
fn compression_without_a_plain_form_is_named() {
    let mut document = document(&seamed_box());
    for primitive in document["meshes"][0]["primitives"].as_array_mut().unwrap() {
        primitive["extensions"] = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": {} } });
    }
    assert!(read(&document).is_ok(), "the plain form is there too");
    for accessor in document["accessors"].as_array_mut().unwrap() {
        accessor.as_object_mut().unwrap().remove("bufferView");
    }
    assert!(read(&document).unwrap_err().contains("KHR_draco_mesh_compression"));
}

#[test]
fn instances_are_placed() {
    let mesh = seamed_box();
    let volume = mesh.volume();
    let mut document = document(&mesh);
    let translations = [[0.0_f32, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]];
    let scales = [[1.0_f32, 1.0, 1.0], [2.0, 2.0, 2.0], [1.0, 1.0, -3.0]];
    let bytes: Vec<u8> =
        [translations, scales].as_flattened().as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let encoded = encode(&bytes);
    let buffer = document["buffers"].as_array().unwrap().len();
    let view = document["bufferViews"].as_array().unwrap().len();
    let accessor = document["accessors"].as_array().unwrap().len();
    let push = |document: &mut Value, list: &str, value| document[list].as_array_mut().unwrap().push(value);
    let uri = format!("data:application/octet-stream;base64,{encoded}");
    push(&mut document, "buffers", json!({ "byteLength": 72, "uri": uri }));
    for offset in [0, 36] {
        push(&mut document, "bufferViews", json!({ "buffer": buffer, "byteOffset": offset, "byteLength": 36 }));
        let view = view + offset / 36;
        push(
            &mut document,
            "accessors",
            json!({ "bufferView": view, "componentType": 5126, "count": 3, "type": "VEC3" }),
        );
    }
    document["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    document["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let attributes = json!({ "TRANSLATION": accessor, "SCALE": accessor + 1 });
    document["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    let placed = read(&document).unwrap();
    assert_eq!(placed.triangles.len(), 3 * mesh.triangles.len());
    // The mirrored copy keeps its orientation.
    assert!((placed.volume() - (1.0 + 8.0 + 3.0) * volume).abs() < 1e-12);
    assert!(self::document(&placed).get("extensionsRequired").is_none());
    let attributes = json!({ "TRANSLATION": accessor, "SCALE": 0 });
    document["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    assert!(read(&document).unwrap_err().contains("instances"));
}

/// Base64 of bytes whose number is a multiple of three.
fn encode(bytes: &[u8]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |group: &[u8; 3]| {
        let bits = u32::from_be_bytes([0, group[0], group[1], group[2]]);
        [18, 12, 6, 0].map(|shift| char::from(LETTERS[(bits >> shift & 63) as usize]))
    };
    bytes.as_chunks().0.iter().flat_map(group).collect()
}
