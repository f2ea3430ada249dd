//! The camera, and the projection of a subject onto the picture plane.

use glam::DVec3;
use isochore_mesh::Aabb;

/// Fraction of the panel's half width and half height that the subject may fill.
const FILL: f64 = 0.92;

/// Smallest subject radius relative to its largest coordinate. Smaller: differences of coordinates
/// are rounding errors. Larger: small subjects far from the origin do not fill the panel.
const SMALLEST_SUBJECT: f64 = 1e-9;

/// Direction and field of view of all panels. The distance to the subject follows from these.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Direction from the subject toward the eye, of any length.
    pub direction: DVec3,
    /// Direction that points upward in the picture, of any length.
    pub up: DVec3,
    /// Vertical field of view of a panel, in degrees, clamped to 1 to 120.
    pub field_of_view: f64,
    /// Box to fit into the panel. `None`: all bodies of all panels.
    pub bounds: Option<Aabb>,
}

impl Default for Camera {
    fn default() -> Self {
        Self { direction: DVec3::new(1.0, -1.6, 0.9), up: DVec3::Z, field_of_view: 28.0, bounds: None }
    }
}

impl Camera {
    /// Creates a camera that looks at the subject from `direction`, with z up.
    pub fn from_direction(direction: DVec3) -> Self {
        Self { direction, ..Self::default() }
    }
}

/// A camera fitted to a subject. Converts world coordinates to view coordinates (x right, y up, z
/// toward the eye) and to the picture plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    back: DVec3,
    /// Half width and half height of the picture plane at distance one.
    half_width: f64,
    half_height: f64,
    /// Range of depths of the subject, along the line of sight.
    near: f64,
    far: f64,
    /// Radius of the subject, model units.
    pub(crate) radius: f64,
}

/// A point on the picture plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projected {
    /// From -1 at the left to 1 at the right, and from -1 at the bottom to 1 at the top.
    pub(crate) plane: [f64; 2],
    /// Distance along the line of sight, model units; positive in front of the eye.
    pub(crate) depth: f64,
}

impl View {
    /// Places `camera` so that `points` just fill a panel with the given `aspect` (width over
    /// height).
    pub(crate) fn fit(camera: &Camera, points: impl Iterator<Item = DVec3> + Clone, aspect: f64) -> Self {
        let bounds = Aabb::of(points.clone());
        let (center, extent) =
            if bounds.min.x <= bounds.max.x { (bounds.center(), bounds.size()) } else { (DVec3::ZERO, DVec3::ONE) };
        let radius = (0.5 * extent.length()).max(SMALLEST_SUBJECT * (1.0 + center.abs().max_element()));

        let back = camera.direction.try_normalize().unwrap_or(DVec3::Z);
        let right = [camera.up, DVec3::Y, DVec3::X]
            .into_iter()
            .find_map(|up| up.normalize_or_zero().cross(back).try_normalize())
            .unwrap_or(DVec3::X);
        let up = back.cross(right);

        let half_height = libm::tan(0.5 * camera.field_of_view.clamp(1.0, 120.0).to_radians());
        let mut view = Self {
            eye: center,
            right,
            up,
            back,
            half_width: half_height * aspect,
            half_height,
            near: 0.0,
            far: 0.0,
            radius,
        };
        view.eye = view.tightest_eye(points);
        let depth = (view.eye - center).dot(back);
        view.near = depth - radius;
        view.far = depth + radius;
        view
    }

    /// The nearest eye position whose panel contains all `points`.
    ///
    /// In each direction of the picture plane, the two edges of the panel are planes through the
    /// eye. Both are moved outward until all points are between them.
    fn tightest_eye(&self, points: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
        let farthest = |axis: DVec3, slope: f64| {
            points.clone().fold(f64::NEG_INFINITY, |max, point| {
                let local = point - self.eye;
                max.max(local.dot(axis) + slope * local.dot(self.back))
            })
        };
        let fit = |axis: DVec3, slope: f64| {
            let (above, below) = (farthest(axis, slope), farthest(-axis, slope));
            let (above, below) = if above.is_finite() { (above, below) } else { (self.radius, self.radius) };
            (0.5 * (above - below), 0.5 * (above + below) / slope)
        };
        let (x, distance_x) = fit(self.right, FILL * self.half_width);
        let (y, distance_y) = fit(self.up, FILL * self.half_height);
        // A single point gives distance zero; keep the eye outside the subject.
        let distance = distance_x.max(distance_y).max(self.radius);
        self.eye + x * self.right + y * self.up + distance * self.back
    }

    /// Converts a world point to view coordinates relative to the eye.
    pub(crate) fn local(&self, point: DVec3) -> DVec3 {
        self.turned(point - self.eye)
    }

    /// Converts a world direction to view coordinates.
    pub(crate) fn turned(&self, direction: DVec3) -> DVec3 {
        DVec3::new(direction.dot(self.right), direction.dot(self.up), direction.dot(self.back))
    }

    /// Projects a world point onto the picture plane.
    pub(crate) fn project(&self, point: DVec3) -> Projected {
        let local = self.local(point);
        let depth = -local.z;
        Projected { plane: [local.x / (depth * self.half_width), local.y / (depth * self.half_height)], depth }
    }

    /// View coordinates of the point at `depth` that projects to `plane`.
    pub(crate) fn unproject(&self, plane: [f64; 2], depth: f64) -> DVec3 {
        DVec3::new(plane[0] * depth * self.half_width, plane[1] * depth * self.half_height, -depth)
    }

    /// Fraction of a panel's height that `length` covers at `depth`.
    pub(crate) fn fraction_of_height(&self, length: f64, depth: f64) -> f64 {
        0.5 * length / (depth * self.half_height)
    }

    /// Smallest depth that is drawn. Points at or behind the eye have no image.
    pub(crate) fn nearest_depth(&self) -> f64 {
        1e-3 * self.radius
    }

    /// Depth value for the rasterizer: 0 at the near end of the subject and 1 at the far end.
    ///
    /// It is linear in the reciprocal of the depth, and therefore linear on the picture plane.
    pub(crate) fn order(&self, depth: f64) -> f64 {
        let (near, far) = (self.near.max(self.nearest_depth()), self.far);
        (1.0 / near - 1.0 / depth) / (1.0 / near - 1.0 / far)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subject_fills_the_panel_in_one_direction_and_fits_in_the_other() {
        let points = [DVec3::ZERO, DVec3::new(4.0, 1.0, 0.5), DVec3::new(1.0, 3.0, -2.0), DVec3::new(-1.0, 0.2, 2.0)];
        for direction in [DVec3::X, DVec3::new(1.0, -2.0, 0.7), DVec3::Z, -DVec3::Z] {
            let view = View::fit(&Camera::from_direction(direction), points.iter().copied(), 1.5);
            let max = points
                .iter()
                .flat_map(|&point| view.project(point).plane)
                .fold(0.0, |max: f64, coordinate| max.max(coordinate.abs()));
            // Two points touch the margin exactly, up to rounding.
            assert!((max - FILL).abs() < 1e-12, "{direction}: {max}");
        }
    }

    #[test]
    fn unproject_reverses_project() {
        let points = [DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)];
        let view = View::fit(&Camera::default(), points.iter().copied(), 1.0);
        let point = DVec3::new(0.3, 1.1, 0.7);
        let projected = view.project(point);
        let back = view.unproject(projected.plane, projected.depth);
        assert!(back.distance(view.local(point)) < 1e-14);
    }
}
