//! Extensions of glTF: those that are understood, and those that must be refused.

use serde_json::Value;

use super::attributes::Attributes;
use super::document::{Document, malformed};
use crate::io::ParseError;

/// Extensions that store geometry in compressed form instead of accessors.
const COMPRESSIONS: [&str; 3] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Extensions that reading resolves, so that a written file does not need them.
const RESOLVED: [&str; 2] = ["KHR_mesh_quantization", "EXT_mesh_gpu_instancing"];

/// Beginnings of the names of extensions that geometry does not depend on.
const WITHOUT_GEOMETRY: [&str; 12] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_dds",
    "MSFT_packing_",
    "ADOBE_materials_",
    "EXT_materials_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_xmp",
    "KHR_audio",
    "KHR_animation_pointer",
];

/// Whether reading resolves an extension.
pub(super) fn is_resolved(name: &str) -> bool {
    RESOLVED.contains(&name)
}

/// Refuses a document that requires an extension which is not understood, as the format demands.
pub(super) fn check_required(json: &Value) -> Result<(), ParseError> {
    let required = json.get("extensionsRequired").and_then(Value::as_array);
    for extension in required.into_iter().flatten().filter_map(Value::as_str) {
        if COMPRESSIONS.contains(&extension) {
            return Err(compressed(extension));
        }
        if !is_resolved(extension) && !WITHOUT_GEOMETRY.iter().any(|start| extension.starts_with(start)) {
            let extension: String = extension.chars().take(80).flat_map(char::escape_default).collect();
            return Err(malformed(format!("the file requires the extension {extension}, which is not supported")));
        }
    }
    Ok(())
}

fn compressed(extension: &str) -> ParseError {
    malformed(format!("compression by {extension} is not supported; save without it"))
}

impl Document<'_> {
    /// Refuses a primitive whose positions only a compressed form has, even if the file does not
    /// list the extension as required.
    pub(super) fn refuse_compressed(
        &self,
        mesh: usize,
        primitive: usize,
        attributes: &Attributes,
    ) -> Result<(), ParseError> {
        let accessor = attributes.positions.and_then(|accessor| self.root.accessors.get(accessor));
        if accessor.is_none_or(|accessor| accessor.buffer_view.is_some() || accessor.sparse.is_some()) {
            return Ok(());
        }
        let pointer = format!("/meshes/{mesh}/primitives/{primitive}/extensions");
        match self.json.pointer(&pointer).and_then(compression_in) {
            Some(extension) => Err(compressed(extension)),
            None => Ok(()),
        }
    }
}

/// The error of a buffer without data: a compression, if one explains it.
pub(super) fn missing_buffer(json: &Value, number: usize) -> ParseError {
    match json.pointer(&format!("/buffers/{number}/extensions")).and_then(compression_in) {
        Some(extension) => compressed(extension),
        None => malformed(format!("buffer {number} has no data")),
    }
}

fn compression_in(extensions: &Value) -> Option<&'static str> {
    COMPRESSIONS.into_iter().find(|&name| extensions.get(name).is_some())
}
