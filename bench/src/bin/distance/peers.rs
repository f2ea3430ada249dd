//! Other libraries that compute signed distances to meshes.

mod in_python;
mod in_rust;

use isochore_mesh::{Grid, TriMesh};

use in_python::InPython;
use in_rust::{MeshToSdf, Parry32, Parry64};

/// Task of the peers: distances at some nodes of a grid.
#[derive(Debug)]
pub(crate) struct Task<'a> {
    pub(crate) mesh: &'a TriMesh,
    pub(crate) grid: &'a Grid,
    /// Index along z of the first layer of nodes.
    pub(crate) first_layer: usize,
    /// Step from layer to layer.
    pub(crate) layer_step: usize,
    /// Number of layers.
    pub(crate) layers: usize,
}

impl Task<'_> {
    /// Indices of the nodes; x varies fastest.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = usize> {
        let size = self.grid.dims[0] * self.grid.dims[1];
        (0..self.layers).flat_map(move |layer| {
            let start = (self.first_layer + layer * self.layer_step) * size;
            start..start + size
        })
    }
}

/// CPU times and results of a round.
#[derive(Debug)]
pub(crate) struct Round {
    /// Construction of the search structure, seconds.
    pub(crate) build: f64,
    /// Query of one node, seconds.
    pub(crate) query: f64,
    /// Distances at the nodes of the task.
    pub(crate) distances: Vec<f64>,
}

/// A library that computes distances, in its fastest configuration.
pub(crate) trait Peer {
    /// Name with version.
    fn name(&self) -> &'static str;

    /// Returns true if the distances are signed.
    fn has_signs(&self) -> bool {
        true
    }

    /// Receives the mesh and the points. Not measured.
    fn prepare(&mut self, task: &Task<'_>) -> Result<(), String>;

    /// Builds the search structure and queries all nodes.
    fn round(&mut self, task: &Task<'_>) -> Result<Round, String>;
}

/// All peers that are available on this machine. The first is the reference, in double precision.
pub(crate) fn all() -> Vec<Box<dyn Peer>> {
    let mut peers: Vec<Box<dyn Peer>> = vec![Box::new(Parry64), Box::new(Parry32)];
    for library in ["warp", "open3d", "libigl", "meshlib", "fcpw", "pysdf"] {
        match InPython::start(library) {
            Ok(peer) => peers.push(Box::new(peer)),
            Err(reason) => println!("{library} is missing: {reason}"),
        }
    }
    peers.push(Box::new(MeshToSdf));
    peers
}
