//! glTF 2.0, in JSON and binary.
//!
//! The scene is flattened: every mesh is transformed by its nodes. A skinned mesh stays in its bind
//! pose, as its skin requires. Morph targets, tangents, cameras and lights are dropped. So is the
//! skin if the scene has several skins or skins only some of its meshes. Materials and textures are
//! written as they were read.

mod accessor;
mod attributes;
mod builder;
mod carried;
mod document;
mod extensions;
mod instancing;
mod reader;
mod scene;
mod writer;

pub(super) use reader::parse;
pub(super) use writer::{write_binary, write_json};
