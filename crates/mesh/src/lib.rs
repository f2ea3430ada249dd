//! Triangle meshes with seams: file input and output, exact checks, measures, signed distance and
//! edits.
//!
//! # Terms
//!
//! - A [`TriMesh`] has *vertices* (positions and topology), *triangles* (three vertex indices,
//!   counter-clockwise seen from outside) and *corners* (the use of a vertex by a triangle).
//! - A *seam* is an edge whose two sides have different corner attributes, such as texture
//!   coordinates. Attributes are stored on corners, so a seam never opens the surface.
//! - A *half-edge* `3 t + k` is side `k` of triangle `t`. Its *twin* is the half-edge on the other
//!   side of the edge. The triangles around a vertex form a *fan*.
//! - A mesh is *valid* if all indices are in range and all positions finite. It is *closed* if
//!   every edge has two triangles; a [`ClosedMesh`] is proven to be closed and consistently
//!   oriented.
//! - A *signed distance* is negative inside. Distances are evaluated for a [`PointBlock`] of
//!   [`LANES`] points at a time.
//!
//! Lengths are in model units, angles in radians, coordinates are `f64`.
//!
//! # Invariants
//!
//! - The same input yields the same bits, for any number of threads and any width of vector
//!   registers.
//! - The volume is the compensated sum over triangles of a · (b × c) / 6, relative to the center of
//!   the bounds.
//! - Predicates of [`TriMesh::check`], [`SelfIntersections`] and [`triangles_intersect`] are exact,
//!   not subject to a tolerance.
//! - Attributes are interpolated once, in the original triangle. Unmoved values keep their bits.
//! - Undo of an [`EditMesh`] or a [`Journaled`] array restores every bit.
//!
//! # Not guaranteed
//!
//! - A mesh that was read is valid, but it need not be closed, oriented or free of degenerate
//!   triangles.
//! - A [`ClosedMesh`] may intersect itself or be inside out.
//! - Formats in single precision round positions; see `io::Format::stored`. Formats drop the
//!   attributes that they cannot store.
//! - Tangents, morph targets, cameras and lights of glTF are not kept.
//! - Indices are `u32`; larger meshes are refused or panic.
//!
//! # Features
//!
//! `io` (default) adds the module `io` and the libraries for its formats. An application that
//! creates meshes itself can use `default-features = false`.
//!
//! # Stages
//!
//! Read, or create a mesh of [`primitives`]:
//!
//! ```
//! # #[cfg(feature = "io")]
//! # fn main() -> Result<(), isochore_mesh::io::ParseError> {
//! use isochore_mesh::io::{self, Format};
//!
//! let mesh = io::read_bytes(Format::Obj, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")?;
//! assert_eq!(mesh.triangles, [[0, 1, 2]]);
//! # Ok(())
//! # }
//! # #[cfg(not(feature = "io"))]
//! # fn main() {}
//! ```
//!
//! Check:
//!
//! ```
//! use isochore_mesh::{ClosedMesh, primitives};
//!
//! let ball = primitives::icosphere(1.0, 3);
//! let check = ball.check();
//! assert!(check.is_closed() && check.is_oriented() && check.is_manifold());
//! assert!(ClosedMesh::new(&ball).is_ok());
//! ```
//!
//! Measure:
//!
//! ```
//! # let ball = isochore_mesh::primitives::icosphere(1.0, 3);
//! // An inscribed polyhedron is smaller than the ball of volume 4/3 π.
//! assert!((4.1..4.2).contains(&ball.volume()));
//! assert_eq!(ball.euler_characteristic(), 2);
//! ```
//!
//! Distance:
//!
//! ```
//! use glam::dvec3;
//! use isochore_mesh::{Distance, MeshDistance, NoProgress, primitives};
//!
//! let distance = MeshDistance::new(&primitives::icosphere(1.0, 3), &NoProgress)?;
//! let (value, gradient) = distance.sample(dvec3(0.0, 0.0, 3.0));
//! assert!((value - 2.0).abs() < 0.02 && gradient.z > 0.99);
//! # Ok::<(), isochore_mesh::SelfIntersectionError>(())
//! ```
//!
//! Self-intersection:
//!
//! ```
//! use glam::DVec3;
//! use isochore_mesh::{NoProgress, SelfIntersections, primitives};
//!
//! let mut ball = primitives::icosphere(1.0, 2);
//! assert!(SelfIntersections::of(&ball, &NoProgress)?.is_empty());
//! ball.positions[0] *= -2.0;
//! assert!(!SelfIntersections::of(&ball, &NoProgress)?.is_empty());
//! # Ok::<(), isochore_mesh::SelfIntersectionError>(())
//! ```
//!
//! Edit the topology, with undo:
//!
//! ```
//! use isochore_mesh::{EditMesh, primitives};
//!
//! let ball = primitives::icosphere(1.0, 2);
//! let mut mesh = EditMesh::new(&ball.triangles, ball.positions.len())?;
//! let alive = mesh.begin();
//! let half_edge = mesh.outgoing(0);
//! assert!(mesh.can_flip(half_edge));
//! mesh.flip(half_edge);
//! let mut delta = mesh.finish(alive);
//! mesh.swap(&mut delta);
//! assert_eq!(mesh.outgoing(0), half_edge);
//! # Ok::<(), isochore_mesh::EditMeshError>(())
//! ```
//!
//! Split to a longest edge:
//!
//! ```
//! use isochore_mesh::{NoProgress, primitives};
//!
//! let ball = primitives::icosphere(1.0, 1);
//! let fine = ball.subdivided(&ball.split_to_length(0.2, 10_000, &NoProgress)?);
//! assert!(fine.triangles.len() > ball.triangles.len());
//! # Ok::<(), isochore_mesh::SplitError>(())
//! ```
//!
//! Write:
//!
//! ```
//! # #[cfg(feature = "io")]
//! # fn main() -> Result<(), isochore_mesh::io::WriteError> {
//! use isochore_mesh::{io, primitives};
//!
//! let mut bytes = Vec::new();
//! io::write_to(io::Format::Glb, &primitives::icosphere(1.0, 2), &mut bytes)?;
//! assert!(bytes.starts_with(b"glTF"));
//! # Ok(())
//! # }
//! # #[cfg(not(feature = "io"))]
//! # fn main() {}
//! ```

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
#[cfg(feature = "io")]
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
mod surface_walk;
mod topology;
mod tri_mesh;
mod winding_number;

pub use aabb::Aabb;
pub use assets::{Assets, GltfAssets, Names};
pub use block::{DistanceBlock, LANES, PointBlock};
pub use bvh::{Bvh, BvhError, ClosestPoint, Feature, nearest_on_triangle};
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
pub use self_intersection::{SelfIntersectionError, SelfIntersections, patch_intersects, triangles_intersect};
pub use shapes::{Capsule, Ellipsoid, HalfSpace, RoundedBox, ShapeError, Sphere, Torus};
pub use surface_tree::{SurfaceHit, SurfaceTree};
pub use surface_walk::{Foot, SurfaceWalk};
pub use topology::Topology;
pub use tri_mesh::{
    AttributeError, CornerAttributes, Origin, Resampling, SkinError, SkinTable, SplitError, SubTriangle, Subdivision,
    TriMesh, TriangleSide, TriangleSplit, VertexAttributes, VertexOrigin,
};
pub use winding_number::WindingNumber;
