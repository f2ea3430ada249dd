//! glTF 2.0, in JSON and binary.
//!
//! The scene is flattened: every mesh of it, placed by its nodes. A skinned mesh stays in its bind pose, as its skin
//! wants it. Morph targets, tangents, cameras and lights are left out, as is the skin where the scene has several or
//! skins only some of its meshes. Materials and textures come back from writing as they were read.

mod accessor;
mod carried;
mod document;
mod reader;
mod scene;
mod writer;

pub(super) use reader::parse;
pub(super) use writer::{write_binary, write_json};
