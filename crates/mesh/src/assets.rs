//! What a mesh file says beyond geometry.

use std::sync::Arc;

/// Parts of a file that this crate does not interpret, carried from reading to writing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Assets {
    /// How other programs list what the file shows.
    pub names: Names,
    /// Material libraries that an OBJ file names.
    pub material_libraries: Vec<String>,
    /// Materials, textures, images, samplers, skin and skeleton of a glTF file.
    pub gltf: Option<Arc<GltfAssets>>,
}

/// Names that glTF has a place for; empty where there are none.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Names {
    /// That of the mesh; of a file without one, or of a format without names, the name of the file without its extension.
    pub mesh: String,
    /// That of the node that shows the mesh.
    pub node: String,
    /// That of the scene.
    pub scene: String,
}

/// The JSON of a glTF document without its meshes, and the bytes that it refers to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GltfAssets {
    /// Top-level properties of the document. Buffer views refer to `bytes` as buffer 0.
    pub json: serde_json::Map<String, serde_json::Value>,
    /// Images, inverse bind matrices and key frames.
    pub bytes: Vec<u8>,
}
