//! Strips: fields that move material along a spine, or sweep a spine sideways.
//!
//! ```text
//! along:   V = curl(g² ½ T×r) = g² T + (2g g′/R) ∇d × (½ T×r)
//! across:  V = S′(s) ∇s × ∇(g U·r) = curl(−g (U·r) S′ ∇s),   ∇s = T/(1 − κξ),   U = m×T
//! ```
//!
//! r is the vector from the nearest point of the spine to the evaluated point; T is the tangent and
//! s the arc length at that nearest point. κξ is the curvature vector times r. d is the signed
//! distance from the strip, R the support, g(d/R) the profile and m the velocity of the spine. S′
//! rises smoothly from zero at the ends of the spine.
//!
//! Along, the core streams at unit speed. Across, the core moves with the normal part of m, divided
//! by 1 − κξ. Both fields are independent of the frame of the spine: any smooth normal vectors
//! would give the same field.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, sections 11.2.2 (type
//! I) and 11.2.3 (type II). For type II, the thesis uses any scalar that grows along the spine and
//! stops at its ends, where the field then jumps. This module uses the arc length and fades the
//! field at the ends.

mod error;
mod extent;
mod placed_strip;
mod radius_law;
mod section;
mod spine_curve;
mod spine_instant;
mod strip_shape;

use std::sync::Arc;

use glam::DVec3;
use isochore_curve::{Curve, Reach, orthogonal_reference, reach};

pub use error::StripError;
pub use spine_curve::StripSpine;
pub use strip_shape::StripShape;

use crate::fields::{Field, MovingField, Tool};
use error::REACH_FRACTION;
use extent::farthest;
use placed_strip::PlacedStrip;
use spine_curve::SpineCurve;
use spine_instant::{SpineInstant, StartFrame, default_reference};
use strip_shape::CrossSection;

/// Number of instants at which a deforming spine is checked. Larger: slower. Smaller: the moment of
/// largest curvature can be missed.
const CHECKED_INSTANTS: usize = 65;

/// Samples of each smooth piece of the spine for its reach, and the smallest and largest number in
/// all. Larger: the time grows with the square of the number. Smaller: the error of the reach grows
/// with the square of the spacing.
const REACH_SAMPLES_PER_PIECE: usize = 16;
const LEAST_REACH_SAMPLES: usize = 64;
const MOST_REACH_SAMPLES: usize = 512;

/// Motion of the material inside a strip, over the time from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StripMotion {
    /// Along the spine, towards its end. The field is constant in time unless the spine deforms.
    Along {
        /// Distance that the core moves, model units; negative towards the start of the spine.
        distance: f64,
    },
    /// With the spine, like a rod that is pushed sideways. The motion of a deforming spine is
    /// added.
    Across {
        /// Displacement of the spine, model units.
        travel: DVec3,
    },
}

/// A solid around a spine, with its motion over the time from 0 to 1.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_field::{MovingField, Profile, Strip, StripMotion, StripShape, StripSpine};
///
/// let spine = StripSpine::through(&[DVec3::ZERO, DVec3::X, 2.0 * DVec3::X])?;
/// let shape = StripShape::round(0.2, 0.3, Profile::Quintic)?;
/// let strip = Strip::new(spine, shape, StripMotion::Along { distance: 0.5 })?;
///
/// let field = strip.at(0.0);
/// assert!(field.velocity(DVec3::new(1.0, 0.1, 0.0)).distance(0.5 * DVec3::X) < 1e-14);
/// assert_eq!(field.velocity(DVec3::new(1.0, 0.6, 0.0)), DVec3::ZERO);
/// # Ok::<(), isochore_field::StripError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Strip {
    spine: Arc<StripSpine>,
    shape: Arc<StripShape>,
    motion: StripMotion,
    /// Spine at time 0, and at all times unless it deforms.
    start: Arc<SpineInstant>,
    start_frame: Option<StartFrame>,
    extent: f64,
    core_speed: f64,
}

impl Strip {
    /// The strip of a `shape` around a `spine`, with the given `motion` of its inside.
    ///
    /// # Errors
    /// - [`StripError::NotFinite`] if the distance or the travel is not finite.
    /// - [`StripError::Closed`] if a polygon or varying radii are combined with a closed spine.
    /// - [`StripError::Reference`] if the reference direction is zero or parallel to the start of
    ///   the spine.
    /// - [`StripError::Reach`] if the field would reach points without a unique nearest point on
    ///   the spine.
    /// - [`StripError::TooShort`] if the motion is across and an open spine is too short for its
    ///   ends to fade.
    pub fn new(spine: StripSpine, shape: StripShape, motion: StripMotion) -> Result<Self, StripError> {
        let is_finite = match motion {
            StripMotion::Along { distance } => distance.is_finite(),
            StripMotion::Across { travel } => travel.is_finite(),
        };
        if !is_finite {
            return Err(StripError::NotFinite("the distance"));
        }
        let curve = spine.at(0.0);
        let start_frame = start_frame(&curve, &shape)?;
        let start = Arc::new(SpineInstant::new(curve, start_frame));
        let shape = Arc::new(shape);
        let mut strip =
            Self { spine: Arc::new(spine), shape, motion, start, start_frame, extent: 0.0, core_speed: 0.0 };
        let count = if strip.spine.is_reshaping() { CHECKED_INSTANTS } else { 1 };
        let times: Vec<f64> = (0..count).map(|index| index as f64 / (count - 1).max(1) as f64).collect();
        let instants: Vec<Arc<SpineInstant>> = times.iter().map(|&time| strip.instant(time)).collect();
        strip.extent = instants.iter().map(|instant| strip.extent_from(instant)).fold(0.0, f64::max);
        for (instant, &time) in instants.iter().zip(&times) {
            strip.check(instant, time)?;
            strip.core_speed = strip.core_speed.max(strip.core_speed_at(instant));
        }
        Ok(strip)
    }

    /// The spine.
    pub fn spine(&self) -> &StripSpine {
        &self.spine
    }

    /// The motion.
    pub fn motion(&self) -> StripMotion {
        self.motion
    }

    fn instant(&self, time: f64) -> Arc<SpineInstant> {
        if self.spine.is_reshaping() {
            Arc::new(SpineInstant::new(self.spine.at(time), self.start_frame))
        } else {
            Arc::clone(&self.start)
        }
    }

    fn travel(&self) -> DVec3 {
        match self.motion {
            StripMotion::Along { .. } => DVec3::ZERO,
            StripMotion::Across { travel } => travel,
        }
    }

    /// Distance from the spine that the field reaches.
    fn extent_from(&self, instant: &SpineInstant) -> f64 {
        let support = self.shape.support;
        match &self.shape.cross_section {
            CrossSection::Round(law) => law.largest() + support,
            CrossSection::Polygon { section, .. } => section.radius() + support,
            CrossSection::Tool(tool) => farthest(tool, support, instant),
        }
    }

    fn check(&self, instant: &SpineInstant, time: f64) -> Result<(), StripError> {
        let curve = instant.curve();
        let Reach { distance, curvature_radius, bottleneck_radius } = reach(curve, reach_samples(curve));
        // The reach is NaN if the parametric speed of the spine vanishes somewhere.
        if distance.is_nan() || self.extent >= REACH_FRACTION * distance {
            return Err(StripError::Reach { extent: self.extent, curvature_radius, bottleneck_radius, time });
        }
        let (length, taper) = (instant.length(), self.extent);
        if matches!(self.motion, StripMotion::Across { .. }) && !instant.is_closed() && length <= 2.0 * taper {
            return Err(StripError::TooShort { length, taper, time });
        }
        Ok(())
    }

    /// Largest speed in the core, sampled along the spine.
    fn core_speed_at(&self, instant: &SpineInstant) -> f64 {
        let travel = match self.motion {
            StripMotion::Along { distance } => return distance.abs(),
            StripMotion::Across { travel } => travel,
        };
        let curve = instant.curve();
        let (first, last) = curve.domain();
        let count = reach_samples(curve);
        let core = self.extent - self.shape.support;
        let speed = |index: usize| {
            let parameter = first + (last - first) * index as f64 / (count - 1) as f64;
            let stretch = 1.0 - core * curve.jet(parameter).curvature();
            (travel + self.spine.velocity(parameter)).length() / stretch
        };
        (0..count).map(speed).fold(0.0, f64::max)
    }
}

impl MovingField for Strip {
    fn at(&self, time: f64) -> Box<dyn Field> {
        let spine = self.instant(time);
        let shift = self.travel() * time;
        let bounds = match &self.shape.cross_section {
            CrossSection::Tool(tool) => Tool::support_bounds(tool),
            _ => spine.bounds().expanded(self.extent),
        };
        Box::new(PlacedStrip {
            shape: Arc::clone(&self.shape),
            spine,
            path: Arc::clone(&self.spine),
            motion: self.motion,
            shift,
            extent: self.extent,
            bounds: bounds.translated(shift),
        })
    }

    fn approach_speed(&self) -> f64 {
        match &self.shape.cross_section {
            // Only the spine deforms; the tool does not.
            CrossSection::Tool(_) => self.travel().length(),
            _ => self.spine.top_speed(self.travel()),
        }
    }

    fn core_speed(&self) -> f64 {
        self.core_speed
    }

    fn feature_size(&self) -> f64 {
        self.shape.feature_size()
    }
}

fn start_frame(curve: &SpineCurve, shape: &StripShape) -> Result<Option<StartFrame>, StripError> {
    let reference = match &shape.cross_section {
        CrossSection::Round(law) if law.is_constant() => return Ok(None),
        CrossSection::Tool(_) => return Ok(None),
        _ if curve.is_closed() => return Err(StripError::Closed),
        CrossSection::Round(_) => return Ok(None),
        CrossSection::Polygon { reference, .. } => reference.unwrap_or_else(|| default_reference(curve)),
    };
    let tangent = curve.jet(curve.domain().0).tangent();
    let reference = orthogonal_reference(reference, tangent).map_err(|_| StripError::Reference)?;
    Ok(Some(StartFrame { reference, tangent }))
}

fn reach_samples(curve: &SpineCurve) -> usize {
    (REACH_SAMPLES_PER_PIECE * (curve.breaks().len() - 1)).clamp(LEAST_REACH_SAMPLES, MOST_REACH_SAMPLES)
}

#[cfg(test)]
pub(crate) mod tests;
