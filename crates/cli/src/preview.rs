//! The picture of a mesh before and after.

use isochore_mesh::TriMesh;
use isochore_picture::{Body, Camera, Options, Panel, PictureError, render};

/// Samples a pixel in each direction: one more costs more than most deformations, one fewer leaves jagged outlines.
const SAMPLES: usize = 2;

/// Both meshes side by side, seen by the same camera, as PNG.
pub(crate) fn before_and_after(before: &TriMesh, after: &TriMesh) -> Result<Vec<u8>, PictureError> {
    let panels = [("before", before), ("after", after)].map(|(name, mesh)| Panel::new(name).with(Body::new(mesh)));
    let options = Options { samples: SAMPLES, ..Options::default() };
    Ok(render(&panels, &Camera::default(), &options)?.to_png())
}
