//! Distance of a tool: exact at its surface, smooth outside.

mod gaussian;
mod ladder;
mod lines;
mod pyramid;

#[cfg(test)]
mod tests;

use glam::DVec3;

use super::interpolant::Interpolant;
use super::mesh_samples::MeshSamples;
use super::{DistanceFieldError, DistanceFieldOptions, Grid, KINK_CELLS, Padding, check_border, reach};
use crate::bvh::checked_bounds;
use crate::{Aabb, Cancelled, Distance, DistanceBlock, Monitor, PointBlock, TriMesh};
use ladder::Ladder;

/// Distance to a mesh for a tool of a given support: like a [`DistanceField`](super::DistanceField)
/// inside and at the surface, without kinks outside.
///
/// The distance to a concave shape has kinks outside, where two parts of the surface are equally
/// far. There the field of a moving tool jumps, and it tears the surface. The spline of a
/// [`DistanceField`](super::DistanceField) rounds a kink over two cells only. This distance rounds it
/// over a length that grows with the distance from the surface and does not depend on the grid.
///
/// ```text
/// aₖ = R/3, R/6, R/12, … ≥ h,   σₖ² = (0.4 aₖ)² + h²/6,   fₖ = Gauss(σₖ) ∗ d
/// D ← d;  for each level, from the smallest to the largest:  D ← D + S((fₖ − aₖ)/aₖ) (fₖ − D)
/// ```
///
/// d is the distance at the nodes, R the support, h the cell, and S(t) = t²(3 − 2t) the step from 0
/// to 1. The weight of a copy depends on the copy itself, which has no kink. Values and gradients are
/// those of one tricubic B-spline through D. The term h²/6 is the variance of linear interpolation:
/// each copy is the Gaussian of the interpolated distance, even if it is narrower than a cell.
///
/// - Inside, and outside up to about one cell, the samples are those of the exact distance. The
///   zero set moves by less than R/1000.
/// - Farther out, D is at least 0.8 d. It is smaller than d over grooves: there the support, where
///   D < R, reaches up to about 1.1 R from the surface.
/// - A support of less than three cells has no level and leaves all kinks. Ten cells are enough for a
///   smooth field.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::{Distance, DistanceFieldOptions, NoProgress, SmoothDistance, primitives};
///
/// let sphere = primitives::icosphere(1.0, 4);
/// let options = DistanceFieldOptions { resolution: 48, ..Default::default() };
/// let distance = SmoothDistance::new(&sphere, 0.5, &options, &NoProgress)?;
/// assert!(distance.reach() >= 0.5);
/// let (value, gradient) = distance.sample(DVec3::new(0.0, 0.0, 1.25));
/// assert!((value - 0.25).abs() < 0.02);
/// assert!((gradient - DVec3::Z).length() < 0.05);
/// # Ok::<(), isochore_mesh::DistanceFieldError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SmoothDistance {
    grid: Grid,
    interpolant: Interpolant,
    surface: Aabb,
    centroid: DVec3,
    reach: f64,
    is_closed: bool,
}

/// Largest number of times that the grid grows by the support because the smooth distance is too
/// small at its border. Larger: a mesh whose inside is nearly unbounded is refused later. Smaller:
/// open meshes whose inside bulges out of a hole are refused.
const MAX_GROWTHS: usize = 3;

impl SmoothDistance {
    /// Samples the distance to `mesh` and smooths it for a tool with this `support`, model units.
    ///
    /// The options are those of a [`DistanceField`](super::DistanceField). The padding and the band
    /// are widened if the support or the smoothing reaches beyond them. The memory limit holds for
    /// the smoothing, too.
    ///
    /// # Errors
    /// [`DistanceFieldError::Support`] if the support is not a positive length, and the errors of
    /// [`DistanceField::new`](super::DistanceField::new).
    pub fn new(
        mesh: &TriMesh,
        support: f64,
        options: &DistanceFieldOptions,
        monitor: &dyn Monitor,
    ) -> Result<Self, DistanceFieldError> {
        if !(support > 0.0 && support.is_finite()) {
            return Err(DistanceFieldError::Support { length: support });
        }
        let mut options = *options;
        let mut growths = 0;
        loop {
            let (sampled, reach) = sampled(mesh, support, &mut options, monitor)?;
            let MeshSamples { grid, samples, surface, centroid, is_closed, .. } = sampled;
            let smooth = Ladder::new(support, grid.cell).smoothed(samples, grid.dims, monitor)?;
            match check_border(&grid, &smooth, reach) {
                Err(_) if growths < MAX_GROWTHS => {
                    growths += 1;
                    options.padding = Padding::Reach(reach + support);
                }
                Err(error) => return Err(error),
                Ok(()) => {
                    let interpolant = Interpolant::new(&grid, &smooth, monitor)?;
                    return Ok(Self { grid, interpolant, surface, centroid, reach, is_closed });
                }
            }
        }
    }

    /// Smooths signed distances that were sampled by other means, as for a tool with this `support`.
    ///
    /// `samples` are the distances at the nodes of a grid of size `dims` (x fastest), and `cell` is
    /// the distance of neighboring nodes; all lengths are in model units. A grid of one layer holds
    /// distances in a plane. The grid must cover the support and a few cells.
    ///
    /// # Errors
    /// [`Cancelled`].
    ///
    /// # Panics
    /// If the number of samples is not the product of `dims`.
    pub fn smooth_samples(
        samples: Vec<f32>,
        dims: [usize; 3],
        cell: f64,
        support: f64,
        monitor: &dyn Monitor,
    ) -> Result<Vec<f32>, Cancelled> {
        assert!(
            samples.len() == dims.iter().product::<usize>(),
            "a grid of size {dims:?} has as many samples as nodes"
        );
        Ladder::new(support, cell).smoothed(samples, dims, monitor)
    }

    /// The grid of sample positions.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Whether each edge of the mesh is used equally often in both directions. If not, the mesh is
    /// open and its inside is defined by the winding number alone.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }
}

/// Samples the distance up to the support at least, and returns it with the reach of the samples.
/// Writes the padding and the band that this takes to `options`.
fn sampled(
    mesh: &TriMesh,
    support: f64,
    options: &mut DistanceFieldOptions,
    monitor: &dyn Monitor,
) -> Result<(MeshSamples, f64), DistanceFieldError> {
    let surface = checked_bounds(&mesh.positions, &mesh.triangles)?;
    let cell = Grid::around(surface, options.resolution, options.padding)?.cell;
    let reach = reach(&DistanceFieldOptions { band: f64::INFINITY, ..*options }, cell).max(support);
    options.padding = Padding::Reach(reach);
    if options.band > 0.0 {
        options.band = options.band.max(reach + Ladder::new(support, cell).width() + KINK_CELLS * cell);
    }
    let sampled = MeshSamples::new(mesh, options, monitor)?;
    check_border(&sampled.grid, &sampled.samples, reach)?;
    Ok((sampled, reach))
}

impl Distance for SmoothDistance {
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        self.interpolant.sample_into(points, out);
    }

    fn sample_single_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        self.interpolant.sample_single_into(points, out);
    }

    fn single_error(&self) -> f64 {
        self.interpolant.single_error()
    }

    fn bounds(&self) -> Aabb {
        self.surface
    }

    /// Box of the points where the spline is below `distance`, from its coefficients, together with
    /// the box of the surface.
    fn bounds_within(&self, distance: f64) -> Aabb {
        self.interpolant.bounds_below(&self.grid, distance).union(self.surface)
    }

    /// Centroid of the volume. Centroid of the area if the mesh is open or encloses no volume.
    fn centroid(&self) -> DVec3 {
        self.centroid
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    fn lipschitz(&self) -> f64 {
        self.interpolant.lipschitz()
    }

    fn detail(&self) -> f64 {
        self.grid.cell
    }
}
