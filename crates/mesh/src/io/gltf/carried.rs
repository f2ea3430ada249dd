//! The parts of a document that are carried from reading to writing.

use std::path::Path;

use serde_json::{Value, json};

use super::builder::DocumentBuilder;
use super::document::{Document, load};
use super::extensions::is_resolved;
use crate::GltfAssets;
use crate::io::{ParseError, Resolve};

/// Top-level properties that are carried unchanged.
const MATERIAL_PROPERTIES: [&str; 3] = ["materials", "textures", "samplers"];

impl Document<'_> {
    /// Materials with everything that they refer to, and the skeleton if the mesh has a skin.
    pub(super) fn carried_assets(
        &self,
        skin: Option<usize>,
        uv_sets: &[u32],
        resolve: Resolve<'_>,
    ) -> Result<Option<GltfAssets>, ParseError> {
        let mut assets = DocumentBuilder::default();
        for name in MATERIAL_PROPERTIES {
            if let Some(value) = self.json.get(name) {
                assets.properties.insert(name.into(), value.clone());
            }
        }
        for name in ["extensionsUsed", "extensionsRequired"] {
            if let Some(listed) = self.json.get(name).and_then(Value::as_array) {
                let kept = listed.iter().filter(|name| name.as_str().is_some_and(|name| !is_resolved(name)));
                let kept: Vec<_> = kept.cloned().collect();
                if !kept.is_empty() {
                    assets.properties.insert(name.into(), kept.into());
                }
            }
        }
        // Sets are written without gaps in their numbers.
        if let Some(materials) = assets.properties.get_mut("materials")
            && uv_sets.iter().zip(0..).any(|(&set, number)| set != number)
        {
            renumber_uv_sets(materials, uv_sets);
        }
        if let Some(images) = self.json.get("images").and_then(Value::as_array) {
            let images = images.iter().map(|image| self.carry_image(image, &mut assets, resolve));
            let images: Vec<Value> = images.collect::<Result<_, _>>()?;
            assets.properties.insert("images".into(), images.into());
        }
        if let Some(skin) = skin.and_then(|skin| self.json.get("skins")?.get(skin)) {
            self.carry_skeleton(skin, &mut assets)?;
        }
        Ok(assets.into_assets())
    }

    /// An image with its bytes in a buffer view, wherever the input had them: a path relative to
    /// the input file may be invalid relative to the output file.
    fn carry_image(
        &self,
        image: &Value,
        assets: &mut DocumentBuilder,
        resolve: Resolve<'_>,
    ) -> Result<Value, ParseError> {
        let mut image = image.clone();
        if let Some(view) = image.get("bufferView").and_then(Value::as_u64) {
            image["bufferView"] = self.carry_view(view, assets)?;
            return Ok(image);
        }
        let Some(uri) = image.get("uri").and_then(Value::as_str) else { return Ok(image) };
        let Some(kind) = image_type(uri) else { return Ok(image) };
        // A missing image is not a reason to refuse the mesh. The reference is kept.
        if let Ok(bytes) = load(uri, resolve) {
            let view = assets.push_view(&bytes, None);
            if let Some(properties) = image.as_object_mut() {
                properties.remove("uri");
                properties.insert("mimeType".into(), kind.into());
                properties.insert("bufferView".into(), view);
            }
        }
        Ok(image)
    }

    /// All nodes without their meshes, the skin, and the animations that move the nodes.
    fn carry_skeleton(&self, skin: &Value, assets: &mut DocumentBuilder) -> Result<(), ParseError> {
        let mut skin = skin.clone();
        if let Some(accessor) = skin.get("inverseBindMatrices").and_then(Value::as_u64) {
            skin["inverseBindMatrices"] = self.carry_accessor(accessor, assets)?;
        }
        assets.properties.insert("skins".into(), json!([skin]));

        let mut nodes = self.json.get("nodes").cloned().unwrap_or_default();
        for node in nodes.as_array_mut().into_iter().flatten().filter_map(Value::as_object_mut) {
            ["mesh", "skin", "camera", "weights", "extensions"].iter().for_each(|&name| _ = node.remove(name));
        }
        assets.properties.insert("nodes".into(), nodes);
        assets.properties.insert("scene".into(), 0.into());
        assets.properties.insert("scenes".into(), json!([{ "nodes": self.root_nodes()? }]));

        let mut animations = Vec::new();
        for animation in self.json.get("animations").and_then(Value::as_array).into_iter().flatten() {
            animations.extend(self.carry_animation(animation, assets)?);
        }
        if !animations.is_empty() {
            assets.properties.insert("animations".into(), animations.into());
        }
        Ok(())
    }

    /// An animation without its channels for morph targets, or `None` if no other channel remains.
    fn carry_animation(&self, animation: &Value, assets: &mut DocumentBuilder) -> Result<Option<Value>, ParseError> {
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

    fn carry_accessor(&self, index: u64, assets: &mut DocumentBuilder) -> Result<Value, ParseError> {
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
        Ok(assets.push("accessors", accessor))
    }

    fn carry_view(&self, index: u64, assets: &mut DocumentBuilder) -> Result<Value, ParseError> {
        let (bytes, stride) = self.view(index as usize)?;
        Ok(assets.push_view(bytes, stride))
    }
}

/// Replaces the numbers of UV sets in materials by their positions in `sets`.
fn renumber_uv_sets(part: &mut Value, sets: &[u32]) {
    // A set that no mesh has keeps a number that no mesh has.
    let new = |set: u64| match sets.iter().position(|&known| u64::from(known) == set) {
        Some(position) => position as u64,
        None => sets.len() as u64 + set,
    };
    match part {
        Value::Array(parts) => parts.iter_mut().for_each(|part| renumber_uv_sets(part, sets)),
        Value::Object(properties) => {
            properties.values_mut().for_each(|part| renumber_uv_sets(part, sets));
            let set = properties.get("texCoord").and_then(Value::as_u64);
            // A reference to a texture without a set means set 0.
            let set = set.or(properties.get("index").and_then(Value::as_u64).map(|_| 0));
            if let Some(set) = set {
                properties.insert("texCoord".into(), new(set).into());
            }
        }
        _ => {}
    }
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
