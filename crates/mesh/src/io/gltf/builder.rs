//! A glTF document that is put together for carrying or for writing.

use std::io;

use serde_json::{Map, Value, json};

use crate::GltfAssets;

/// Top-level properties of a document, and its only buffer.
#[derive(Default)]
pub(super) struct DocumentBuilder {
    pub(super) properties: Map<String, Value>,
    pub(super) bytes: Vec<u8>,
}

impl DocumentBuilder {
    /// A document that begins with the carried assets.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidData`] if their JSON is not an object.
    pub(super) fn from_assets(assets: &GltfAssets) -> io::Result<Self> {
        let properties = serde_json::from_str(&assets.json).map_err(|error| {
            let problem = format!("the glTF assets of the mesh are not a JSON object: {error}");
            io::Error::new(io::ErrorKind::InvalidData, problem)
        })?;
        Ok(Self { properties, bytes: assets.bytes.clone() })
    }

    /// The document as assets to carry, or `None` if it has no properties.
    pub(super) fn into_assets(self) -> Option<GltfAssets> {
        let Self { properties, bytes } = self;
        (!properties.is_empty()).then(|| GltfAssets { json: Value::Object(properties).to_string(), bytes })
    }

    /// The properties as JSON text.
    pub(super) fn to_json(&self) -> io::Result<Vec<u8>> {
        serde_json::to_vec(&self.properties).map_err(io::Error::other)
    }

    /// Appends `value` to the top-level list `name` and returns its index.
    pub(super) fn push(&mut self, name: &str, value: Value) -> Value {
        let mut list = match self.properties.remove(name) {
            Some(Value::Array(list)) => list,
            _ => Vec::new(),
        };
        list.push(value);
        let index = list.len() - 1;
        self.properties.insert(name.into(), list.into());
        index.into()
    }

    /// Appends `bytes` to the buffer and returns the index of their buffer view.
    pub(super) fn push_view(&mut self, bytes: &[u8], stride: Option<usize>) -> Value {
        // Accessors need views aligned to their components, which have at most four bytes.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        self.bytes.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }
}
