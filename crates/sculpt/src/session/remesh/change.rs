//! A single edit, planned and checked before it is made.

use glam::DVec3;
use isochore_mesh::{Aabb, nearest_on_triangle, patch_intersects};

use super::{
    remesher::Remesher,
    shape::{area_normal, smallest_sine2},
};

/// Cosine of the angle by which an edit may turn a triangle, 60°. Larger: curved surface is not
/// coarsened. Smaller: edits make folds.
pub(super) const MOST_TURN: f64 = 0.5;

/// Cosine of the angle between a triangle and the nearest part of the surface before the remesh.
/// Larger: rough surface is not coarsened. Smaller: several edits together may turn a triangle
/// around.
pub(super) const MOST_TILT: f64 = 0.1;

/// Square of the sine of an angle, 20°, below which an edit must not make the smallest angle
/// smaller. Larger: edits that later ones would improve are refused. Smaller: slivers remain.
pub(super) const SLIVER: f64 = 0.116_977_778_440_510_98;

/// Triangles that replace others in the same part of the surface.
#[derive(Debug)]
pub(super) struct Change {
    /// The replaced triangles.
    pub(super) old: Vec<u32>,
    pub(super) new: Vec<Replacement>,
    /// New edges, each with a triangle of the reference near it.
    pub(super) edges: Vec<([DVec3; 2], u32)>,
    /// Samples of the replaced triangles, with the index of their new triangle.
    samples: Vec<(u32, u32)>,
    /// Box around the replaced and the new triangles, once the change is allowed.
    pub(super) bounds: Aabb,
    surroundings: Vec<[DVec3; 3]>,
    patch: Vec<[DVec3; 3]>,
}

/// A new triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Replacement {
    /// Its number after the edit.
    pub(super) triangle: u32,
    pub(super) corners: [DVec3; 3],
    /// Unit normal of the surface in the same place before the edit, or zero if it is unknown.
    pub(super) before: DVec3,
    /// A triangle of the reference near it, on the same side of all lines.
    pub(super) anchor: u32,
}

impl Default for Change {
    fn default() -> Self {
        Self {
            old: Vec::new(),
            new: Vec::new(),
            edges: Vec::new(),
            samples: Vec::new(),
            bounds: Aabb::EMPTY,
            surroundings: Vec::new(),
            patch: Vec::new(),
        }
    }
}

impl Change {
    pub(super) fn clear(&mut self) {
        self.old.clear();
        self.new.clear();
        self.edges.clear();
    }
}

impl Remesher<'_> {
    /// Whether a change keeps orientation and shape, stays within the allowed deviation, and makes
    /// no triangles cross. Updates the anchors of its triangles and assigns samples to them.
    pub(super) fn allows(&self, change: &mut Change) -> bool {
        self.keeps_shape(change)
            && self.keeps_distance(change)
            && self.assign_samples(change, self.allowance2)
            && !self.crosses(change)
    }

    /// Whether no triangle turns too far, and the smallest angle does not become smaller if it is
    /// small.
    fn keeps_shape(&self, change: &Change) -> bool {
        let mut worst = f64::INFINITY;
        for new in &change.new {
            let normal = area_normal(&new.corners);
            if normal == DVec3::ZERO || normal.dot(new.before) < MOST_TURN * normal.length() * new.before.length() {
                return false;
            }
            worst = worst.min(smallest_sine2(&new.corners));
        }
        worst >= SLIVER || {
            let corners = change.old.iter().filter_map(|&triangle| self.surface.corners_of(triangle));
            worst > corners.map(|corners| smallest_sine2(&corners)).fold(SLIVER, f64::min)
        }
    }

    /// Whether the new triangles are near the surface before the remesh.
    fn keeps_distance(&self, change: &mut Change) -> bool {
        for new in &mut change.new {
            let [a, b, c] = new.corners;
            let foot = self.reference.foot(new.anchor, (a + b + c) / 3.0);
            let normal = area_normal(&new.corners);
            let reference = self.reference.normals[foot.triangle as usize];
            let is_tilted = reference != DVec3::ZERO && normal.dot(reference) < MOST_TILT * normal.length();
            if foot.squared > self.allowance2 || is_tilted {
                return false;
            }
            new.anchor = foot.triangle;
        }
        change.edges.iter().all(|&(ends, anchor)| self.reference.is_near(anchor, ends, self.allowance2))
    }

    /// Assigns the samples of the replaced triangles to the new ones. Returns whether the square of
    /// no distance exceeds `most`.
    pub(super) fn assign_samples(&self, change: &mut Change, most: f64) -> bool {
        change.samples.clear();
        for &triangle in &change.old {
            for sample in self.samples.of(triangle) {
                let point = self.samples.points[sample as usize];
                let mut best = (f64::INFINITY, 0);
                for (index, new) in (0..).zip(&change.new) {
                    let squared = nearest_on_triangle(point, &new.corners).1;
                    if squared < best.0 {
                        best = (squared, index);
                    }
                }
                if best.0 > most {
                    return false;
                }
                change.samples.push((sample, best.1));
            }
        }
        true
    }

    /// Whether the new triangles cross each other or any other triangle. Also finds the bounds of the
    /// change.
    pub(super) fn crosses(&self, change: &mut Change) -> bool {
        let Change { old, new, surroundings, patch, bounds, .. } = change;
        patch.clear();
        patch.extend(new.iter().map(|new| new.corners));
        surroundings.clear();
        let around = Aabb::of(patch.iter().flatten().copied());
        *bounds = old
            .iter()
            .filter_map(|&triangle| self.surface.corners_of(triangle))
            .flatten()
            .fold(around, Aabb::including);
        self.surface.tree.visit_box(around, |other| {
            if let Some(corners) = self.surface.corners_of(other).filter(|corners| around.overlaps(Aabb::of(*corners)))
                && !old.contains(&other)
            {
                surroundings.push(corners);
            }
        });
        patch_intersects(patch, surroundings)
    }

    /// Records a change that has been made.
    pub(super) fn note(&mut self, change: &Change) {
        for &triangle in &change.old {
            self.samples.clear(triangle);
        }
        self.edited.extend(&change.old);
        for new in &change.new {
            if new.triangle as usize >= self.anchors.len() {
                self.anchors.resize(new.triangle as usize + 1, 0);
            }
            self.anchors[new.triangle as usize] = new.anchor;
            self.edited.push(new.triangle);
            self.surface.enlarge_tree(new.triangle);
        }
        for &(sample, index) in &change.samples {
            self.samples.assign(sample, change.new[index as usize].triangle);
        }
    }
}
