//! Visibility: which triangle is seen at each sample of a panel.

use euc::{
    Interpolate, Pipeline,
    buffer::Buffer2d,
    rasterizer::{BackfaceCullingDisabled, Triangles},
};

use crate::camera::Projected;
use crate::camera::View;

/// Triangles whose image is smaller than this are not drawn (squares of half panel sizes). Far below a sample, so that
/// nothing visible is lost if larger by ten; if much smaller, reciprocals of areas overflow single precision.
const SMALLEST_IMAGE: f64 = 1e-10;

/// What is seen at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fragment {
    /// Index of the triangle.
    pub(crate) triangle: u32,
    /// Shares of the three corners, on the picture plane.
    pub(crate) shares: [f32; 3],
}

/// What is seen at the samples of a panel, row by row from the top.
pub(crate) struct Fragments {
    /// Samples in a row.
    pub(crate) width: usize,
    /// Rows of samples.
    pub(crate) height: usize,
    seen: Buffer2d<Option<Fragment>>,
}

impl Fragments {
    /// Draws triangles whose vertices have been projected.
    pub(crate) fn draw(
        view: &View,
        vertices: &[Projected],
        triangles: &[[u32; 3]],
        [width, height]: [usize; 2],
    ) -> Self {
        let mut seen = Buffer2d::new([width, height], None);
        let mut depth = Buffer2d::new([width, height], f32::INFINITY);
        let corners: Vec<Corner> = triangles
            .iter()
            .enumerate()
            .filter_map(|(index, triangle)| {
                let corners = triangle.map(|vertex| vertices[vertex as usize]);
                has_image(view, &corners).then(|| {
                    let mut place = 0;
                    corners.map(|corner| {
                        let shares = std::array::from_fn(|i| if i == place { 1.0 } else { 0.0 });
                        place += 1;
                        let [x, y] = corner.plane.map(|coordinate| coordinate as f32);
                        let position = [x, y, view.order(corner.depth) as f32, 1.0];
                        Corner { position, fragment: Fragment { triangle: index as u32, shares } }
                    })
                })
            })
            .flatten()
            .collect();
        Visibility.draw::<Triangles<_, BackfaceCullingDisabled>, _>(&corners, &mut seen, Some(&mut depth));
        Self { width, height, seen }
    }

    /// The samples of `row`.
    pub(crate) fn row(&self, row: usize) -> &[Option<Fragment>] {
        &self.seen.as_ref()[row * self.width..(row + 1) * self.width]
    }
}

/// Whether a triangle lies before the eye, near the panel, and large enough to be drawn.
fn has_image(view: &View, corners: &[Projected; 3]) -> bool {
    // Images farther out than this leave the range in which the rasterizer's integers are exact.
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
        Self { triangle: a.triangle, shares: std::array::from_fn(|i| a.shares[i] * x + b.shares[i] * y) }
    }

    fn lerp3(a: Self, b: Self, c: Self, x: f32, y: f32, z: f32) -> Self {
        let shares = std::array::from_fn(|i| a.shares[i] * x + b.shares[i] * y + c.shares[i] * z);
        Self { triangle: a.triangle, shares }
    }
}
