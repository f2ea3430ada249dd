//! Picture of a mesh before and after the deformation.

use glam::DVec3;
use isochore_mesh::TriMesh;
use isochore_picture::{Body, Camera, Options, Paint, Panel, PictureError, render};

/// Samples per pixel along each axis. Larger costs more time than most deformations; smaller leaves
/// jagged outlines.
const SAMPLES: usize = 2;

/// Draws both meshes side by side with the same camera, with their vertex colors if they have any.
/// Returns a PNG file.
pub(crate) fn before_and_after(before: &TriMesh, after: &TriMesh, camera: &Camera) -> Result<Vec<u8>, PictureError> {
    let [colors_before, colors_after] = [before, after].map(colors);
    let panels = [("before", before, &colors_before), ("after", after, &colors_after)].map(|(name, mesh, colors)| {
        let body = Body::new(mesh);
        let is_painted = !colors.is_empty();
        Panel::new(name).with(if is_painted { body.with_paint(Paint::Vertices(colors)) } else { body })
    });
    let options = Options { samples: SAMPLES, ..Options::default() };
    Ok(render(&panels, camera, &options)?.to_png())
}

fn colors(mesh: &TriMesh) -> Vec<DVec3> {
    mesh.vertex.colors.iter().map(|color| color.truncate()).collect()
}
