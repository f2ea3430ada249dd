//! The JSON of a document and the buffers that it refers to.

use std::borrow::Cow;
use std::path::Path;

use ::gltf::binary::Glb;
use ::gltf::json::{Root, buffer};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use serde_json::Value;

use super::extensions::{check_required, missing_buffer};
use crate::io::text::without_mark;
use crate::io::{ParseError, Resolve};

/// A document with its loaded buffers.
pub(super) struct Document<'a> {
    /// The complete JSON.
    pub(super) json: Value,
    /// The geometry part of the JSON, typed.
    pub(super) root: Root,
    buffers: Vec<Cow<'a, [u8]>>,
}

/// Top-level properties that geometry does not depend on. They are removed before the typed parse,
/// so that unknown extensions in them do not cause the mesh to be refused.
const OPAQUE: [&str; 8] =
    ["animations", "cameras", "extensions", "extras", "images", "materials", "samplers", "textures"];

impl<'a> Document<'a> {
    pub(super) fn open(bytes: &'a [u8], resolve: Resolve<'_>) -> Result<Self, ParseError> {
        let (text, binary) = split(bytes)?;
        let json: Value = serde_json::from_slice(&text).map_err(|error| {
            if error.is_eof() {
                malformed("the JSON is truncated")
            } else {
                malformed(format!("the JSON is broken: {error}"))
            }
        })?;
        check_required(&json)?;
        let mut geometry = json.clone();
        if let Some(properties) = geometry.as_object_mut() {
            OPAQUE.iter().for_each(|&name| _ = properties.remove(name));
        }
        let root: Root =
            serde_json::from_value(geometry).map_err(|error| malformed(format!("not a glTF document: {error}")))?;
        let mut buffers = Vec::with_capacity(root.buffers.len());
        let mut binary = binary;
        for (number, buffer) in root.buffers.iter().enumerate() {
            let bytes = match &buffer.uri {
                Some(uri) => load(uri, resolve)?.into(),
                None => binary.take().ok_or_else(|| missing_buffer(&json, number))?,
            };
            if (bytes.len() as u64) < buffer.byte_length.0 {
                let (announced, found) = (buffer.byte_length.0, bytes.len());
                return Err(malformed(format!(
                    "buffer {number} is truncated: {announced} bytes announced, {found} found"
                )));
            }
            buffers.push(bytes);
        }
        Ok(Self { json, root, buffers })
    }

    /// Bytes of a buffer view, and its stride if it has one.
    pub(super) fn view(&self, index: usize) -> Result<(&[u8], Option<usize>), ParseError> {
        let missing = || malformed(format!("buffer view {index} does not exist"));
        let view: &buffer::View = self.root.buffer_views.get(index).ok_or_else(missing)?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let range = start.checked_add(view.byte_length.0).and_then(|end| usize_range(start, end));
        let bytes = self.buffers.get(view.buffer.value()).and_then(|buffer| buffer.get(range?));
        let bytes = bytes.ok_or_else(|| malformed(format!("buffer view {index} reaches beyond its buffer")))?;
        Ok((bytes, view.byte_stride.map(|stride| stride.0)))
    }
}

fn usize_range(start: u64, end: u64) -> Option<std::ops::Range<usize>> {
    Some(usize::try_from(start).ok()?..usize::try_from(end).ok()?)
}

/// The JSON, and the buffer after it in a binary file.
type Parts<'a> = (Cow<'a, [u8]>, Option<Cow<'a, [u8]>>);

fn split(bytes: &[u8]) -> Result<Parts<'_>, ParseError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((without_mark(bytes)?.into(), None));
    }
    let length = bytes.get(8..12).map(|length| u32::from_le_bytes([length[0], length[1], length[2], length[3]]));
    match length {
        Some(length) if length < 12 => return Err(malformed("the binary header announces fewer bytes than its own")),
        Some(length) if length as usize > bytes.len() => {
            let found = bytes.len();
            return Err(malformed(format!("the file is truncated: {length} bytes announced, {found} found")));
        }
        None => return Err(malformed("the file is truncated in its header")),
        Some(_) => {}
    }
    let glb = Glb::from_slice(bytes).map_err(|error| malformed(format!("the binary container is broken: {error}")))?;
    Ok((glb.json, glb.bin))
}

/// The bytes that a URI refers to: embedded base64, or a file relative to the document.
pub(super) fn load(uri: &str, resolve: Resolve<'_>) -> Result<Vec<u8>, ParseError> {
    let failed = |problem: String| ParseError::Reference { uri: uri.chars().take(80).collect(), problem };
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, encoded) = data.split_once(";base64,").ok_or_else(|| failed("not encoded in base64".into()))?;
        let config = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
        return GeneralPurpose::new(&STANDARD, config).decode(encoded).map_err(|error| failed(error.to_string()));
    }
    let path = percent_encoding::percent_decode_str(uri).decode_utf8().map_err(|error| failed(error.to_string()))?;
    resolve(Path::new(path.as_ref())).map_err(|error| failed(error.to_string()))
}

pub(super) fn malformed(problem: impl Into<String>) -> ParseError {
    ParseError::Malformed(problem.into())
}
