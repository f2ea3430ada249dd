//! Visibility: the triangle in front at each sample of a panel.

use euc::{
    Interpolate, Pipeline,
    buffer::Buffer2d,
    rasterizer::{BackfaceCullingDisabled, Triangles},
};

use crate::camera::Projected;
use crate::camera::View;

/// Triangles with a smaller projected area (in units of half the panel size, squared) are not
/// drawn. Larger: up to ten times this value, no visible triangle is lost. Smaller: reciprocals of
/// areas overflow single precision.
const SMALLEST_IMAGE: f64 = 1e-10;

/// Point of a triangle that is visible at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fragment {
    /// Index of the triangle.
    pub(crate) triangle: u32,
    /// Barycentric weights of the three corners, linear on the picture plane.
    pub(crate) weights: [f32; 3],
}

/// Visible points at the samples of a panel, row by row from the top.
pub(crate) struct Fragments {
    /// Samples per row.
    pub(crate) width: usize,
    /// Rows of samples.
    pub(crate) height: usize,
    visible: Buffer2d<Option<Fragment>>,
}

impl Fragments {
    /// Rasterizes triangles whose vertices have been projected.
    pub(crate) fn draw(
        view: &View,
        vertices: &[Projected],
        triangles: &[[u32; 3]],
        [width, height]: [usize; 2],
    ) -> Self {
        let mut visible = Buffer2d::new([width, height], None);
        let mut depth = Buffer2d::new([width, height], f32::INFINITY);
        let corners: Vec<Corner> = triangles
            .iter()
            .enumerate()
            .filter_map(|(index, triangle)| {
                let corners = triangle.map(|vertex| vertices[vertex as usize]);
                has_image(view, &corners).then(|| {
                    let mut number = 0;
                    corners.map(|corner| {
                        let weights = std::array::from_fn(|i| if i == number { 1.0 } else { 0.0 });
                        number += 1;
                        let [x, y] = corner.plane.map(|coordinate| coordinate as f32);
                        let position = [x, y, view.order(corner.depth) as f32, 1.0];
                        Corner { position, fragment: Fragment { triangle: index as u32, weights } }
                    })
                })
            })
            .flatten()
            .collect();
        Visibility.draw::<Triangles<_, BackfaceCullingDisabled>, _>(&corners, &mut visible, Some(&mut depth));
        Self { width, height, visible }
    }

    /// The samples of `row`.
    pub(crate) fn row(&self, row: usize) -> &[Option<Fragment>] {
        &self.visible.as_ref()[row * self.width..(row + 1) * self.width]
    }
}

/// Returns true if a triangle is in front of the eye, near the panel, and large enough to be drawn.
fn has_image(view: &View, corners: &[Projected; 3]) -> bool {
    // Beyond this distance from the panel, the rasterizer's integers are not exact.
    const FARTHEST_OUT: f64 = 1e3;
    let [a, b, c] = corners.map(|corner| corner.plane);
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    area.abs() > SMALLEST_IMAGE
        && corners.iter().all(|corner| {
            corner.depth > view.nearest_depth() && corner.plane.iter().all(|coordinate| coordinate.abs() < FARTHEST_OUT)
        })
}

struct Corner {
    position: [f32; 4],
    fragment: Fragment,
}

struct Visibility;

impl Pipeline for Visibility {
    type Vertex = Corner;
    type VsOut = Fragment;
    type Pixel = Option<Fragment>;

    fn vert(&self, corner: &Corner) -> ([f32; 4], Fragment) {
        (corner.position, corner.fragment)
    }

    fn frag(&self, fragment: &Fragment) -> Option<Fragment> {
        Some(*fragment)
    }
}

impl Interpolate for Fragment {
    fn lerp2(a: Self, b: Self, x: f32, y: f32) -> Self {
        Self { triangle: a.triangle, weights: std::array::from_fn(|i| a.weights[i] * x + b.weights[i] * y) }
    }

    fn lerp3(a: Self, b: Self, c: Self, x: f32, y: f32, z: f32) -> Self {
        let weights = std::array::from_fn(|i| a.weights[i] * x + b.weights[i] * y + c.weights[i] * z);
        Self { triangle: a.triangle, weights }
    }
}
