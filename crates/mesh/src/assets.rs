//! Contents of a mesh file that this crate carries but does not interpret.

use std::collections::BTreeMap;
use std::sync::Arc;

/// Contents of a mesh file beyond geometry and attributes, carried from reading to writing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Assets {
    /// Names of the mesh and of the scene around it.
    pub names: Names,
    /// Material libraries that an OBJ file refers to.
    pub material_libraries: Vec<String>,
    /// Bytes of material and library names that an OBJ file does not encode in UTF-8, by the names
    /// shown for them. Writing OBJ restores the bytes.
    pub raw_names: BTreeMap<String, Vec<u8>>,
    /// Parts of the file that the reader left out or replaced, one sentence each, for warnings.
    pub notes: Vec<String>,
    /// Materials, textures, images, samplers, skin and skeleton of a glTF file.
    pub gltf: Option<Arc<GltfAssets>>,
}

/// Names that glTF can store. A missing name is empty.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Names {
    /// Name of the mesh. Reading a file without one yields the file name without its extension.
    pub mesh: String,
    /// Name of the node that places the mesh.
    pub node: String,
    /// Name of the scene.
    pub scene: String,
}

/// A glTF document without its meshes, and the bytes that it refers to. Opaque to this crate except
/// when it writes glTF.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GltfAssets {
    /// Top-level properties of the document, as the text of one JSON object. Buffer views refer to
    /// `bytes` as buffer 0.
    pub json: String,
    /// Images, inverse bind matrices and keyframes.
    pub bytes: Vec<u8>,
}
