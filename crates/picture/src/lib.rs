//! Shaded pictures of triangle meshes, drawn in software: no window, no graphics card, the same bytes everywhere.
//!
//! Terms used throughout:
//!
//! - A [`Body`] is a mesh with its paint; polylines and arrows are bodies too, made of thin tubes.
//! - A [`Panel`] shows bodies above a caption. Panels of one picture stand side by side and share one [`Camera`], so that
//!   two states of the same body can be compared.
//! - A *sample* is one point of the picture plane at which visibility is decided; a pixel is the mean of several.
//!
//! ```
//! use glam::DVec3;
//! use isochore_mesh::TriMesh;
//! use isochore_picture::{Body, Camera, Options, Panel, render};
//!
//! let mesh = TriMesh {
//!     positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
//!     triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
//!     ..TriMesh::default()
//! };
//! let panel = Panel::new("tetrahedron").with(Body::new(&mesh));
//! let options = Options { width: 320, height: 240, ..Options::default() };
//! let picture = render(&[panel], &Camera::default(), &options)?;
//! assert!(picture.to_png().starts_with(b"\x89PNG"));
//! # Ok::<(), isochore_picture::PictureError>(())
//! ```
//!
//! What is not guaranteed: bodies that reach behind the eye of a camera given by [`Camera::bounds`] lose the triangles
//! there, and transparency is not drawn.

mod camera;
mod caption;
mod fragments;
mod normals;
mod panel;
mod picture;
mod shading;
mod tube;

pub use camera::Camera;
pub use panel::{Body, Paint, Panel};
pub use picture::{Options, Picture, PictureError, render};
