//! The estimate of the facet error, kept up to date for the triangles that change.

use isochore_mesh::{Cancelled, Monitor};
use rayon::prelude::*;

use super::{Tessellation, sum};
use crate::{deform::curved_triangle::GAIN_FRACTION, flow::Stroke};

/// An estimate of the facet error.
#[derive(Debug, Clone, Default)]
pub(crate) struct FacetError {
    /// Estimated signed volume that the flat triangles lack relative to the curved image.
    pub(crate) volume: f64,
    /// Triangles whose part of the estimate is new, in ascending order.
    pub(crate) changed: Vec<u32>,
    /// Evaluations of the fields.
    pub(crate) evaluations: u64,
}

impl Tessellation {
    /// Estimates the facet error of the image. `strokes` lead from the base to the image. Follows the
    /// midpoints of the edges that have moved.
    pub(crate) fn estimate_facet_error(
        &mut self,
        strokes: &[Stroke],
        monitor: &dyn Monitor,
    ) -> Result<FacetError, Cancelled> {
        let changed = self.take_changed();
        for &index in &changed {
            if self.has_moved(index as usize) {
                self.follow_edges_of(index);
            }
        }
        let evaluations = self.advect_followed(strokes, monitor)?;
        // A newly followed edge also changes the neighbor across it.
        self.put_back(&changed);
        let changed = self.take_changed();
        self.update_gains(&changed);
        Ok(FacetError { volume: self.facet_error(), changed, evaluations })
    }

    /// Takes the list of triangles that are new, or whose corners or midpoints have moved, since the
    /// last call; in ascending order.
    fn take_changed(&mut self) -> Vec<u32> {
        let mut changed = std::mem::take(&mut self.changed);
        changed.par_sort_unstable();
        changed.dedup();
        changed
    }

    /// Marks triangles as changed, so that the next estimate includes them.
    pub(crate) fn put_back(&mut self, changed: &[u32]) {
        self.changed.extend_from_slice(changed);
    }

    /// Recomputes the gains of some triangles.
    fn update_gains(&mut self, triangles: &[u32]) {
        let gain = |&index: &u32| self.curved(index as usize).map_or(0.0, |curved| curved.volume_gain());
        let gains: Vec<f64> = triangles.par_iter().map(gain).collect();
        for (&index, gain) in triangles.iter().zip(gains) {
            self.gains[index as usize] = gain;
            self.gain_sums.invalidate(index as usize);
        }
    }

    /// The volume gained by one split of each triangle at the images of its midpoints.
    pub(crate) fn gains(&self) -> &[f64] {
        &self.gains
    }

    /// Estimated signed volume between the flat triangles and the curved image.
    fn facet_error(&mut self) -> f64 {
        let gains = &self.gains;
        let sums = self.gain_sums.fill(gains.len(), |triangles| sum(gains[triangles].iter().copied()));
        sum(sums.iter()) / GAIN_FRACTION
    }
}
