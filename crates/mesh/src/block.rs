//! Blocks of points: structures of arrays for kernels that the compiler vectorizes.

use glam::DVec3;

/// Number of points in a block. A single point is sampled as a block of copies.
pub const LANES: usize = 16;

/// Coordinates of [`LANES`] points.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::PointBlock;
///
/// let block = PointBlock::gather(&[DVec3::X, DVec3::Y]);
/// assert_eq!(block.get(0), DVec3::X);
/// assert_eq!(block.get(15), DVec3::Y);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct PointBlock {
    /// First coordinates.
    pub x: [f64; LANES],
    /// Second coordinates.
    pub y: [f64; LANES],
    /// Third coordinates.
    pub z: [f64; LANES],
}

impl PointBlock {
    /// All lanes at the origin.
    pub const ZERO: Self = Self { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] };

    /// The same point in every lane.
    pub fn splat(point: DVec3) -> Self {
        Self { x: [point.x; LANES], y: [point.y; LANES], z: [point.z; LANES] }
    }

    /// Collects up to [`LANES`] points; copies of the last point fill the remaining lanes.
    ///
    /// # Panics
    /// If `points` is empty or longer than [`LANES`].
    pub fn gather(points: &[DVec3]) -> Self {
        assert!(!points.is_empty() && points.len() <= LANES, "a block holds 1 to {LANES} points");
        let mut block = Self::splat(points[points.len() - 1]);
        for (lane, &point) in points.iter().enumerate() {
            block.set(lane, point);
        }
        block
    }

    /// Returns the point in `lane`.
    pub fn get(&self, lane: usize) -> DVec3 {
        DVec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    /// Sets the point in `lane`.
    pub fn set(&mut self, lane: usize, point: DVec3) {
        self.x[lane] = point.x;
        self.y[lane] = point.y;
        self.z[lane] = point.z;
    }
}

/// Signed distances and their gradients at the points of a [`PointBlock`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct DistanceBlock {
    /// Signed distances, negative inside, model units; infinite beyond the reach of a sampled
    /// field.
    pub value: [f64; LANES],
    /// Gradients of the function that is evaluated; zero wherever `value` is infinite or has no
    /// gradient.
    pub gradient: PointBlock,
}

impl DistanceBlock {
    /// Infinite distances with zero gradients.
    pub const FAR: Self = Self { value: [f64::INFINITY; LANES], gradient: PointBlock::ZERO };
}
