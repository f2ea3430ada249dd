//! Triangle meshes with seams, exact checks and measures, and signed distance.
//!
//! Terms used throughout:
//!
//! - A [`TriMesh`] has *vertices* (positions, topology), *triangles* (three vertex indices, counter-clockwise seen from
//!   outside) and *corners* (a triangle's use of a vertex). Attributes that may differ on the two sides of a seam live on
//!   corners, so a seam never opens the surface.
//! - A signed *distance* is negative inside. Distances are sampled for a [`PointBlock`] of [`LANES`] points at a time.
//! - Lengths are in model units, coordinates are `f64`.

mod aabb;
mod block;
mod distance;
mod monitor;
mod shapes;
mod tri_mesh;

pub use aabb::Aabb;
pub use block::{DistanceBlock, LANES, PointBlock};
pub use distance::Distance;
pub use monitor::{Cancelled, Monitor, Silent};
pub use shapes::{Capsule, Ellipsoid, RoundedBox, ShapeError, Sphere, Torus};
pub use tri_mesh::{CornerAttributes, SubTriangle, Subdivision, TriMesh, VertexAttributes};
