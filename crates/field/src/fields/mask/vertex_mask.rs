//! Weights painted on vertices, extended to a smooth function of space.
//!
//! Samples of the surface have the weights w. First the painted region grows: each sample takes the
//! largest weight nearby. The held fraction at a point x is then the average of the weights with a
//! compact kernel of radius h. It fades with the coverage c where the samples end:
//!
//! ```text
//! m(x) = 1 − c(S) (1 − F/S),   S = Σ qᵢ K(|x − xᵢ|),   F = Σ qᵢ (1 − wᵢ) K(|x − xᵢ|),   K(r) = (1 − r²/h²)³
//! ```
//!
//! The factors qᵢ make S about one on a surface, independent of the sampling density. Near a held
//! vertex all samples within h have weight one after the growth. F and its gradient are then sums
//! of zeros, so m is exactly zero with zero gradient.
//!
//! Source: normalized averages after D. Shepard, *A two-dimensional interpolation function for
//! irregularly-spaced data*, 1968, with a twice continuously differentiable kernel.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, TriMesh};
use rstar::{RTree, primitives::GeomWithData};
use rustc_hash::FxHashSet;

use super::{Factor, MaskError};
use crate::fields::Profile;

/// Default fade, relative to the longest side of the mesh's bounding box. Larger: the mask extends
/// beyond the painted region. Smaller: the shear of passing material needs most of the triangles
/// that refinement adds.
const DEFAULT_FADE: f64 = 0.1;

/// Smallest default fade, in mean edge lengths of the mesh. Larger: the mask extends beyond the
/// painted region. Smaller: the mask is steeper than the triangles can follow.
const LEAST_DEFAULT_FADE: f64 = 4.0;

/// Radius of the kernel, relative to the fade. The held region ends half a radius beyond a held
/// vertex, and the free region begins two radii farther. Larger: the mask fades over more than the
/// given length. Smaller: it is steeper than asked for.
const KERNEL: f64 = 0.5;

/// Distance of neighboring samples, relative to the radius of the kernel. Larger: the mask of large
/// triangles has holes. Smaller: more samples.
const SPACING: f64 = 0.75;

/// Side of the cells of space, relative to the radius of the kernel; one sample per cell is kept.
/// Larger: the average is uneven. Smaller: evaluation is slow.
const CELL: f64 = 0.2;

/// Distance by which painted weights grow, relative to the radius of the kernel: one radius plus
/// the distance from a held point to a held sample. Every sample within the radius of a held point
/// is then held.
const GROWTH: f64 = 1.0 + SPACING;

/// Coverage that counts as full, relative to the least coverage of a painted sample. Larger:
/// midpoints of held triangles may not be fully held. Smaller: the mask ends more abruptly off the
/// surface.
const FULL_COVERAGE: f64 = 0.5;

/// Largest number of samples; each takes about a hundred bytes.
const MAX_SAMPLES: usize = 8_000_000;

/// Largest number of samples at which the speed of a masked field is sampled.
const PROBES: usize = 128;

/// Weights of the vertices of a mesh, from 0 (free) to 1 (held), as a smooth function of the space
/// around the mesh.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_field::{Mask, VertexMask};
/// use isochore_mesh::primitives;
///
/// let sphere = primitives::icosphere(1.0, 3);
/// let weights: Vec<f64> =
///     sphere.positions.iter().map(|position| f64::from(position.z > 0.6)).collect();
/// let cap = VertexMask::new(&sphere, &weights, None)?;
///
/// let mask = Mask::new(Vec::new(), Some(cap), Vec::new())?;
/// assert!(mask.is_held(DVec3::Z));
/// assert!(!mask.is_held(-DVec3::Z));
/// # Ok::<(), isochore_field::MaskError>(())
/// ```
#[derive(Debug, Clone)]
pub struct VertexMask {
    samples: Arc<[Sample]>,
    tree: Arc<RTree<GeomWithData<[f64; 3], u32>>>,
    /// Radius h of the kernel.
    radius: f64,
    /// Value of S from which the coverage is full.
    full: f64,
    /// Box outside which everything is free.
    bounds: Aabb,
}

/// A point of the surface.
#[derive(Debug, Clone, Copy)]
struct Sample {
    position: DVec3,
    weight: f64,
    /// Factor q, the reciprocal of the local density of the samples.
    normalization: f64,
}

impl VertexMask {
    /// The mask of `mesh` with one of the `weights` for each vertex.
    ///
    /// The distance from a held vertex to free material is slightly more than the length `fade`,
    /// model units. Its default is a tenth of the longest side of the mesh's bounding box, or four
    /// mean edge lengths if that is more.
    ///
    /// # Errors
    /// - [`MaskError::Mesh`] if the mesh has an index out of range or a coordinate that is not
    ///   finite.
    /// - [`MaskError::WeightCount`] if there is not one weight for each vertex.
    /// - [`MaskError::Weight`] if a weight is not from 0 to 1.
    /// - [`MaskError::NoEdges`] if `fade` is `None` and the mesh has no edges.
    /// - [`MaskError::Fade`] if the fade is not a positive length.
    /// - [`MaskError::TooManySamples`] if the fade is too short for the size of the mesh.
    pub fn new(mesh: &TriMesh, weights: &[f64], fade: Option<f64>) -> Result<Self, MaskError> {
        mesh.check_valid().map_err(|_| MaskError::Mesh)?;
        if weights.len() != mesh.positions.len() {
            return Err(MaskError::WeightCount { found: weights.len(), expected: mesh.positions.len() });
        }
        if let Some(vertex) = weights.iter().position(|weight| !(0.0..=1.0).contains(weight)) {
            return Err(MaskError::Weight { vertex, weight: weights[vertex] });
        }
        let fade = match fade {
            Some(fade) => fade,
            None => {
                let edge = mesh.edge_lengths().ok_or(MaskError::NoEdges)?.mean;
                (DEFAULT_FADE * mesh.bounds().size().max_element()).max(LEAST_DEFAULT_FADE * edge)
            }
        };
        if !(fade > 0.0 && fade.is_finite()) {
            return Err(MaskError::Fade(fade));
        }
        let radius = KERNEL * fade;
        let all = sample(mesh, weights, radius).ok_or(MaskError::TooManySamples { fade, most: MAX_SAMPLES })?;
        let samples = thinned(&all, radius);
        let points = (0..).zip(&samples).map(|(index, sample)| GeomWithData::new(sample.position.to_array(), index));
        let tree = Arc::new(RTree::bulk_load(points.collect()));
        let mut mask = Self { samples: samples.into(), tree, radius, full: FULL_COVERAGE, bounds: Aabb::EMPTY };
        let painted: Vec<Sample> = all.into_iter().filter(|sample| sample.weight > 0.0).collect();
        mask.samples = mask.grown(&painted).into();
        let held = mask.samples.iter().filter(|sample| sample.weight > 0.0);
        mask.bounds = Aabb::of(held.map(|sample| sample.position)).expanded(radius);
        mask.full *= painted.iter().map(|sample| mask.sums(sample.position).coverage).fold(1.0, f64::min);
        Ok(mask)
    }

    /// Length over which the mask varies.
    pub(super) fn feature_size(&self) -> f64 {
        self.radius
    }

    /// Factor of the mask at a point.
    pub(super) fn factor(&self, point: DVec3) -> Factor {
        if self.bounds.distance(point) > 0.0 {
            return Factor::ONE;
        }
        let sums = self.sums(point);
        if sums.coverage == 0.0 {
            return Factor::ONE;
        }
        let free = sums.free / sums.coverage;
        let held_gradient = (free * sums.coverage_gradient - sums.free_gradient) / sums.coverage;
        let (uncovered, slope) = Profile::Quintic.evaluate(sums.coverage / self.full);
        let (covered, held) = (1.0 - uncovered, 1.0 - free);
        let covered_gradient = -slope / self.full * sums.coverage_gradient;
        Factor { value: 1.0 - covered * held, gradient: -(covered_gradient * held + covered * held_gradient) }
    }

    /// Whether the factor may differ from one in a ball; false is certain.
    pub(super) fn may_touch(&self, center: DVec3, radius: f64) -> bool {
        let reach = radius + self.radius;
        self.bounds.distance(center) <= radius
            && self
                .tree
                .locate_within_distance(center.to_array(), reach * reach)
                .any(|found| self.samples[found.data as usize].weight > 0.0)
    }

    /// Samples where the mask varies.
    pub(super) fn probes(&self) -> Vec<DVec3> {
        let is_changing = |sample: &&Sample| {
            let factor = self.factor(sample.position);
            factor.gradient != DVec3::ZERO
        };
        let changing: Vec<DVec3> = self.samples.iter().filter(is_changing).map(|sample| sample.position).collect();
        let stride = changing.len().div_ceil(PROBES).max(1);
        changing.into_iter().step_by(stride).collect()
    }

    /// The samples with the largest painted weight within the growth distance, and normalized by
    /// their local density.
    fn grown(&self, painted: &[Sample]) -> Vec<Sample> {
        let mut grown = self.samples.to_vec();
        let reach = GROWTH * self.radius;
        for sample in painted {
            for found in self.tree.locate_within_distance(sample.position.to_array(), reach * reach) {
                let weight = &mut grown[found.data as usize].weight;
                *weight = weight.max(sample.weight);
            }
        }
        for sample in &mut grown {
            // All normalizations are still one, so the coverage is the density. The sample itself
            // contributes one.
            sample.normalization = 1.0 / self.sums(sample.position).coverage.max(1.0);
        }
        grown
    }

    /// Sums over all samples within the radius of a point.
    fn sums(&self, point: DVec3) -> Sums {
        let square = self.radius * self.radius;
        let mut near: Vec<u32> =
            self.tree.locate_within_distance(point.to_array(), square).map(|found| found.data).collect();
        // The order of a sum decides its last bits, and the order of the results is unspecified.
        near.sort_unstable();
        let mut sums = Sums::default();
        for index in near {
            let Sample { position, weight, normalization, .. } = self.samples[index as usize];
            let arm = point - position;
            let rest = (1.0 - arm.length_squared() / square).max(0.0);
            let kernel = normalization * rest * rest * rest;
            let gradient = -6.0 * normalization * rest * rest / square * arm;
            sums.coverage += kernel;
            sums.coverage_gradient += gradient;
            sums.free += (1.0 - weight) * kernel;
            sums.free_gradient += (1.0 - weight) * gradient;
        }
        sums
    }
}

/// S and F at a point, with their gradients.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    coverage: f64,
    coverage_gradient: DVec3,
    free: f64,
    free_gradient: DVec3,
}

/// The vertices, and additional points on the triangles near held vertices. Returns `None` if there
/// would be more than [`MAX_SAMPLES`].
fn sample(mesh: &TriMesh, weights: &[f64], radius: f64) -> Option<Vec<Sample>> {
    let sample = |position, weight| Sample { position, weight, normalization: 1.0 };
    let mut samples: Vec<Sample> =
        mesh.positions.iter().zip(weights).map(|(&position, &weight)| sample(position, weight)).collect();
    let held = Aabb::of(mesh.triangles.iter().flat_map(|corners| {
        let is_held = corners.iter().any(|&vertex| weights[vertex as usize] > 0.0);
        corners.iter().filter(move |_| is_held).map(|&vertex| mesh.positions[vertex as usize])
    }));
    let reach = held.expanded((1.0 + GROWTH) * radius);
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|vertex| mesh.positions[vertex as usize]);
        let bounds = Aabb::of([a, b, c]);
        if bounds.min.cmpgt(reach.max).any() || bounds.max.cmplt(reach.min).any() {
            continue;
        }
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let cells = (longest / (SPACING * radius)).ceil();
        if cells * cells > 2.0 * (MAX_SAMPLES - samples.len()) as f64 {
            return None;
        }
        let cells = cells as usize;
        let [wa, wb, wc] = corners.map(|vertex| weights[vertex as usize]);
        for i in 0..=cells {
            for j in 0..=cells - i {
                let k = cells - i - j;
                if [i, j, k].contains(&cells) {
                    continue;
                }
                let [u, v, w] = [i, j, k].map(|part| part as f64 / cells as f64);
                // Rounding of the average must not release a triangle that is held as a whole.
                let weight = if wa == wb && wb == wc { wa } else { (u * wa + v * wb + w * wc).min(1.0) };
                samples.push(sample(u * a + v * b + w * c, weight));
            }
        }
    }
    Some(samples)
}

/// The first sample in each cell of space.
fn thinned(samples: &[Sample], radius: f64) -> Vec<Sample> {
    let mut taken = FxHashSet::default();
    let cell = |position: DVec3| (position / (CELL * radius)).floor().to_array().map(|index| index as i64);
    samples.iter().filter(|sample| taken.insert(cell(sample.position))).copied().collect()
}
