//! The meshes that a document shows, and their transforms.

use ::gltf::json::scene::Node;
use glam::{DMat4, DQuat, DVec3};

use super::document::{Document, malformed};
use crate::Names;
use crate::io::ParseError;

/// A mesh placed in the scene.
pub(super) struct Instance {
    pub(super) mesh: usize,
    pub(super) node: Option<usize>,
    pub(super) skin: Option<usize>,
    /// Identity for a skinned mesh, which only its joints place.
    pub(super) world_from_mesh: DMat4,
}

impl Document<'_> {
    /// The meshes of the default scene in the order of its nodes. Without a scene, the meshes of
    /// all nodes; without nodes, all meshes.
    pub(super) fn instances(&self) -> Result<Vec<Instance>, ParseError> {
        let nodes = &self.root.nodes;
        if nodes.is_empty() {
            let unplaced = |mesh| Instance { mesh, node: None, skin: None, world_from_mesh: DMat4::IDENTITY };
            return Ok((0..self.root.meshes.len()).map(unplaced).collect());
        }
        let mut instances = Vec::new();
        let mut is_visited = vec![false; nodes.len()];
        let mut waiting: Vec<(usize, DMat4)> = self.root_nodes()?.into_iter().map(|n| (n, DMat4::IDENTITY)).collect();
        waiting.reverse();
        while let Some((number, world_from_parent)) = waiting.pop() {
            let node = nodes.get(number).ok_or_else(|| malformed(format!("node {number} does not exist")))?;
            if std::mem::replace(&mut is_visited[number], true) {
                return Err(malformed(format!("node {number} has several parents")));
            }
            let world_from_node = world_from_parent * local_transform(node);
            if let Some(mesh) = node.mesh {
                let skin = node.skin.map(|skin| skin.value());
                let world_from_mesh = if skin.is_some() { DMat4::IDENTITY } else { world_from_node };
                for node_from_copy in self.copies(number)? {
                    let world_from_mesh = world_from_mesh * node_from_copy;
                    instances.push(Instance { mesh: mesh.value(), node: Some(number), skin, world_from_mesh });
                }
            }
            let children = node.children.iter().flatten().rev();
            waiting.extend(children.map(|child| (child.value(), world_from_node)));
        }
        Ok(instances)
    }

    /// The names of a single instance and of its scene. A mesh merged from several instances has no
    /// name.
    pub(super) fn names(&self, instances: &[Instance]) -> Names {
        let scene = self.root.scenes.get(self.root.scene.map_or(0, |scene| scene.value()));
        let (mesh, node) = match instances {
            [only] => (
                self.root.meshes.get(only.mesh).and_then(|mesh| mesh.name.clone()),
                only.node.and_then(|node| self.root.nodes.get(node)?.name.clone()),
            ),
            _ => (None, None),
        };
        Names {
            mesh: mesh.unwrap_or_default(),
            node: node.unwrap_or_default(),
            scene: scene.and_then(|scene| scene.name.clone()).unwrap_or_default(),
        }
    }

    pub(super) fn root_nodes(&self) -> Result<Vec<usize>, ParseError> {
        let default = self.root.scene.map(|scene| scene.value());
        if let Some(scene) = self.root.scenes.get(default.unwrap_or(0)) {
            return Ok(scene.nodes.iter().map(|node| node.value()).collect());
        }
        if let Some(scene) = default {
            return Err(malformed(format!("scene {scene} does not exist")));
        }
        let mut is_child = vec![false; self.root.nodes.len()];
        for child in self.root.nodes.iter().filter_map(|node| node.children.as_ref()).flatten() {
            if let Some(is_child) = is_child.get_mut(child.value()) {
                *is_child = true;
            }
        }
        Ok((0..is_child.len()).filter(|&node| !is_child[node]).collect())
    }
}

fn local_transform(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let vector = |values: [f32; 3]| DVec3::from_array(values.map(f64::from));
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |quaternion| {
        let quaternion = DQuat::from_array(quaternion.0.map(f64::from));
        // In single precision the length differs slightly from one, which would scale the mesh.
        if quaternion.length_squared() > 0.0 { quaternion.normalize() } else { DQuat::IDENTITY }
    });
    let scale = node.scale.map_or(DVec3::ONE, vector);
    let translation = node.translation.map_or(DVec3::ZERO, vector);
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}
