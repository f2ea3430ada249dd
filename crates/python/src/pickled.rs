//! Serialization of meshes for `pickle` and for other processes.

use std::sync::Arc;

use bytemuck::{NoUninit, cast_slice, pod_collect_to_vec};
use glam::{DVec3, DVec4, Vec2, Vec3};
use isochore_mesh::{Assets, CornerAttributes, GltfAssets, Names, TriMesh, VertexAttributes};
use pyo3::prelude::*;

use crate::error::Failure;

/// Content of a mesh. Numbers are stored as bytes, so that every bit survives.
#[derive(FromPyObject, IntoPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct PickledMesh {
    positions: Vec<u8>,
    triangles: Vec<u8>,
    uvs: Vec<Vec<u8>>,
    normals: Vec<u8>,
    corner_colors: Vec<u8>,
    colors: Vec<u8>,
    /// Number of joints of each vertex. Empty if the mesh has no skin.
    skin_counts: Vec<u8>,
    joints: Vec<u8>,
    weights: Vec<u8>,
    triangle_materials: Vec<u8>,
    materials: Vec<String>,
    /// Names of the mesh, the node and the scene.
    names: [String; 3],
    material_libraries: Vec<String>,
    raw_names: std::collections::BTreeMap<String, Vec<u8>>,
    notes: Vec<String>,
    /// JSON of a glTF document and the bytes that it refers to.
    gltf: Option<(String, Vec<u8>)>,
}

impl PickledMesh {
    pub(crate) fn of(mesh: &TriMesh) -> Self {
        fn bytes<T: NoUninit>(values: &[T]) -> Vec<u8> {
            cast_slice(values).to_vec()
        }
        let skin = &mesh.vertex.skin;
        let counts: Vec<u32> = skin.iter().map(|influences| influences.len() as u32).collect();
        let (joints, weights): (Vec<u32>, Vec<f64>) = skin.iter().flatten().copied().unzip();
        let Names { mesh: name, node, scene } = mesh.assets.names.clone();
        let gltf = mesh.assets.gltf.as_ref();
        Self {
            positions: bytes(&mesh.positions),
            triangles: bytes(&mesh.triangles),
            uvs: mesh.corner.uvs.iter().map(|set| bytes(set)).collect(),
            normals: bytes(&mesh.corner.normals),
            corner_colors: bytes(&mesh.corner.colors),
            colors: bytes(&mesh.vertex.colors),
            skin_counts: bytes(&counts),
            joints: bytes(&joints),
            weights: bytes(&weights),
            triangle_materials: bytes(&mesh.triangle_materials),
            materials: mesh.materials.clone(),
            names: [name, node, scene],
            material_libraries: mesh.assets.material_libraries.clone(),
            raw_names: mesh.assets.raw_names.clone(),
            notes: mesh.assets.notes.clone(),
            gltf: gltf.map(|gltf| (gltf.json.clone(), gltf.bytes.clone())),
        }
    }

    /// Restores the mesh.
    ///
    /// # Errors
    /// The data is not a valid mesh, for example because another version wrote it.
    pub(crate) fn restored(self) -> Result<TriMesh, Failure> {
        let gltf = |(json, bytes): (String, Vec<u8>)| {
            serde_json::from_str::<serde_json::Map<_, serde_json::Value>>(&json).map_err(Failure::input)?;
            Ok::<_, Failure>(Arc::new(GltfAssets { json, bytes }))
        };
        let [name, node, scene] = self.names;
        let counts: Vec<u32> = pod_collect_to_vec(&self.skin_counts);
        let (joints, weights) = (pod_collect_to_vec::<u8, u32>(&self.joints), pod_collect_to_vec(&self.weights));
        let mut influences = joints.into_iter().zip(weights);
        let mesh = TriMesh {
            positions: pod_collect_to_vec::<_, DVec3>(&self.positions),
            triangles: pod_collect_to_vec(&self.triangles),
            corner: CornerAttributes {
                uvs: self.uvs.iter().map(|set| pod_collect_to_vec::<_, [Vec2; 3]>(set)).collect(),
                normals: pod_collect_to_vec::<_, [Vec3; 3]>(&self.normals),
                colors: pod_collect_to_vec::<_, [DVec4; 3]>(&self.corner_colors),
            },
            vertex: VertexAttributes {
                colors: pod_collect_to_vec(&self.colors),
                skin: counts.iter().map(|&count| influences.by_ref().take(count as usize).collect()).collect(),
            },
            triangle_materials: pod_collect_to_vec(&self.triangle_materials),
            materials: self.materials,
            assets: Assets {
                names: Names { mesh: name, node, scene },
                material_libraries: self.material_libraries,
                raw_names: self.raw_names,
                notes: self.notes,
                gltf: self.gltf.map(gltf).transpose()?,
            },
        };
        mesh.check_valid()?;
        let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
        let corner = &mesh.corner;
        let by_triangle = [corner.normals.len(), corner.colors.len(), mesh.triangle_materials.len()];
        let is_consistent = by_triangle.iter().all(|&count| count == 0 || count == triangles)
            && corner.uvs.iter().all(|set| set.len() == triangles)
            && [mesh.vertex.colors.len(), mesh.vertex.skin.len()].iter().all(|&count| count == 0 || count == vertices)
            && mesh.triangle_materials.iter().all(|&material| (material as usize) < mesh.materials.len());
        if is_consistent { Ok(mesh) } else { Err(Failure::Argument("the pickled data is not a valid mesh".into())) }
    }
}
