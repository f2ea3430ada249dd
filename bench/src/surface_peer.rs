//! Input of the libraries in `bench/peers/surface.py`.

use std::fs;
use std::path::PathBuf;

use isochore_mesh::TriMesh;
use serde_json::json;

use crate::{PythonPeer, scratch};

/// Sends `mesh` to the peer.
///
/// # Errors
/// The error message of the peer.
///
/// # Panics
/// If the scratch folder cannot be written.
pub fn load_mesh(peer: &mut PythonPeer, mesh: &TriMesh) -> Result<(), String> {
    let write = |name: &str, bytes: Vec<u8>| -> PathBuf {
        let path = scratch().join(name);
        fs::write(&path, bytes).expect("the scratch folder can be written");
        path
    };
    let vertices = mesh.positions.iter().flat_map(|position| position.to_array()).flat_map(f64::to_le_bytes).collect();
    let triangles = mesh.triangles.iter().flatten().flat_map(|vertex| vertex.to_le_bytes()).collect();
    let vertices = write("surface-vertices.raw", vertices);
    let triangles = write("surface-triangles.raw", triangles);
    peer.ask(&json!({ "job": "load", "vertices": vertices, "triangles": triangles })).map(drop)
}
