use std::fs;

use isochore_bench::{PythonPeer, scratch};
use serde_json::json;

use super::{Peer, Round, Task};

/// A library in `bench/peers/distance.py`.
#[derive(Debug)]
pub(super) struct InPython {
    library: &'static str,
    process: PythonPeer,
}

impl InPython {
    /// Starts the process of `library`.
    pub(super) fn start(library: &'static str) -> Result<Self, String> {
        Ok(Self { library, process: PythonPeer::start("distance", &[library])? })
    }
}

impl Peer for InPython {
    fn name(&self) -> &'static str {
        match self.library {
            "warp" => "Warp 1.19 on the CPU",
            "open3d" => "Open3D 0.20",
            "libigl" => "libigl 2.6.3",
            "meshlib" => "MeshLib 3.1.4",
            "fcpw" => "fcpw 1.2 (no signs)",
            "pysdf" => "pysdf 0.1.9 (not exact)",
            other => other,
        }
    }

    fn has_signs(&self) -> bool {
        self.library != "fcpw"
    }

    fn prepare(&mut self, task: &Task<'_>) -> Result<(), String> {
        let folder = scratch();
        let [vertices, triangles, points] = ["vertices", "triangles", "points"].map(|name| folder.join(name));
        let write = |path, bytes: Vec<u8>| fs::write(path, bytes).map_err(|error| error.to_string());
        write(&vertices, task.mesh.positions.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes).collect())?;
        write(&triangles, task.mesh.triangles.iter().flatten().copied().flat_map(u32::to_le_bytes).collect())?;
        let nodes = task.nodes().map(|node| task.grid.node_at(node));
        write(&points, nodes.flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes).collect())?;
        self.process.ask(&json!({ "job": "prepare", "vertices": vertices, "triangles": triangles }))?;
        // Peers that compile code need a hierarchy to run it once.
        self.process.ask(&json!({ "job": "build" }))?;
        let grid = json!({
            "first": task.grid.node(0, 0, task.first_layer).to_array(),
            "step": [task.grid.cell, task.grid.cell, task.grid.cell * task.layer_step as f64],
            "dims": [task.grid.dims[0], task.grid.dims[1], task.layers],
        });
        self.process.ask(&json!({ "job": "prepare_points", "points": points, "grid": grid })).map(drop)
    }

    fn round(&mut self, _task: &Task<'_>) -> Result<Round, String> {
        let build = self.process.seconds(&json!({ "job": "build" }))?;
        let path = scratch().join("distances");
        let query = self.process.seconds(&json!({ "job": "query", "distances": path }))?;
        let bytes = fs::read(path).map_err(|error| error.to_string())?;
        let (numbers, _) = bytes.as_chunks();
        let distances: Vec<f64> = numbers.iter().map(|&number| f64::from_le_bytes(number)).collect();
        Ok(Round { build, query: query / distances.len() as f64, distances })
    }
}
