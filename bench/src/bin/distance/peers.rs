//! Other libraries that tell signed distances to meshes.

mod in_python;
mod in_rust;

use isochore_mesh::{Grid, TriMesh};

use in_python::InPython;
use in_rust::{MeshToSdf, Parry32, Parry64};

/// What the peers are asked: distances at some nodes of a grid.
#[derive(Debug)]
pub(crate) struct Task<'a> {
    pub(crate) mesh: &'a TriMesh,
    pub(crate) grid: &'a Grid,
    /// The layers of nodes that they are asked for, numbers along z: each so far from the one before.
    pub(crate) first_layer: usize,
    pub(crate) layer_step: usize,
    pub(crate) layers: usize,
}

impl Task<'_> {
    /// Indices of the nodes, x fastest.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = usize> {
        let size = self.grid.dims[0] * self.grid.dims[1];
        (0..self.layers).flat_map(move |layer| {
            let start = (self.first_layer + layer * self.layer_step) * size;
            start..start + size
        })
    }
}

/// Seconds of work in a round, and what came of it.
#[derive(Debug)]
pub(crate) struct Round {
    pub(crate) build: f64,
    /// For a node.
    pub(crate) query: f64,
    /// At the nodes of the task.
    pub(crate) distances: Vec<f64>,
}

/// A library that tells distances, at its fastest.
pub(crate) trait Peer {
    /// With its version.
    fn name(&self) -> &'static str;

    /// Whether it tells inside from outside.
    fn has_signs(&self) -> bool {
        true
    }

    /// Takes over the mesh and the points, which is not measured.
    fn prepare(&mut self, task: &Task<'_>) -> Result<(), String>;

    /// Prepares its search structure and asks it for all nodes.
    fn round(&mut self, task: &Task<'_>) -> Result<Round, String>;
}

/// All peers that there are on this machine. The first is the one in double precision that the others are compared with.
pub(crate) fn all() -> Vec<Box<dyn Peer>> {
    let mut peers: Vec<Box<dyn Peer>> = vec![Box::new(Parry64), Box::new(Parry32)];
    for library in ["warp", "open3d", "libigl", "meshlib", "fcpw", "pysdf"] {
        match InPython::start(library) {
            Ok(peer) => peers.push(Box::new(peer)),
            Err(reason) => println!("without {library}: {reason}"),
        }
    }
    peers.push(Box::new(MeshToSdf));
    peers
}
