//! Generalized winding numbers: how often a surface winds around a point. The surface may be open
//! or intersect itself.
//!
//! Definition: A. Jacobson, L. Kavan, O. Sorkine-Hornung, *Robust Inside-Outside Segmentation using
//! Generalized Winding Numbers* (2013). Sum over clusters: G. Barill, N. Dickson, R. Schmidt, D.
//! Levin, A. Jacobson, *Fast Winding Numbers for Soups and Clouds* (2018). In addition to the
//! paper, every cluster has a bound on the error of its expansion, and clusters are opened until
//! the total bound is small enough for the query.

#[cfg(test)]
mod tests;

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::Bvh;

/// Ratios of radius to distance below which a cluster replaces its triangles. They are tried in
/// order until the error bound is small enough; zero is the exact sum. The first is the cheapest
/// that decides most points of closed meshes.
const OPENINGS: [f64; 4] = [0.25, 0.1, 0.03, 0.0];

/// Winding numbers with respect to the triangles of a [`Bvh`].
///
/// ```
/// use std::sync::Arc;
///
/// use glam::DVec3;
/// use isochore_mesh::{Bvh, WindingNumber, primitives};
///
/// let sphere = primitives::icosphere(1.0, 2);
/// let bvh = Bvh::new(&sphere.positions, &sphere.triangles)?;
/// let winding_number = WindingNumber::new(Arc::new(bvh));
/// assert!((winding_number.at(DVec3::ZERO, 1e-9) - 1.0).abs() < 1e-6);
/// assert_eq!(winding_number.are_inside(&[DVec3::ZERO, DVec3::ONE]), [true, false]);
/// # Ok::<(), isochore_mesh::BvhError>(())
/// ```
#[derive(Debug, Clone)]
pub struct WindingNumber {
    bvh: Arc<Bvh>,
    /// One per node.
    clusters: Vec<Cluster>,
}

/// Moments of the triangles below a node, in the unit frame. In the formulas Aₜ is the area vector
/// of a triangle (area times normal) and cₜ its centroid.
#[derive(Debug, Clone, Copy)]
struct Cluster {
    /// Area-weighted mean of cₜ.
    center: DVec3,
    /// Upper bound on the distance from the center to any point of a triangle.
    radius: f64,
    /// Σ |Aₜ|
    area: f64,
    /// Σ Aₜ
    area_vector: DVec3,
    /// Σ Aₜ (cₜ − center)ᵀ
    first_moment: DMat3,
}

impl WindingNumber {
    /// Computes the moments of all nodes, bottom-up.
    pub fn new(bvh: Arc<Bvh>) -> Self {
        let mut clusters = vec![Cluster::EMPTY; bvh.nodes().len()];
        // Children follow their parents.
        for (i, node) in bvh.nodes().iter().enumerate().rev() {
            let parts = if node.is_leaf() {
                let slots = node.first..node.first + node.count;
                Cluster::join(slots.map(|slot| Cluster::of_triangle(&bvh.corners(slot))))
            } else {
                let first = node.first as usize;
                Cluster::join(clusters[first..first + 2].iter().copied())
            };
            let min = DVec3::from_array(node.min.map(f64::from));
            let max = DVec3::from_array(node.max.map(f64::from));
            let radius = (parts.center - min).max(max - parts.center).length();
            clusters[i] = Cluster { radius, ..parts };
        }
        Self { bvh, clusters }
    }

    /// Returns the winding number of a point with an error of at most `tolerance`: one inside a
    /// closed surface, zero outside, two where two volumes overlap, a fraction near holes. On the
    /// surface itself the number jumps, and any value in between may be returned.
    pub fn at(&self, point: DVec3, tolerance: f64) -> f64 {
        let point = self.bvh.frame().to_unit(point);
        self.refine(point, |_, error| error <= tolerance)
    }

    /// Whether the winding number exceeds one half.
    pub fn is_inside(&self, point: DVec3) -> bool {
        self.exceeds(point, 0.5)
    }

    /// Whether the winding number exceeds `threshold`.
    pub(crate) fn exceeds(&self, point: DVec3, threshold: f64) -> bool {
        let point = self.bvh.frame().to_unit(point);
        self.refine(point, |number, error| (number - threshold).abs() > error) > threshold
    }

    /// Whether the absolute winding number is certainly below one half at all points within `reach`
    /// of `center`.
    ///
    /// The solid angle of a triangle is at most its area over its squared distance, in any
    /// orientation.
    pub(crate) fn is_below_half(&self, center: DVec3, reach: f64) -> bool {
        let (center, reach) = (self.bvh.frame().to_unit(center), reach * self.bvh.frame().scale());
        let gap_to = |middle: DVec3, radius: f64| (middle - center).length() - radius - reach;
        let mut angle = 0.0;
        let mut stack = Vec::with_capacity(self.bvh.stack_capacity());
        stack.push(0);
        while let Some(index) = stack.pop() {
            let (node, cluster) = (&self.bvh.nodes()[index as usize], &self.clusters[index as usize]);
            let gap = gap_to(cluster.center, cluster.radius);
            if gap > cluster.radius {
                angle += cluster.area / (gap * gap);
            } else if node.is_leaf() {
                for slot in node.first..node.first + node.count {
                    let corners = self.bvh.corners(slot);
                    let Cluster { center, area, .. } = Cluster::of_triangle(&corners);
                    let radius = corners.into_iter().map(|corner| corner.distance(center)).fold(0.0, f64::max);
                    let gap = gap_to(center, radius);
                    angle += if gap > 0.0 { area / (gap * gap) } else { f64::INFINITY };
                }
            } else {
                stack.extend([node.first, node.first + 1]);
            }
            // Half of the sphere, slightly less to allow for rounding.
            if angle > 1.999 * PI {
                return false;
            }
        }
        true
    }

    /// The hierarchy of the triangles.
    pub(crate) fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// [`is_inside`](Self::is_inside) for many points in parallel.
    pub fn are_inside(&self, points: &[DVec3]) -> Vec<bool> {
        points.par_iter().map(|&point| self.is_inside(point)).collect()
    }

    /// Opens more clusters until `is_enough` accepts the sum and its error bound.
    fn refine(&self, point: DVec3, is_enough: impl Fn(f64, f64) -> bool) -> f64 {
        let mut number = 0.0;
        for opening in OPENINGS {
            let (sum, error) = self.sum(point, opening);
            number = sum;
            if is_enough(sum, error) {
                break;
            }
        }
        number
    }

    /// Returns the sum at a point of the unit frame, and a bound on its error.
    fn sum(&self, point: DVec3, opening: f64) -> (f64, f64) {
        let nodes = self.bvh.nodes();
        let (mut angle, mut error) = (0.0, 0.0);
        let mut stack = Vec::with_capacity(self.bvh.stack_capacity());
        stack.push(0);
        while let Some(index) = stack.pop() {
            let cluster = &self.clusters[index as usize];
            let offset = cluster.center - point;
            let distance2 = offset.length_squared();
            if cluster.radius * cluster.radius < opening * opening * distance2 {
                let (part, bound) = cluster.solid_angle(offset, distance2);
                angle += part;
                error += bound;
                continue;
            }
            let node = &nodes[index as usize];
            if node.is_leaf() {
                for slot in node.first..node.first + node.count {
                    angle += solid_angle(self.bvh.corners(slot).map(|corner| corner - point));
                }
            } else {
                stack.push(node.first + 1);
                stack.push(node.first);
            }
        }
        (angle / (4.0 * PI), error / (4.0 * PI))
    }
}

impl Cluster {
    const EMPTY: Self =
        Self { center: DVec3::ZERO, radius: 0.0, area: 0.0, area_vector: DVec3::ZERO, first_moment: DMat3::ZERO };

    fn of_triangle(&[a, b, c]: &[DVec3; 3]) -> Self {
        let area_vector = 0.5 * (b - a).cross(c - a);
        Self { center: (a + b + c) / 3.0, area: area_vector.length(), area_vector, ..Self::EMPTY }
    }

    /// Moments of all `parts` together. The caller sets the radius.
    fn join(parts: impl Iterator<Item = Self> + Clone) -> Self {
        let area: f64 = parts.clone().map(|part| part.area).sum();
        let count = parts.clone().count() as f64;
        let center = if area > 0.0 {
            parts.clone().map(|part| part.center * (part.area / area)).sum()
        } else {
            parts.clone().map(|part| part.center / count).sum()
        };
        parts.fold(Self { center, area, ..Self::EMPTY }, |mut sum, part| {
            sum.area_vector += part.area_vector;
            sum.first_moment += part.first_moment + outer(part.area_vector, part.center - center);
            sum
        })
    }

    /// Solid angle of a cluster whose center is at `offset` from the viewpoint, with a bound on its
    /// error. It is the expansion of the kernel K(r) = r/|r|³ to first order.
    ///
    /// K is minus the gradient of 1/|r|. The j-th derivative of 1/|r| along any unit vectors is at
    /// most j!/|r|^(j+1). So the j-th term of the expansion is at most (j+1) ρʲ/|r|^(j+2) per unit
    /// of area. With x = ρ/|r|, the terms from the second on sum to at most x² (3 − 2x) / (1 − x)²
    /// / |r|².
    fn solid_angle(&self, offset: DVec3, distance2: f64) -> (f64, f64) {
        let distance = distance2.sqrt();
        let moment = &self.first_moment;
        let trace = moment.x_axis.x + moment.y_axis.y + moment.z_axis.z;
        let stretch = offset.dot(*moment * offset) / distance2;
        let angle = (self.area_vector.dot(offset) + trace - 3.0 * stretch) / (distance2 * distance);
        let x = self.radius / distance;
        let bound = self.area / distance2 * (x * x * (3.0 - 2.0 * x)) / ((1.0 - x) * (1.0 - x));
        (angle, bound)
    }
}

/// u vᵀ
fn outer(u: DVec3, v: DVec3) -> DMat3 {
    DMat3::from_cols(u * v.x, u * v.y, u * v.z)
}

/// Signed solid angle of a triangle seen from the origin, positive from behind (A. van Oosterom and
/// J. Strackee, *The Solid Angle of a Plane Triangle*, 1983, equation 8).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    let cosines = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * libm::atan2(volume, cosines)
}
