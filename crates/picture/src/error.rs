//! Errors of [`render`](crate::render).

/// Input that cannot be rendered. Panels and bodies count from zero.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PictureError {
    /// The picture has no pixels or samples, or too many of them.
    #[error(
        "a picture of {width} x {height} pixels with {samples} x {samples} samples per pixel is empty or too large"
    )]
    Size {
        /// Requested width, pixels.
        width: usize,
        /// Requested height, pixels.
        height: usize,
        /// Requested samples per pixel, in each direction.
        samples: usize,
    },
    /// The list of panels is empty, or the panels and their captions do not fit into the picture.
    #[error("{panels} panels with their captions do not fit into the picture")]
    Panels {
        /// Number of panels.
        panels: usize,
    },
    /// A triangle uses a vertex that does not exist.
    #[error("panel {panel}, body {body}: triangle {triangle} uses vertex {vertex}, which does not exist")]
    Index {
        /// Panel.
        panel: usize,
        /// Body in the panel.
        body: usize,
        /// Triangle of the body's mesh.
        triangle: usize,
        /// The missing vertex.
        vertex: u32,
    },
    /// The number of colors differs from the number of vertices or triangles that they paint.
    #[error("panel {panel}, body {body}: {colors} colors for {elements} elements; give one color per element")]
    Colors {
        /// Panel.
        panel: usize,
        /// Body in the panel.
        body: usize,
        /// Number of colors.
        colors: usize,
        /// Number of vertices or triangles of the mesh.
        elements: usize,
    },
}
