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
mod assets;
mod block;
mod bvh;
mod check;
mod closed_mesh;
mod compensated_sum;
mod distance;
mod distance_field;
mod edit_mesh;
mod extremes;
mod grid_mesh;
mod huge_pages;
pub mod io;
mod journaled;
mod measure;
mod mesh_distance;
mod monitor;
mod morton_order;
mod position_table;
pub mod primitives;
mod pseudo_normals;
mod self_intersection;
mod shapes;
mod surface_tree;
mod topology;
mod tri_mesh;
mod winding_number;

pub use aabb::Aabb;
pub use assets::{Assets, GltfAssets, Names};
pub use block::{DistanceBlock, LANES, PointBlock};
pub use bvh::{Bvh, BvhError, ClosestPoint, Feature};
pub use check::Check;
pub use closed_mesh::{ClosedMesh, MeshError};
pub use compensated_sum::{CompensatedSum, sum_terms};
pub use distance::Distance;
pub use distance_field::{DistanceField, DistanceFieldError, DistanceFieldOptions, Grid, Padding};
pub use edit_mesh::{
    Collapsed, EditDelta, EditMesh, EditMeshError, EditTriangle, Fan, NONE, Split, next as next_half_edge,
    previous as previous_half_edge,
};
pub use grid_mesh::GridMesh;
pub use journaled::{Delta, FreeSlots, Journaled};
pub use measure::{Components, EdgeLengths, VolumeFrame, signed_volume};
pub use mesh_distance::MeshDistance;
pub use monitor::{Cancelled, Monitor, NoProgress};
pub use self_intersection::{SelfIntersectionError, SelfIntersections};
pub use shapes::{Capsule, Ellipsoid, HalfSpace, RoundedBox, ShapeError, Sphere, Torus};
pub use surface_tree::{SurfaceHit, SurfaceTree};
pub use topology::Topology;
pub use tri_mesh::{
    AttributeError, CornerAttributes, Origin, Resampling, SkinError, SkinTable, SplitError, SubTriangle, Subdivision,
    TriMesh, TriangleSide, TriangleSplit, VertexAttributes, VertexOrigin,
};
pub use winding_number::WindingNumber;
