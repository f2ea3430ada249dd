//! Double reflection for a batch of sixteen curves, in single precision.
//!
//! The steps along one curve depend on each other, so a processor waits most of the time. Sixteen
//! curves fill its vector registers. Chords are computed in double precision before rounding,
//! because on dense samples their cancellation would lose most digits of single precision.

use glam::DVec3;
use multiversion::multiversion;

use crate::double_reflection::SMALLEST_SECOND_REFLECTION;
use crate::frame::{FrameError, orthogonal_reference};
use crate::{Frame, Spine};

/// Number of curves in a full batch.
pub const BATCH_SIZE: usize = 16;

/// One number per curve.
type Lanes = [f32; BATCH_SIZE];

/// One vector per curve.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
struct VectorLanes {
    x: Lanes,
    y: Lanes,
    z: Lanes,
}

impl VectorLanes {
    const ZERO: Self = Self { x: [0.0; BATCH_SIZE], y: [0.0; BATCH_SIZE], z: [0.0; BATCH_SIZE] };

    fn gather(vector: impl Fn(usize) -> DVec3) -> Self {
        let vectors: [DVec3; BATCH_SIZE] = std::array::from_fn(vector);
        Self { x: vectors.map(|v| v.x as f32), y: vectors.map(|v| v.y as f32), z: vectors.map(|v| v.z as f32) }
    }

    fn get(&self, lane: usize) -> DVec3 {
        DVec3::new(f64::from(self.x[lane]), f64::from(self.y[lane]), f64::from(self.z[lane]))
    }
}

/// Up to sixteen spines with equal numbers of segments, stored as a structure of arrays.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{Spine, SpineBatch, TrigonometricCurve};
///
/// let helix = |radius| Spine::sample(&TrigonometricCurve::helix(radius, 0.4, (0.0, 6.0)), 100);
/// let batch = SpineBatch::new(&[helix(1.0)?, helix(2.0)?])?;
/// let mut references = batch.references();
/// batch.propagate(&[DVec3::Z; 2], &mut references)?;
/// assert_eq!(batch.frames(1, &references)?.len(), 101);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SpineBatch {
    count: usize,
    /// Unit vectors along the chords, by segment.
    chords: Vec<VectorLanes>,
    /// Tangents by station.
    tangents: Vec<VectorLanes>,
    /// The spines in double precision, for the frames.
    spines: Vec<Spine>,
}

/// Reference vectors of a [`SpineBatch`].
#[derive(Debug, Clone)]
pub struct ReferenceBatch {
    vectors: Vec<VectorLanes>,
    /// Smallest squared length of the second reflection vector of each curve.
    smallest: Lanes,
}

/// Errors when constructing a [`SpineBatch`]. Indices count from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BatchError {
    /// The batch is empty or has more than sixteen spines.
    #[error("a batch has 1 to 16 spines, got {count}")]
    Count {
        /// Number of spines.
        count: usize,
    },
    /// The number of segments differs from that of the first spine.
    #[error("spine {index} has {segments} segments, but the first has {expected}; all must be equal")]
    Segments {
        /// The spine.
        index: usize,
        /// Number of its segments.
        segments: usize,
        /// Number of segments of the first spine.
        expected: usize,
    },
    /// Two neighboring points are equal, so that they have no chord.
    #[error("segment {segment} of spine {index} has length zero; remove one of its points")]
    RepeatedPoint {
        /// The spine.
        index: usize,
        /// The segment.
        segment: usize,
    },
}

impl SpineBatch {
    /// Creates a batch of `spines`.
    ///
    /// # Errors
    /// - [`BatchError::Count`] unless there are 1 to 16 spines.
    /// - [`BatchError::Segments`] if the numbers of segments differ.
    /// - [`BatchError::RepeatedPoint`] if two neighboring points are equal.
    pub fn new(spines: &[Spine]) -> Result<Self, BatchError> {
        if spines.is_empty() || spines.len() > BATCH_SIZE {
            return Err(BatchError::Count { count: spines.len() });
        }
        let expected = spines[0].segments();
        for (index, spine) in spines.iter().enumerate() {
            if spine.segments() != expected {
                return Err(BatchError::Segments { index, segments: spine.segments(), expected });
            }
            if let Some(segment) = (0..expected).find(|&i| spine.point(i + 1) == spine.point(i)) {
                return Err(BatchError::RepeatedPoint { index, segment });
            }
        }
        // Unused lanes repeat the last curve.
        let spine = |lane: usize| &spines[lane.min(spines.len() - 1)];
        let chord = |i: usize, lane: usize| (spine(lane).point(i + 1) - spine(lane).point(i)).normalize_or_zero();
        Ok(Self {
            count: spines.len(),
            chords: (0..expected).map(|i| VectorLanes::gather(|lane| chord(i, lane))).collect(),
            tangents: (0..=expected).map(|i| VectorLanes::gather(|lane| spine(lane).tangent(i))).collect(),
            spines: spines.to_vec(),
        })
    }

    /// Allocates the output of [`propagate`](Self::propagate).
    pub fn references(&self) -> ReferenceBatch {
        ReferenceBatch { vectors: vec![VectorLanes::ZERO; self.tangents.len()], smallest: [4.0; BATCH_SIZE] }
    }

    /// Computes the rotation-minimizing reference vectors of all curves into `references`. The
    /// first vector of each curve is the component of its start vector normal to the first tangent.
    ///
    /// # Errors
    /// [`FrameError::Reference`] if a start vector is zero, not finite, or parallel to the first
    /// tangent.
    ///
    /// # Panics
    /// If there is not one start vector per curve, or if `references` has another number of
    /// stations.
    pub fn propagate(&self, starts: &[DVec3], references: &mut ReferenceBatch) -> Result<(), FrameError> {
        assert_eq!(starts.len(), self.count, "one start vector per curve");
        assert_eq!(references.vectors.len(), self.tangents.len(), "the references must belong to this batch");
        let starts = starts
            .iter()
            .zip(&self.spines)
            .map(|(&start, spine)| orthogonal_reference(start, spine.tangent(0)))
            .collect::<Result<Vec<_>, _>>()?;
        references.vectors[0] = VectorLanes::gather(|lane| starts[lane.min(self.count - 1)]);
        references.smallest = propagate_lanes(&self.chords, &self.tangents, &mut references.vectors);
        Ok(())
    }

    /// Returns the frames of one curve, orthonormalized in double precision.
    ///
    /// # Errors
    /// [`FrameError::DegenerateSegment`] if a segment of the curve does not determine a rotation.
    /// The frames of the other curves are still valid.
    ///
    /// # Panics
    /// If `curve` is out of range.
    pub fn frames(&self, curve: usize, references: &ReferenceBatch) -> Result<Vec<Frame>, FrameError> {
        assert!(curve < self.count, "curve {curve} is out of range: the batch has {}", self.count);
        let spine = &self.spines[curve];
        if references.smallest[curve] < SMALLEST_SECOND_REFLECTION as f32 {
            let segment =
                (0..spine.segments()).find(|&i| self.second_reflection(curve, i) < SMALLEST_SECOND_REFLECTION);
            return Err(FrameError::DegenerateSegment { segment: segment.unwrap_or(0) });
        }
        references
            .vectors
            .iter()
            .enumerate()
            .map(|(station, vectors)| {
                let tangent = spine.tangent(station);
                Ok(Frame::new(orthogonal_reference(vectors.get(curve), tangent)?, tangent))
            })
            .collect()
    }

    fn second_reflection(&self, curve: usize, segment: usize) -> f64 {
        let (chord, start) = (self.chords[segment].get(curve), self.tangents[segment].get(curve));
        (self.tangents[segment + 1].get(curve) - (start - 2.0 * chord.dot(start) * chord)).length_squared()
    }
}

/// Double reflection for all lanes, segment by segment. Returns the smallest squared length of the
/// second reflection vector of each lane.
///
/// It is compiled for several instruction sets. No version fuses multiplications and
/// additions, so all give the same bits.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn propagate_lanes(chords: &[VectorLanes], tangents: &[VectorLanes], references: &mut [VectorLanes]) -> Lanes {
    let mut smallest = [4.0; BATCH_SIZE];
    let mut r = references[0];
    let mut start = &tangents[0];
    let steps = chords.iter().zip(&tangents[1..]).zip(&mut references[1..]);
    for ((chord, end), out) in steps {
        for lane in 0..BATCH_SIZE {
            let (cx, cy, cz) = (chord.x[lane], chord.y[lane], chord.z[lane]);
            let (sx, sy, sz) = (start.x[lane], start.y[lane], start.z[lane]);
            // Reflect the tangent along the unit chord; v is the vector of the second reflection.
            let along = 2.0 * (cx * sx + cy * sy + cz * sz);
            let (vx, vy, vz) =
                (end.x[lane] - (sx - along * cx), end.y[lane] - (sy - along * cy), end.z[lane] - (sz - along * cz));
            let second = vx * vx + vy * vy + vz * vz;
            smallest[lane] = if second < smallest[lane] { second } else { smallest[lane] };
            // Apply both reflections to the reference vector.
            let (rx, ry, rz) = (r.x[lane], r.y[lane], r.z[lane]);
            let first = 2.0 * (cx * rx + cy * ry + cz * rz);
            let (rx, ry, rz) = (rx - first * cx, ry - first * cy, rz - first * cz);
            let turn = (vx * rx + vy * ry + vz * rz) * (2.0 / second);
            r.x[lane] = rx - turn * vx;
            r.y[lane] = ry - turn * vy;
            r.z[lane] = rz - turn * vz;
        }
        *out = r;
        start = end;
    }
    smallest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DegenerateSegment, FrameMethod, TrigonometricCurve, rotation_minimizing_frames};

    fn spines(count: usize, segments: usize) -> Vec<Spine> {
        (0..count)
            .map(|i| {
                let helix = TrigonometricCurve::helix(1.0 + 0.1 * i as f64, 0.4, (0.0, 20.0));
                Spine::sample(&helix, segments).unwrap()
            })
            .collect()
    }

    #[test]
    fn frames_match_double_precision() {
        for count in [1, 5, 16] {
            let spines = spines(count, 1000);
            let starts = vec![DVec3::Z; count];
            let batch = SpineBatch::new(&spines).unwrap();
            let mut references = batch.references();
            batch.propagate(&starts, &mut references).unwrap();
            for (curve, spine) in spines.iter().enumerate() {
                let exact = rotation_minimizing_frames(
                    spine,
                    DVec3::Z,
                    FrameMethod::DoubleReflection,
                    DegenerateSegment::Refuse,
                )
                .unwrap();
                let frames = batch.frames(curve, &references).unwrap();
                let worst = frames.iter().zip(&exact.stations).map(|(a, b)| a.r.distance(b.r)).fold(0.0, f64::max);
                // A thousand steps with random rounding in single precision: √1000 · 6e-8 = 2e-6,
                // and a margin of four.
                assert!(worst < 8e-6, "curve {curve}: {worst:e}");
                // Orthonormal in double precision.
                assert!(frames.iter().all(|f| f.r.dot(f.t).abs() < 1e-15 && (f.r.length() - 1.0).abs() < 1e-15));
            }
        }
    }

    #[test]
    fn a_degenerate_curve_does_not_affect_the_others() {
        let mut spines = spines(3, 20);
        let mut tangents = spines[1].tangents().to_vec();
        tangents[7] = -tangents[7];
        spines[1] = Spine::new(spines[1].points().to_vec(), tangents, false).unwrap();
        let batch = SpineBatch::new(&spines).unwrap();
        let mut references = batch.references();
        batch.propagate(&[DVec3::Z; 3], &mut references).unwrap();
        assert!(batch.frames(0, &references).is_ok() && batch.frames(2, &references).is_ok());
        assert_eq!(batch.frames(1, &references), Err(FrameError::DegenerateSegment { segment: 6 }));
    }

    #[test]
    fn rejects_unequal_spines() {
        assert_eq!(SpineBatch::new(&[]).unwrap_err(), BatchError::Count { count: 0 });
        assert_eq!(SpineBatch::new(&spines(17, 3)).unwrap_err(), BatchError::Count { count: 17 });
        let unequal = [spines(1, 3), spines(1, 4)].concat();
        assert_eq!(SpineBatch::new(&unequal).unwrap_err(), BatchError::Segments { index: 1, segments: 4, expected: 3 });
        let constant = Spine::new(vec![DVec3::X; 2], vec![DVec3::X; 2], false).unwrap();
        assert_eq!(SpineBatch::new(&[constant]).unwrap_err(), BatchError::RepeatedPoint { index: 0, segment: 0 });
    }
}
