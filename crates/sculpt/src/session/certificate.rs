//! The certificate of a stroke: no two triangles cross that did not cross in the mesh as opened.
//!
//! The flow map makes no surface cross itself, so new crossings are flat triangles that cut through
//! a sheet nearby. Finer triangles remove them. If too many would be needed, the stroke ends at its
//! last moment without new crossings.
//!
//! A certified surface can become the base from which the rest of the stroke flows.

mod crossings;
mod sheets;
mod stopping;
mod untangling;

use web_time::Instant;

use super::{MoveReceipt, Session, stroke::ActiveStroke};

pub(super) use crossings::{Pair, triangles_of};

/// A new base is made once splits have added this fraction of the triangles that have moved since
/// the last one. Larger lets the image of the base become complicated, so that crossings take more
/// splits; smaller spends time on searching for crossings, and more often places new vertices on
/// flat triangles instead of the curved surface.
const DUE: f64 = 0.25;

/// Splits since the last base that never make a new one due. Larger and smaller as [`DUE`].
const LEAST_DUE: usize = 64;

impl Session {
    /// Makes the surface the new base of the stroke, if many splits have been made since the last
    /// one.
    pub(super) fn rebase_if_due(&mut self, receipt: &mut MoveReceipt) {
        let is_due = |stroke: &mut ActiveStroke| {
            let added = 2 * stroke.phase.inserted;
            added > LEAST_DUE && added as f64 > DUE * stroke.phase.triangles.items().len() as f64
        };
        let Some(mut stroke) = self.stroke.take_if(is_due) else { return };
        let inserted = stroke.receipt.inserted_vertices;
        receipt.seconds.certificate = self.certify(&mut stroke);
        stroke.receipt.seconds.certificate += receipt.seconds.certificate;
        let moved = stroke.moved_volume(&self.surface);
        if stroke.stopped.is_none() {
            let bad = self.surface.badly_shaped(stroke.phase.triangles.items());
            self.tidy(&mut stroke, &bad);
        }
        receipt.inserted_vertices += stroke.receipt.inserted_vertices - inserted;
        receipt.is_stopped = stroke.stopped.is_some();
        stroke.rebase(&mut self.surface, moved);
        self.stroke = Some(stroke);
    }

    /// Removes the crossings that the stroke has made since the base, or shortens the stroke.
    /// Returns the wall time in seconds.
    ///
    /// Crossings are only counted if the host keeps all triangles, and where a stroke that kept them
    /// has left some.
    pub(super) fn certify(&mut self, stroke: &mut ActiveStroke) -> f64 {
        let start = Instant::now();
        if stroke.phase.path.len() > 0 {
            let untangled = self.untangle(stroke);
            let mut changed = untangled.changed;
            if !untangled.crossing.is_empty() {
                if stroke.refine.is_some() && !self.has_crossings() {
                    changed.extend(self.stop(stroke, &untangled.crossing));
                } else {
                    stroke.has_crossings = true;
                }
            }
            self.show(&changed, &[]);
        }
        let seconds = start.elapsed().as_secs_f64();
        stroke.receipt.certificate_seconds += seconds;
        seconds
    }

    /// Collapses and flips edges of the certified surface that the stroke has moved.
    pub(super) fn tidy(&mut self, stroke: &mut ActiveStroke, triangles: &[u32]) {
        let Some(options) = stroke.refine.clone() else { return };
        let tidied = stroke.pass(&mut self.surface, self.mask.as_deref(), &options).tidy(triangles);
        stroke.touched.extend(&tidied.triangles, self.surface.corners.items().len());
        for volume in &tidied.volumes {
            stroke.remeshing.add(*volume);
            stroke.remeshed += volume.abs();
        }
        stroke.receipt.removed_vertices += tidied.removed_vertices;
        stroke.receipt.flipped_edges += tidied.flipped_edges;
        self.show(&[], &tidied.triangles);
    }

    /// Updates the buffers around vertices and triangles that have changed.
    fn show(&mut self, vertices: &[u32], triangles: &[u32]) {
        if vertices.is_empty() && triangles.is_empty() {
            return;
        }
        let around = self.surface.triangles_around(vertices, triangles);
        let shaded = self.surface.vertices_of(&around);
        let loose = vertices.iter().copied().filter(|vertex| self.loose.binary_search(vertex).is_ok());
        self.surface.write_buffers(&shaded, loose);
    }

    /// Whether an earlier stroke has left new crossings.
    fn has_crossings(&self) -> bool {
        self.logged().any(|stroke| stroke.crossings > 0)
    }
}
