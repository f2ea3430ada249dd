//! Search for edges to edit.

use glam::DVec3;
use rayon::prelude::*;

use crate::session::surface::Surface;

/// Triangles that one task examines. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 2048;

/// A triangle is examined if the square of its longest side exceeds this multiple of the sum of the
/// other two squares: with equal short sides, at an angle of 120°. Nearer to one, good triangles
/// are flipped wherever a tool passes; larger leaves slivers.
const OBTUSE: f64 = 1.5;

/// Thresholds of the edits: squared lengths, model units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub(super) longest2: f64,
    pub(super) shortest2: f64,
    pub(super) flip: bool,
    pub(super) max_triangles: usize,
}

/// Edges by their ends, the smaller first. An edge of two examined triangles occurs twice.
#[derive(Debug, Clone, Default)]
pub(super) struct Survey {
    /// Too long, with squared lengths.
    pub(super) long: Vec<(f64, [u32; 2])>,
    /// Too short, with squared lengths.
    pub(super) short: Vec<(f64, [u32; 2])>,
    /// Opposite to obtuse angles.
    pub(super) obtuse: Vec<[u32; 2]>,
}

/// Tests whether a triangle with these corners may be touched.
pub(super) type MayTouch<'a> = &'a (dyn Fn([DVec3; 3]) -> bool + Sync);

/// Examines `triangles`. With `may_touch`, long edges count only in triangles that pass this test.
pub(super) fn survey(surface: &Surface, triangles: &[u32], limits: &Limits, may_touch: Option<MayTouch<'_>>) -> Survey {
    let parts: Vec<Survey> = triangles
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut survey = Survey::default();
            chunk.iter().for_each(|&triangle| survey.examine(surface, triangle, limits, may_touch));
            survey
        })
        .collect();
    let mut all = Survey::default();
    for part in parts {
        all.long.extend(part.long);
        all.short.extend(part.short);
        all.obtuse.extend(part.obtuse);
    }
    all
}

impl Survey {
    fn examine(&mut self, surface: &Surface, triangle: u32, limits: &Limits, may_touch: Option<MayTouch<'_>>) {
        let Some(corners) = surface.corners_of(triangle) else { return };
        let lengths2: [f64; 3] = std::array::from_fn(|side| corners[side].distance_squared(corners[(side + 1) % 3]));
        let is_beyond = |length2: &f64| *length2 > limits.longest2 || *length2 < limits.shortest2;
        let sum: f64 = lengths2.iter().sum();
        let longest = (0..3).fold(0, |longest, side| if lengths2[side] > lengths2[longest] { side } else { longest });
        // Law of cosines: opposite to an obtuse angle, the squared side exceeds the sum of the
        // other two squares.
        let is_obtuse = limits.flip && lengths2[longest] > OBTUSE * (sum - lengths2[longest]);
        if !(is_obtuse || lengths2.iter().any(is_beyond)) {
            return;
        }
        let vertices = surface.topology.triangles()[triangle as usize].vertices;
        let edge = |side: usize| {
            let (a, b) = (vertices[side], vertices[(side + 1) % 3]);
            [a.min(b), a.max(b)]
        };
        let is_long = lengths2.iter().any(|&length2| length2 > limits.longest2);
        let counts = is_long && may_touch.is_none_or(|may_touch| may_touch(corners));
        for side in 0..3 {
            if counts && lengths2[side] > limits.longest2 {
                self.long.push((lengths2[side], edge(side)));
            }
            if lengths2[side] < limits.shortest2 {
                self.short.push((lengths2[side], edge(side)));
            }
        }
        if is_obtuse {
            self.obtuse.push(edge(longest));
        }
    }
}
