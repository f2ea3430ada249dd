//! The last moment of a stroke without new crossings.

use glam::DVec3;
use isochore_field as field;

use super::crossings::Pair;
use crate::{
    recipe::Key,
    session::{Session, log, path::Path, stroke::ActiveStroke, surface::Surface},
};

/// Halvings of the path in the search for the last moment without new crossings. Larger takes more
/// time; smaller ends strokes earlier than necessary.
const HALVINGS: usize = 5;

/// A moment of a stroke and the path up to it.
struct Moment {
    /// Number of whole moves.
    whole: usize,
    /// Pose within the next move. `None` at its beginning.
    key: Option<Key>,
    path: Path,
}

/// Positions of the vertices that a stroke moves, after a number of whole moves.
struct Positions {
    whole: usize,
    points: Vec<DVec3>,
}

impl Session {
    /// Ends the stroke at its last moment without new crossings. `crossing` are the pairs that cross
    /// at its end. Returns the vertices whose positions may have changed.
    pub(super) fn stop(&mut self, stroke: &mut ActiveStroke, crossing: &[Pair]) -> Vec<u32> {
        let vertices = stroke.phase.vertices.items().to_vec();
        let base = vertices.iter().map(|&vertex| self.surface.base(vertex)).collect();
        // Nothing crosses in the base, because it is certified.
        let mut clean = (0.0, Moment { whole: 0, key: None, path: Path::default() });
        let mut reached = Positions { whole: 0, points: base };
        let (mut end, mut place) = (1.0, self.surface.place_of(crossing[0]));
        for _ in 0..HALVINGS {
            let fraction = 0.5 * (clean.0 + end);
            let Ok(moment) = self.moment(stroke, fraction) else {
                end = fraction;
                continue;
            };
            let (positions, points) = moment.advect(&reached);
            self.surface.place(&vertices, &points);
            let found = self.surface.new_crossings(stroke.phase.triangles.items(), Surface::position);
            if found.is_empty() {
                (clean, reached) = ((fraction, moment), positions);
            } else {
                (end, place) = (fraction, self.surface.place_of(found[0]));
            }
        }
        let (fraction, moment) = clean;
        self.surface.place(&vertices, &moment.advect(&reached).1);
        let sheets = place.and_then(|place| self.surface.closest_sheets(place));
        if fraction == 0.0 {
            // The base is certified, but splits of sheets that touch up to rounding can cross.
            let triangles = stroke.phase.triangles.items();
            stroke.has_crossings |= !self.surface.new_crossings(triangles, Surface::position).is_empty();
        }
        stroke.stop(moment.key, moment.path, fraction, sheets);
        vertices
    }

    /// The moment at a fraction of the path of a stroke.
    fn moment(&self, stroke: &ActiveStroke, fraction: f64) -> Result<Moment, field::StrokeError> {
        let time = fraction * stroke.phase.path.len() as f64;
        let whole = time as usize;
        let mut path = Path { segments: stroke.phase.path.segments[..whole].to_vec() };
        let mut key = None;
        if time > whole as f64 {
            let poses = stroke.poses_of(whole);
            // A move has a twist, because it was made.
            let twist = poses[0].twist_to(&poses[1]);
            let pose = twist.map_or(poses[0], |twist| poses[0].moved(&twist, time - whole as f64));
            // The log records the key, so the tool moves to its pose.
            let recorded = log::key(&pose);
            let pose = recorded.pose().unwrap_or(pose);
            path.segments.push(self.segment(&stroke.tool, [poses[0], pose])?);
            key = Some(recorded);
        }
        Ok(Moment { whole, key, path })
    }
}

impl Moment {
    /// Advects points from an earlier moment to this one. Returns the positions after the last whole
    /// move and those at this moment.
    fn advect(&self, earlier: &Positions) -> (Positions, Vec<DVec3>) {
        let mut points = earlier.points.clone();
        self.path.advect_range(&mut points, earlier.whole..self.whole);
        let positions = Positions { whole: self.whole, points: points.clone() };
        self.path.advect_range(&mut points, self.whole..self.path.len());
        (positions, points)
    }
}

impl Surface {
    /// Moves vertices and updates the tree.
    fn place(&mut self, vertices: &[u32], points: &[DVec3]) {
        vertices.iter().zip(points).for_each(|(&vertex, &point)| self.positions.set(vertex, point));
        let triangles = self.triangles_around(vertices, &[]);
        self.update_tree(&triangles);
    }
}
