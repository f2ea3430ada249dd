mod open_edges;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::DVec3;

pub(crate) use open_edges::open_edges;

use crate::bvh::closest_on_triangle;
use crate::compensated_sum::sum_terms;
use crate::pseudo_normals::PseudoNormals;
use crate::{
    Aabb, Bvh, ClosestPoint, Distance, DistanceBlock, LANES, Monitor, PointBlock, SelfIntersectionError,
    SelfIntersections, TriMesh, WindingNumber,
};

/// Ratio of height to longest edge of a triangle below which its normal is not trusted for signs.
/// Larger: meshes with needles use the winding number, which is slower. Smaller: rounding rotates
/// such a normal by up to 1e-16 divided by this value.
const NEEDLE: f64 = 1e-6;

/// The exact signed distance to a mesh, with one query of its hierarchy per point.
///
/// A point is inside if its winding number exceeds one half. For a single closed, oriented manifold
/// without self-intersections or needles, the normal of the nearest feature gives the same sign
/// faster.
///
/// ```
/// use glam::{DVec3, dvec3};
/// use isochore_mesh::{Distance, MeshDistance, NoProgress, primitives};
///
/// let cube = primitives::box_mesh(DVec3::ONE, [1, 1, 1]);
/// let distance = MeshDistance::new(&cube, &NoProgress)?;
/// let (value, gradient) = distance.sample(dvec3(0.0, 0.2, 3.0));
/// assert!((value - 2.0).abs() < 1e-12);
/// assert!((gradient - DVec3::Z).length() < 1e-12);
/// assert!(distance.is_inside(DVec3::ZERO));
/// # Ok::<(), isochore_mesh::SelfIntersectionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct MeshDistance {
    bvh: Arc<Bvh>,
    sides: Sides,
    bounds: Aabb,
    centroid: DVec3,
}

/// Method that distinguishes inside from outside.
#[derive(Debug, Clone)]
enum Sides {
    PseudoNormals(Box<PseudoNormals>),
    WindingNumber(WindingNumber),
}

impl MeshDistance {
    /// Prepares the distance to `mesh`, and checks whether pseudonormals can decide its signs.
    ///
    /// # Errors
    /// [`SelfIntersectionError::Mesh`] if the mesh has no triangles, an index out of range or a
    /// coordinate that is not finite; [`SelfIntersectionError::Cancelled`] if the monitor stops the
    /// work.
    pub fn new(mesh: &TriMesh, monitor: &dyn Monitor) -> Result<Self, SelfIntersectionError> {
        let bvh = Arc::new(Bvh::new(&mesh.positions, &mesh.triangles)?);
        let is_simple =
            is_simple(mesh) && SelfIntersections::among(&mesh.positions, &mesh.triangles, monitor)?.is_empty();
        let is_closed = open_edges(&mesh.triangles, mesh.positions.len()).is_empty();
        let volume_and_centroid = is_closed.then(|| mesh.volume_and_centroid(bvh.bounds()));
        let centroid = surface_centroid(mesh, bvh.bounds(), volume_and_centroid);
        monitor.check("signs", 0.0)?;
        let sides = if is_simple {
            Sides::PseudoNormals(Box::new(PseudoNormals::new(&bvh, mesh.positions.len())))
        } else {
            Sides::WindingNumber(WindingNumber::new(bvh.clone()))
        };
        Ok(Self { bounds: bvh.bounds(), centroid, bvh, sides })
    }

    /// Returns the nearest point of the mesh.
    pub fn closest_point(&self, point: DVec3) -> ClosestPoint {
        self.bvh.closest_point(point)
    }

    /// Whether `point` is inside.
    pub fn is_inside(&self, point: DVec3) -> bool {
        match &self.sides {
            Sides::PseudoNormals(normals) => {
                let local = self.bvh.frame().to_unit(point);
                let slot = self.bvh.nearest(local, None).slot;
                let (nearest, _) = closest_on_triangle(local, &self.bvh.corners(slot));
                normals.is_inside(&self.bvh, local, slot, &nearest)
            }
            Sides::WindingNumber(winding_number) => winding_number.is_inside(point),
        }
    }

    /// Whether the normal of the nearest feature alone decides the sign.
    pub fn uses_pseudo_normals(&self) -> bool {
        matches!(self.sides, Sides::PseudoNormals(_))
    }

    fn signed(&self, point: DVec3) -> (f64, DVec3) {
        let local = self.bvh.frame().to_unit(point);
        let found = self.bvh.nearest(local, None);
        let (nearest, _) = closest_on_triangle(local, &self.bvh.corners(found.slot));
        let is_inside = match &self.sides {
            Sides::PseudoNormals(normals) => normals.is_inside(&self.bvh, local, found.slot, &nearest),
            Sides::WindingNumber(winding_number) => winding_number.is_inside(point),
        };
        let sign = if is_inside { -1.0 } else { 1.0 };
        let gradient = (local - nearest.point).normalize_or_zero() * sign;
        (sign * found.squared.sqrt() / self.bvh.frame().scale(), gradient)
    }
}

impl Distance for MeshDistance {
    /// On the mesh the gradient is zero.
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        for lane in 0..LANES {
            let (value, gradient) = self.signed(points.get(lane));
            out.value[lane] = value;
            out.gradient.set(lane, gradient);
        }
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Centroid of the volume. Centroid of the area if the mesh is open or encloses no volume.
    fn centroid(&self) -> DVec3 {
        self.centroid
    }
}

/// Whether a mesh without self-intersections bounds one connected volume and has trustworthy
/// normals.
fn is_simple(mesh: &TriMesh) -> bool {
    let check = mesh.check();
    check.is_closed()
        && check.is_oriented()
        && check.is_manifold()
        && mesh.components().count == 1
        && mesh.volume() > 0.0
        && (0..mesh.triangles.len()).all(|triangle| {
            let [a, b, c] = mesh.corners(triangle);
            let longest2 = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
            (b - a).cross(c - a).length() > NEEDLE * longest2
        })
}

/// Centroid of the surface of a mesh. For a closed mesh, `closed` is its volume and the centroid of
/// the volume, which is returned. The centroid of the area is returned if the mesh is open or
/// encloses almost no volume.
pub(crate) fn surface_centroid(mesh: &TriMesh, bounds: Aabb, closed: Option<(f64, DVec3)>) -> DVec3 {
    let size = bounds.size().max_element();
    if let Some((_, centroid)) = closed.filter(|(volume, _)| volume.abs() > LEAST_VOLUME * size * size * size) {
        return centroid;
    }
    // Relative to the center, to avoid cancellation far from the origin.
    let center = bounds.center();
    let [area, x, y, z] = sum_terms(mesh.triangles.len(), |triangle| {
        let [a, b, c] = mesh.corners(triangle).map(|corner| corner - center);
        let part = (b - a).cross(c - a).length();
        let moment = part * (a + b + c) / 3.0;
        [part, moment.x, moment.y, moment.z]
    });
    if area > 0.0 { center + DVec3::new(x, y, z) / area } else { center }
}

/// Fraction of the bounding cube below which a volume has no reliable centroid. Larger: thin sheets
/// get the centroid of their area. Smaller: rounding could move the centroid anywhere.
const LEAST_VOLUME: f64 = 1e-9;
