//! Options of sessions and strokes.

use glam::DVec3;

use crate::recipe::{self, Target};

/// Options of a session, which apply to all its strokes.
///
/// ```
/// use isochore_mesh::primitives::icosphere;
/// use isochore_sculpt::{recipe::{Mask, Pin}, session::{Session, SessionOptions}};
///
/// // Hold the north pole.
/// let pin = Pin { center: [0.0, 0.0, 1.0], radius: 0.2, support: 0.1 };
/// let mask = Mask { pins: vec![pin], ..Mask::default() };
/// let options = SessionOptions { mask, undo_bytes: 64 << 20, ..SessionOptions::default() };
/// assert!(Session::open(icosphere(1.0, 3), options).is_ok());
///
/// let options = SessionOptions { step: 2.0, ..SessionOptions::default() };
/// let error = Session::open(icosphere(1.0, 3), options).unwrap_err();
/// assert!(error.to_string().contains("integrate.step"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SessionOptions {
    /// Target that the log names: by default the mesh file `target`. The session must be opened on
    /// this target as placed in the world.
    pub target: Target,
    /// Mask of all strokes, in the coordinates of the mesh as opened. Edges that it holds are not
    /// edited.
    pub mask: recipe::Mask,
    /// Travel of the fastest point of the tool's surface in one time step, as a fraction of the
    /// support or of half the tool's shortest extent, whichever is less; above 0 and at most 1. The
    /// recipe's `integrate.step`.
    pub step: f64,
    /// Memory for undo and redo together, in bytes. The oldest strokes are forgotten first; the
    /// last stroke is always kept.
    pub undo_bytes: usize,
    /// Whether the end of each stroke restores the volume of the mesh as opened by a small
    /// displacement of the vertices that the stroke has moved. The displacement is stored
    /// separately from the flow. It has no effect on an open surface, which has no volume.
    pub lock: bool,
    /// Weights of the triangles in vertex normals.
    pub normals: NormalWeights,
}

impl Default for SessionOptions {
    fn default() -> Self {
        Self {
            target: Target { mesh: Some("target".to_owned()), ..Target::default() },
            mask: recipe::Mask::default(),
            step: recipe::Integrate::default().step,
            undo_bytes: 1 << 30,
            lock: true,
            normals: NormalWeights::default(),
        }
    }
}

/// Weights of the triangles in a vertex normal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum NormalWeights {
    /// Area: fast, and smooth if the triangles have similar sizes.
    #[default]
    Area,
    /// Angle at the vertex: independent of how the surface is cut into triangles.
    Angle,
}

/// Options of one stroke.
///
/// ```
/// use isochore_sculpt::session::{InteractiveRefinement, StrokeOptions};
///
/// // Split edges longer than 0.05 and never collapse.
/// let refine = InteractiveRefinement { longest: Some(0.05), collapse: 0.0, ..InteractiveRefinement::default() };
/// let finer = StrokeOptions { refine: Some(refine) };
/// // Keep all triangles.
/// let unrefined = StrokeOptions { refine: None };
/// assert_ne!(finer, unrefined);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StrokeOptions {
    /// Refinement of the triangles in the tool's reach. `None` keeps all triangles.
    pub refine: Option<InteractiveRefinement>,
}

impl Default for StrokeOptions {
    fn default() -> Self {
        Self { refine: Some(InteractiveRefinement::default()) }
    }
}

/// Rules by which a stroke splits edges in the tool's reach, and collapses and flips some.
///
/// A split places the new vertex exactly where the flow moves it. A collapse or a flip changes the
/// volume slightly; the change is reported separately in
/// [`StrokeVolume::remeshing`](super::StrokeVolume::remeshing). Seams, hard edges, borders between
/// materials and the boundary may be split, but are never collapsed or flipped.
#[derive(Debug, Clone, PartialEq)]
pub struct InteractiveRefinement {
    /// Length above which edges in the tool's reach are split, model units. By default half of the
    /// tool's [feature size](isochore_field::Tool::feature_size).
    pub longest: Option<f64>,
    /// Distance of the image of an edge's midpoint from the straight edge above which the edge is
    /// split, model units. By default a 256th of the tool's feature size. Edges of less than an
    /// eighth of the feature size are not split for this reason.
    pub deviation: Option<f64>,
    /// Edges shorter than this fraction of `longest`, from 0 to 0.4, are collapsed if the stroke has
    /// squeezed them to less than half their length: those of badly shaped triangles during the stroke,
    /// all at its end. Zero collapses none. Vertices of the mesh as opened may be removed too.
    pub collapse: f64,
    /// Whether to flip edges of badly shaped triangles.
    pub flip: bool,
    /// Maximum number of triangles; splits stop before they exceed it.
    pub max_triangles: usize,
    /// Balls in the world, as center and radius, in which no edge is edited.
    pub keep: Vec<(DVec3, f64)>,
}

impl Default for InteractiveRefinement {
    fn default() -> Self {
        Self {
            longest: None,
            deviation: None,
            collapse: 0.0625,
            flip: true,
            max_triangles: 20_000_000,
            keep: Vec::new(),
        }
    }
}
