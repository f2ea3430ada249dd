//! Shaded pictures of triangle meshes, rendered in software.
//!
//! Rendering needs neither a window nor a graphics card. The same input gives the same bytes on
//! every machine and for any number of threads.
//!
//! # Terms
//!
//! - A [`Body`] is a mesh with a [`Paint`]. Polylines and arrows are bodies too: their meshes are
//!   thin tubes.
//! - A [`Panel`] shows bodies above a caption. The panels of a picture are placed side by side and
//!   use the same [`Camera`], so that two states of one body can be compared.
//! - A *sample* is a point of the picture plane at which visibility is determined. A pixel is the
//!   mean of several samples.
//!
//! Positions and lengths are in model units. Colors are linear RGB from 0 to 1; the pixels of a
//! [`Picture`] are sRGB.
//!
//! # Render a mesh
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
//! # Limits
//!
//! If [`Camera::bounds`] places the eye inside a body, the triangles behind the eye are not drawn.
//! Transparency and shadows are not rendered.

mod camera;
mod caption;
mod error;
mod fragments;
mod normals;
mod panel;
mod picture;
mod shading;
mod tube;

pub use camera::Camera;
pub use error::PictureError;
pub use panel::{Body, Paint, Panel};
pub use picture::{Options, Picture, render};
