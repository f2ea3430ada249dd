//! Axis-aligned boxes.

use glam::DVec3;

/// An axis-aligned bounding box. It is empty if `min > max` on any axis.
///
/// ```
/// use glam::{DVec3, dvec3};
/// use isochore_mesh::Aabb;
///
/// let aabb = Aabb::of([DVec3::ZERO, dvec3(2.0, 1.0, 1.0)]);
/// assert_eq!(aabb.center(), dvec3(1.0, 0.5, 0.5));
/// assert_eq!(aabb.distance(dvec3(5.0, 0.5, 0.5)), 3.0);
/// assert!(aabb.overlaps(aabb.translated(DVec3::X)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates.
    pub max: DVec3,
}

impl Aabb {
    /// The empty box.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box that contains all `points`; [`EMPTY`](Self::EMPTY) for an empty iterator.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |aabb, point| aabb.including(point))
    }

    /// The smallest box that contains this one and `point`.
    pub fn including(self, point: DVec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box that contains both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the two boxes have a point in common.
    pub fn overlaps(self, other: Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// This box grown by `margin` on every side.
    pub fn expanded(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// This box moved by `shift`.
    pub fn translated(self, shift: DVec3) -> Self {
        Self { min: self.min + shift, max: self.max + shift }
    }

    /// Edge lengths of the box.
    pub fn size(self) -> DVec3 {
        self.max - self.min
    }

    /// Midpoint of the box.
    pub fn center(self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// Distance from `point` to the box, model units; zero inside.
    pub fn distance(self, point: DVec3) -> f64 {
        (self.min - point).max(point - self.max).max(DVec3::ZERO).length()
    }

    /// The eight corners, x fastest.
    pub fn corners(self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            DVec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }
}
