//! Copies of a node's mesh (`EXT_mesh_gpu_instancing`).

use glam::{DMat4, DQuat, DVec3};
use serde_json::Value;

use super::document::{Document, malformed};
use crate::io::ParseError;

/// Largest number of copies of one mesh. A larger one would demand all memory.
const MOST_COPIES: usize = 1 << 20;

impl Document<'_> {
    /// The transforms of the copies of a node's mesh, relative to the node: the identity alone
    /// without the extension.
    pub(super) fn copies(&self, node: usize) -> Result<Vec<DMat4>, ParseError> {
        let pointer = format!("/nodes/{node}/extensions/EXT_mesh_gpu_instancing/attributes");
        let Some(attributes) = self.json.pointer(&pointer) else { return Ok(vec![DMat4::IDENTITY]) };
        let accessor = |name: &str| attributes.get(name).and_then(Value::as_u64).map(|index| index as usize);
        let vectors = |name: &str| accessor(name).map(|index| self.vectors(index, DVec3::from_array)).transpose();
        let (translations, scales) = (vectors("TRANSLATION")?, vectors("SCALE")?);
        let rotations = accessor("ROTATION").map(|index| self.vectors(index, rotation)).transpose()?;
        let counts =
            [translations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len), rotations.as_ref().map(Vec::len)];
        let Some(count) = counts.into_iter().flatten().next() else { return Ok(vec![DMat4::IDENTITY]) };
        if count > MOST_COPIES || counts.into_iter().flatten().any(|other| other != count) {
            return Err(malformed(format!("node {node} has too many instances, or attributes of different lengths")));
        }
        let copy = |at: usize| {
            DMat4::from_scale_rotation_translation(
                scales.as_ref().map_or(DVec3::ONE, |scales| scales[at]),
                rotations.as_ref().map_or(DQuat::IDENTITY, |rotations| rotations[at]),
                translations.as_ref().map_or(DVec3::ZERO, |translations| translations[at]),
            )
        };
        Ok((0..count).map(copy).collect())
    }
}

fn rotation(quaternion: [f64; 4]) -> DQuat {
    let quaternion = DQuat::from_array(quaternion);
    if quaternion.length_squared() > 0.0 { quaternion.normalize() } else { DQuat::IDENTITY }
}
