//! What is carried from reading to writing.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::document::{Document, load};
use crate::GltfAssets;
use crate::io::{ParseError, Resolve};

/// Properties carried word for word.
const MATERIAL_PROPERTIES: [&str; 4] = ["materials", "textures", "samplers", "extensionsUsed"];

impl Document<'_> {
    /// Materials with all that they refer to, and the skeleton where the mesh has a skin.
    pub(super) fn carried_assets(
        &self,
        skin: Option<usize>,
        resolve: Resolve<'_>,
    ) -> Result<Option<GltfAssets>, ParseError> {
        let mut assets = GltfAssets::default();
        for name in MATERIAL_PROPERTIES {
            if let Some(value) = self.json.get(name) {
                assets.json.insert(name.into(), value.clone());
            }
        }
        // Meshes are written without quantization, so that no reader needs to know it.
        if let Some(required) = self.json.get("extensionsRequired").and_then(Value::as_array) {
            let kept: Vec<_> = required.iter().filter(|name| *name != "KHR_mesh_quantization").cloned().collect();
            if !kept.is_empty() {
                assets.json.insert("extensionsRequired".into(), kept.into());
            }
        }
        if let Some(images) = self.json.get("images").and_then(Value::as_array) {
            let images = images.iter().map(|image| self.carry_image(image, &mut assets, resolve));
            let images: Vec<Value> = images.collect::<Result<_, _>>()?;
            assets.json.insert("images".into(), images.into());
        }
        if let Some(skin) = skin.and_then(|skin| self.json.get("skins")?.get(skin)) {
            self.carry_skeleton(skin, &mut assets)?;
        }
        let is_empty = assets.json.is_empty();
        Ok((!is_empty).then_some(assets))
    }

    /// An image with its bytes in a buffer view, wherever the file had them: a path relative to the file that was read
    /// may lead nowhere from the one that is written.
    fn carry_image(&self, image: &Value, assets: &mut GltfAssets, resolve: Resolve<'_>) -> Result<Value, ParseError> {
        let mut image = image.clone();
        if let Some(view) = image.get("bufferView").and_then(Value::as_u64) {
            image["bufferView"] = self.carry_view(view, assets)?;
            return Ok(image);
        }
        let Some(uri) = image.get("uri").and_then(Value::as_str) else { return Ok(image) };
        let Some(kind) = image_type(uri) else { return Ok(image) };
        // A picture that is missing is no reason to refuse the mesh; the reference stays.
        if let Ok(bytes) = load(uri, resolve) {
            let view = push_view(assets, &bytes, None);
            if let Some(properties) = image.as_object_mut() {
                properties.remove("uri");
                properties.insert("mimeType".into(), kind.into());
                properties.insert("bufferView".into(), view);
            }
        }
        Ok(image)
    }

    /// All nodes without their meshes, the skin, and the animations that move the nodes.
    fn carry_skeleton(&self, skin: &Value, assets: &mut GltfAssets) -> Result<(), ParseError> {
        let mut skin = skin.clone();
        if let Some(accessor) = skin.get("inverseBindMatrices").and_then(Value::as_u64) {
            skin["inverseBindMatrices"] = self.carry_accessor(accessor, assets)?;
        }
        assets.json.insert("skins".into(), json!([skin]));

        let mut nodes = self.json.get("nodes").cloned().unwrap_or_default();
        for node in nodes.as_array_mut().into_iter().flatten().filter_map(Value::as_object_mut) {
            ["mesh", "skin", "camera", "weights", "extensions"].iter().for_each(|&name| _ = node.remove(name));
        }
        assets.json.insert("nodes".into(), nodes);
        assets.json.insert("scene".into(), 0.into());
        assets.json.insert("scenes".into(), json!([{ "nodes": self.root_nodes()? }]));

        let mut animations = Vec::new();
        for animation in self.json.get("animations").and_then(Value::as_array).into_iter().flatten() {
            animations.extend(self.carry_animation(animation, assets)?);
        }
        if !animations.is_empty() {
            assets.json.insert("animations".into(), animations.into());
        }
        Ok(())
    }

    /// An animation without what it does to morph targets; none where nothing is left of it.
    fn carry_animation(&self, animation: &Value, assets: &mut GltfAssets) -> Result<Option<Value>, ParseError> {
        let mut animation = animation.clone();
        let moves_node = |channel: &Value| channel.pointer("/target/path").is_some_and(|path| path != "weights");
        match animation.get_mut("channels").and_then(Value::as_array_mut) {
            Some(channels) => channels.retain(moves_node),
            None => return Ok(None),
        }
        if animation["channels"].as_array().is_none_or(Vec::is_empty) {
            return Ok(None);
        }
        for sampler in animation.get_mut("samplers").and_then(Value::as_array_mut).into_iter().flatten() {
            for name in ["input", "output"] {
                if let Some(accessor) = sampler.get(name).and_then(Value::as_u64) {
                    sampler[name] = self.carry_accessor(accessor, assets)?;
                }
            }
        }
        Ok(Some(animation))
    }

    fn carry_accessor(&self, index: u64, assets: &mut GltfAssets) -> Result<Value, ParseError> {
        let Some(accessor) = self.json.get("accessors").and_then(|accessors| accessors.get(index as usize)) else {
            return Err(super::document::malformed(format!("accessor {index} does not exist")));
        };
        let mut accessor = accessor.clone();
        for pointer in ["/bufferView", "/sparse/indices/bufferView", "/sparse/values/bufferView"] {
            if let Some(view) = accessor.pointer_mut(pointer)
                && let Some(index) = view.as_u64()
            {
                *view = self.carry_view(index, assets)?;
            }
        }
        Ok(push(&mut assets.json, "accessors", accessor))
    }

    fn carry_view(&self, index: u64, assets: &mut GltfAssets) -> Result<Value, ParseError> {
        let (bytes, stride) = self.view(index as usize)?;
        Ok(push_view(assets, bytes, stride))
    }
}

/// Appends `bytes` to the buffer and returns the number of the view of them.
pub(super) fn push_view(assets: &mut GltfAssets, bytes: &[u8], stride: Option<usize>) -> Value {
    // Accessors want their views aligned to their components, of four bytes at most.
    assets.bytes.resize(assets.bytes.len().next_multiple_of(4), 0);
    let mut view = json!({ "buffer": 0, "byteOffset": assets.bytes.len(), "byteLength": bytes.len() });
    if let Some(stride) = stride {
        view["byteStride"] = stride.into();
    }
    assets.bytes.extend_from_slice(bytes);
    push(&mut assets.json, "bufferViews", view)
}

/// Appends `value` to the list `name` and returns its number in it.
pub(super) fn push(json: &mut Map<String, Value>, name: &str, value: Value) -> Value {
    let mut list = match json.remove(name) {
        Some(Value::Array(list)) => list,
        _ => Vec::new(),
    };
    list.push(value);
    let number = list.len() - 1;
    json.insert(name.into(), list.into());
    number.into()
}

fn image_type(uri: &str) -> Option<&'static str> {
    const TYPES: [(&str, &str); 5] = [
        ("png", "image/png"),
        ("jpg", "image/jpeg"),
        ("jpeg", "image/jpeg"),
        ("webp", "image/webp"),
        ("ktx2", "image/ktx2"),
    ];
    if let Some(data) = uri.strip_prefix("data:") {
        return TYPES.iter().map(|&(_, kind)| kind).find(|kind| data.starts_with(kind));
    }
    let extension = Path::new(uri).extension()?.to_str()?.to_ascii_lowercase();
    TYPES.iter().find(|(known, _)| *known == extension).map(|&(_, kind)| kind)
}
