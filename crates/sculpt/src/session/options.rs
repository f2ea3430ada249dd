//! What a host chooses.

use glam::DVec3;

use crate::recipe::{self, Target};

/// How a session works, for all its strokes.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionOptions {
    /// What the log says the mesh is: by default the mesh file `target`. The mesh that the session is opened on is this target as
    /// it stands in the world.
    pub target: Target,
    /// What holds all strokes back, in the coordinates of the mesh as opened. Edges that it holds are not edited either.
    pub mask: recipe::Mask,
    /// Travel of the fastest point of the tool's surface in one time step, as a share of the support or of half the tool's shortest
    /// extent, whichever is less; at most 1. The recipe's `integrate.step`.
    pub step: f64,
    /// Bytes that undo and redo may hold, whatever is undone. The oldest strokes are forgotten first; the last one is always kept.
    pub undo_bytes: usize,
    /// Whether a small displacement of what a stroke has moved gives back the volume of the mesh as opened when the stroke ends. It is
    /// kept apart from the flow, and an open surface has no volume to give back.
    pub lock: bool,
    /// How triangles are weighted in the normals of the vertices that they meet in.
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

/// How triangles are weighted in a vertex normal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum NormalWeights {
    /// By their areas: quick, and smooth where triangles are of one size.
    #[default]
    Area,
    /// By their angles at the vertex, which does not depend on how the surface is cut into triangles.
    Angle,
}

/// How one stroke works.
#[derive(Debug, Clone, PartialEq)]
pub struct StrokeOptions {
    /// What becomes of triangles in the tool's reach; none to keep them all.
    pub refine: Option<InteractiveRefinement>,
}

impl Default for StrokeOptions {
    fn default() -> Self {
        Self { refine: Some(InteractiveRefinement::default()) }
    }
}

/// When edges in the tool's reach are split, collapsed and flipped during a stroke.
///
/// A split never moves the surface from where the flow takes it. A collapse or a flip changes the volume a little; how much is
/// booked apart, in [`StrokeVolume::remeshing`](super::StrokeVolume::remeshing). No edit crosses a seam, a hard edge, a border
/// between materials or the end of the surface; such edges are split at most.
#[derive(Debug, Clone, PartialEq)]
pub struct InteractiveRefinement {
    /// Edges longer than this are split, model units; by default an eighth of the length over which the tool's field changes.
    pub longest: Option<f64>,
    /// Edges shorter than this share of `longest` are collapsed, once the stroke has squeezed them to less than half; zero to
    /// collapse none. Collapsed vertices are gone, also where they are those of the mesh as opened.
    pub collapse: f64,
    /// Whether badly shaped pairs of triangles that the stroke has moved exchange their common edge.
    pub flip: bool,
    /// No split goes beyond this number of triangles.
    pub max_triangles: usize,
    /// Balls in the world, by center and radius, in which the triangles stay as they are.
    pub keep: Vec<(DVec3, f64)>,
}

impl Default for InteractiveRefinement {
    fn default() -> Self {
        Self { longest: None, collapse: 0.0625, flip: true, max_triangles: 20_000_000, keep: Vec::new() }
    }
}
