//! Writing glTF.

use std::collections::BTreeMap;
use std::io::{self, Write};

use ::gltf::binary::{Glb, Header};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use glam::{DVec4, Vec3};
use serde_json::{Map, Value, json};

use super::builder::DocumentBuilder;
use crate::TriMesh;
use crate::io::split::SplitVertices;

/// Component types of accessors.
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Writes one binary file.
pub(in crate::io) fn write_binary(mesh: &TriMesh, writer: &mut dyn Write) -> io::Result<()> {
    let document = Document::of(mesh)?;
    let glb = Glb {
        header: Header { magic: *b"glTF", version: 2, length: 0 },
        json: document.0.to_json()?.into(),
        bin: Some(document.0.bytes.into()),
    };
    glb.to_writer(writer).map_err(io::Error::other)
}

/// Writes one JSON file with an embedded buffer.
pub(in crate::io) fn write_json(mesh: &TriMesh, writer: &mut dyn Write) -> io::Result<()> {
    let mut document = Document::of(mesh)?;
    let encoded = BASE64_STANDARD.encode(&document.0.bytes);
    document.0.properties["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{encoded}").into();
    writer.write_all(&document.0.to_json()?)
}

/// The document to write.
struct Document(DocumentBuilder);

impl Document {
    fn of(mesh: &TriMesh) -> io::Result<Self> {
        let carried = mesh.assets.gltf.as_deref().map(DocumentBuilder::from_assets).transpose()?;
        let mut document = Self(carried.unwrap_or_default());
        let has_skin = !mesh.vertex.skin.is_empty() && document.0.properties.contains_key("skins");
        let split = SplitVertices::of(mesh);
        let attributes = document.push_attributes(mesh, &split, has_skin);
        let primitives = document.push_primitives(mesh, &split, &attributes);
        let json = &mut document.0.properties;
        json.insert("asset".into(), json!({ "version": "2.0", "generator": "isochore" }));
        let names = &mesh.assets.names;
        let mut shown = json!({ "primitives": primitives });
        give_name(&mut shown, &names.mesh);
        json.insert("meshes".into(), json!([shown]));
        let mut node = json!({ "mesh": 0 });
        give_name(&mut node, if names.node.is_empty() { &names.mesh } else { &names.node });
        if has_skin {
            node["skin"] = 0.into();
        }
        let node = document.0.push("nodes", node);
        let json = &mut document.0.properties;
        match json.get_mut("scenes").and_then(|scenes| scenes.get_mut(0)?.get_mut("nodes")?.as_array_mut()) {
            Some(roots) => roots.push(node),
            None => {
                json.insert("scenes".into(), json!([{ "nodes": [node] }]));
                json.insert("scene".into(), 0.into());
            }
        }
        give_name(&mut json["scenes"][0], &names.scene);
        document.0.bytes.resize(document.0.bytes.len().next_multiple_of(4), 0);
        let length = document.0.bytes.len();
        // Lengths in a binary file have 32 bits. The reserve is large enough for the JSON before
        // the buffer.
        if length > (u32::MAX - (1 << 24)) as usize {
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, "glTF cannot hold more than 4 GiB"));
        }
        document.0.properties.insert("buffers".into(), json!([{ "byteLength": length }]));
        Ok(document)
    }

    /// Attributes of the split vertices, which all primitives have in common.
    fn push_attributes(&mut self, mesh: &TriMesh, split: &SplitVertices, has_skin: bool) -> Map<String, Value> {
        let mut attributes = Map::new();
        let positions = split.vertices.iter().map(|&vertex| mesh.positions[vertex as usize].as_vec3());
        let (min, max) = positions
            .clone()
            .fold((glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
        let position = self.push_floats("VEC3", positions.map(|p| p.to_array()));
        let accessor = &mut self.0.properties["accessors"][position.as_u64().unwrap_or_default() as usize];
        accessor["min"] = json!(min.to_array());
        accessor["max"] = json!(max.to_array());
        attributes.insert("POSITION".into(), position);

        if !mesh.corner.normals.is_empty() {
            let normals = split.values(&mesh.corner.normals, Vec3::Z);
            // The format requires unit normals, so a zero normal is replaced.
            let unit = |normal: Vec3| normal.as_dvec3().try_normalize().map_or(Vec3::Z, |normal| normal.as_vec3());
            let normals = normals.map(|normal| unit(normal).to_array());
            attributes.insert("NORMAL".into(), self.push_floats("VEC3", normals));
        }
        for (number, set) in mesh.corner.uvs.iter().enumerate() {
            let uvs = split.values(set, Default::default()).map(|uv| uv.to_array());
            attributes.insert(format!("TEXCOORD_{number}"), self.push_floats("VEC2", uvs));
        }
        if !mesh.corner.colors.is_empty() {
            let colors = split.values(&mesh.corner.colors, DVec4::ONE).map(|color| color.as_vec4().to_array());
            attributes.insert("COLOR_0".into(), self.push_floats("VEC4", colors));
        } else if !mesh.vertex.colors.is_empty() {
            let colors = split.vertices.iter().map(|&v| mesh.vertex.colors[v as usize].as_vec4().to_array());
            attributes.insert("COLOR_0".into(), self.push_floats("VEC4", colors));
        }
        if has_skin {
            self.push_influences(mesh, split, &mut attributes);
        }
        attributes
    }

    fn push_influences(&mut self, mesh: &TriMesh, split: &SplitVertices, attributes: &mut Map<String, Value>) {
        let most = mesh.vertex.skin.iter().map(Vec::len).max().unwrap_or(0).max(1);
        for set in 0..most.div_ceil(4) {
            let influence = |vertex: u32, slot: usize| {
                mesh.vertex.skin[vertex as usize].get(4 * set + slot).copied().unwrap_or_default()
            };
            let vertices = &split.vertices;
            let joints = vertices.iter().flat_map(|&v| (0..4).map(move |slot| (v, slot)));
            let joints: Vec<u8> = joints.flat_map(|(v, slot)| (influence(v, slot).0 as u16).to_le_bytes()).collect();
            let view = self.0.push_view(&joints, None);
            let joints = self.push_accessor(view, UNSIGNED_SHORT, vertices.len(), "VEC4");
            attributes.insert(format!("JOINTS_{set}"), joints);
            let weights = vertices.iter().map(|&v| std::array::from_fn(|slot| influence(v, slot).1 as f32));
            attributes.insert(format!("WEIGHTS_{set}"), self.push_floats::<4>("VEC4", weights));
        }
    }

    /// One primitive per material, in the order of the materials.
    fn push_primitives(
        &mut self,
        mesh: &TriMesh,
        split: &SplitVertices,
        attributes: &Map<String, Value>,
    ) -> Vec<Value> {
        let mut by_material: BTreeMap<Option<u32>, Vec<u8>> = BTreeMap::new();
        for (triangle, vertices) in split.triangles.iter().enumerate() {
            let material = mesh.triangle_materials.get(triangle).copied();
            let indices = by_material.entry(material).or_default();
            vertices.iter().for_each(|vertex| indices.extend_from_slice(&vertex.to_le_bytes()));
        }
        let numbers = self.material_numbers(mesh);
        let mut primitives = Vec::new();
        for (material, indices) in by_material {
            let view = self.0.push_view(&indices, None);
            let accessor = self.push_accessor(view, UNSIGNED_INT, indices.len() / 4, "SCALAR");
            let mut primitive = json!({ "attributes": attributes, "indices": accessor });
            if let Some(number) = material.and_then(|material| numbers.get(material as usize).copied().flatten()) {
                primitive["material"] = number.into();
            }
            primitives.push(primitive);
        }
        primitives
    }

    /// The index in the document of each material of the mesh. A material that is not among the
    /// carried ones is added with its name only.
    fn material_numbers(&mut self, mesh: &TriMesh) -> Vec<Option<u64>> {
        let carried = self.0.properties.get("materials").and_then(Value::as_array).map_or(0, Vec::len);
        let number = |(material, name): (usize, &String)| match name.as_str() {
            _ if material < carried => Some(material as u64),
            "" => None,
            name => self.0.push("materials", json!({ "name": name })).as_u64(),
        };
        mesh.materials.iter().enumerate().map(number).collect()
    }

    fn push_floats<const N: usize>(&mut self, kind: &str, vectors: impl Iterator<Item = [f32; N]>) -> Value {
        let bytes: Vec<u8> = vectors.flatten().flat_map(f32::to_le_bytes).collect();
        let view = self.0.push_view(&bytes, None);
        self.push_accessor(view, FLOAT, bytes.len() / (4 * N), kind)
    }

    fn push_accessor(&mut self, view: Value, component: u32, count: usize, kind: &str) -> Value {
        let accessor = json!({ "bufferView": view, "componentType": component, "count": count, "type": kind });
        self.0.push("accessors", accessor)
    }
}

/// Names a part of the document, unless `name` is empty.
fn give_name(part: &mut Value, name: &str) {
    if !name.is_empty() {
        part["name"] = name.into();
    }
}
