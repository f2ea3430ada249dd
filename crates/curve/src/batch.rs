//! Double reflection for sixteen curves at once, in single precision.
//!
//! One curve is a chain of dependent steps, so a processor waits most of the time; sixteen curves fill its vectors.
//! Chords are taken in double precision before they are rounded, since their cancellation is what costs single
//! precision its digits on dense samples.

use glam::DVec3;
use multiversion::multiversion;

use crate::double_reflection::SMALLEST_SECOND_REFLECTION;
use crate::frame::{FrameError, orthogonal_reference};
use crate::{Frame, Spine};

/// Curves carried at once.
pub const BATCH_SIZE: usize = 16;

/// One number for each curve.
type Lanes = [f32; BATCH_SIZE];

/// A vector for each curve.
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

/// Up to sixteen spines with equally many segments, laid out so that they are carried abreast.
#[derive(Debug, Clone)]
pub struct SpineBatch {
    count: usize,
    /// Chords by segment, each scaled to unit length.
    chords: Vec<VectorLanes>,
    /// Tangents by station.
    tangents: Vec<VectorLanes>,
    /// Tangents in full precision by station, for the frames.
    spines: Vec<Spine>,
}

/// Reference vectors of spines carried abreast.
#[derive(Debug, Clone)]
pub struct ReferenceBatch {
    vectors: Vec<VectorLanes>,
    /// For each curve the smallest squared second reflection.
    smallest: Lanes,
}

/// Why spines cannot be carried abreast.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BatchError {
    /// There are none, or more than sixteen.
    #[error("{count} spines, where 1 to 16 are carried abreast")]
    Count {
        /// Spines given.
        count: usize,
    },
    /// A spine has another number of segments than the first.
    #[error("spine {index} has {segments} segments and the first has {expected}")]
    Segments {
        /// The spine.
        index: usize,
        /// Its segments.
        segments: usize,
        /// Those of the first.
        expected: usize,
    },
    /// Two equal neighboring points, which have no chord.
    #[error("segment {segment} of spine {index} has no length")]
    RepeatedPoint {
        /// The spine.
        index: usize,
        /// The segment.
        segment: usize,
    },
}

impl SpineBatch {
    /// Lays out `spines`.
    ///
    /// # Errors
    /// A wrong number of spines, unequal numbers of segments, and repeated points.
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
        // Lanes without a curve repeat the last one.
        let spine = |lane: usize| &spines[lane.min(spines.len() - 1)];
        let chord = |i: usize, lane: usize| (spine(lane).point(i + 1) - spine(lane).point(i)).normalize_or_zero();
        Ok(Self {
            count: spines.len(),
            chords: (0..expected).map(|i| VectorLanes::gather(|lane| chord(i, lane))).collect(),
            tangents: (0..=expected).map(|i| VectorLanes::gather(|lane| spine(lane).tangent(i))).collect(),
            spines: spines.to_vec(),
        })
    }

    /// Room for the results of [`carry`](Self::carry).
    pub fn references(&self) -> ReferenceBatch {
        ReferenceBatch { vectors: vec![VectorLanes::ZERO; self.tangents.len()], smallest: [4.0; BATCH_SIZE] }
    }

    /// Carries the part of each of `starts` normal to the first tangent of its curve along all curves, into
    /// `references`.
    ///
    /// # Errors
    /// [`FrameError::Reference`] where a start is along its first tangent.
    ///
    /// # Panics
    /// If there is not one start a curve, or if `references` was made for other spines.
    pub fn propagate(&self, starts: &[DVec3], references: &mut ReferenceBatch) -> Result<(), FrameError> {
        assert_eq!(starts.len(), self.count, "one start a curve");
        assert_eq!(references.vectors.len(), self.tangents.len(), "references of these spines");
        let starts = starts
            .iter()
            .zip(&self.spines)
            .map(|(&start, spine)| orthogonal_reference(start, spine.tangent(0)))
            .collect::<Result<Vec<_>, _>>()?;
        references.vectors[0] = VectorLanes::gather(|lane| starts[lane.min(self.count - 1)]);
        references.smallest = carry_lanes(&self.chords, &self.tangents, &mut references.vectors);
        Ok(())
    }

    /// The frames of one curve, made orthonormal in double precision.
    ///
    /// # Errors
    /// [`FrameError::DegenerateSegment`] where a segment of the curve determines no rotation; the frames of the other
    /// curves are good.
    ///
    /// # Panics
    /// If there is no such curve.
    pub fn frames(&self, curve: usize, references: &ReferenceBatch) -> Result<Vec<Frame>, FrameError> {
        assert!(curve < self.count, "curve {curve} of {}", self.count);
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

/// The kernel: double reflection for all lanes, segment by segment. Compiled for several instruction sets, none of
/// which fuses multiplications and additions, so that all give the same bits.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn carry_lanes(chords: &[VectorLanes], tangents: &[VectorLanes], references: &mut [VectorLanes]) -> Lanes {
    let mut smallest = [4.0; BATCH_SIZE];
    let mut r = references[0];
    let mut start = &tangents[0];
    let steps = chords.iter().zip(&tangents[1..]).zip(&mut references[1..]);
    for ((chord, end), out) in steps {
        for lane in 0..BATCH_SIZE {
            let (cx, cy, cz) = (chord.x[lane], chord.y[lane], chord.z[lane]);
            let (sx, sy, sz) = (start.x[lane], start.y[lane], start.z[lane]);
            let along = 2.0 * (cx * sx + cy * sy + cz * sz);
            let (vx, vy, vz) =
                (end.x[lane] - (sx - along * cx), end.y[lane] - (sy - along * cy), end.z[lane] - (sz - along * cz));
            let second = vx * vx + vy * vy + vz * vz;
            smallest[lane] = if second < smallest[lane] { second } else { smallest[lane] };
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
    fn every_curve_has_the_frames_of_double_precision() {
        for count in [1, 5, 16] {
            let spines = spines(count, 1000);
            let starts = vec![DVec3::Z; count];
            let abreast = SpineBatch::new(&spines).unwrap();
            let mut references = abreast.references();
            abreast.propagate(&starts, &mut references).unwrap();
            for (curve, spine) in spines.iter().enumerate() {
                let exact = rotation_minimizing_frames(
                    spine,
                    DVec3::Z,
                    FrameMethod::DoubleReflection,
                    DegenerateSegment::Refuse,
                )
                .unwrap();
                let frames = abreast.frames(curve, &references).unwrap();
                let worst = frames.iter().zip(&exact.stations).map(|(a, b)| a.r.distance(b.r)).fold(0.0, f64::max);
                // A thousand steps of single rounding at random: √1000 · 6e-8 = 2e-6, and a margin of four.
                assert!(worst < 8e-6, "curve {curve}: {worst:e}");
                // Orthonormal in double precision.
                assert!(frames.iter().all(|f| f.r.dot(f.t).abs() < 1e-15 && (f.r.length() - 1.0).abs() < 1e-15));
            }
        }
    }

    #[test]
    fn one_bad_curve_leaves_the_others() {
        let mut spines = spines(3, 20);
        let mut tangents = spines[1].tangents().to_vec();
        tangents[7] = -tangents[7];
        spines[1] = Spine::new(spines[1].points().to_vec(), tangents, false).unwrap();
        let abreast = SpineBatch::new(&spines).unwrap();
        let mut references = abreast.references();
        abreast.propagate(&[DVec3::Z; 3], &mut references).unwrap();
        assert!(abreast.frames(0, &references).is_ok() && abreast.frames(2, &references).is_ok());
        assert_eq!(abreast.frames(1, &references), Err(FrameError::DegenerateSegment { segment: 6 }));
    }

    #[test]
    fn unequal_spines_are_refused() {
        assert_eq!(SpineBatch::new(&[]).unwrap_err(), BatchError::Count { count: 0 });
        assert_eq!(SpineBatch::new(&spines(17, 3)).unwrap_err(), BatchError::Count { count: 17 });
        let unequal = [spines(1, 3), spines(1, 4)].concat();
        assert_eq!(SpineBatch::new(&unequal).unwrap_err(), BatchError::Segments { index: 1, segments: 4, expected: 3 });
        let still = Spine::new(vec![DVec3::X; 2], vec![DVec3::X; 2], false).unwrap();
        assert_eq!(SpineBatch::new(&[still]).unwrap_err(), BatchError::RepeatedPoint { index: 0, segment: 0 });
    }
}
