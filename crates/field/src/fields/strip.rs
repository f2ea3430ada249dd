//! Strips: fields that follow a spine, along it or across it.
//!
//! ```text
//! along:   V = curl(g² ½ T×r) = g² T + (2g g′/R) ∇d × (½ T×r)
//! across:  V = S′(s) ∇s × ∇(g U·r) = curl(−g (U·r) S′ ∇s),   ∇s = T/(1 − κξ),   U = m×T
//! ```
//!
//! r leads from the nearest point of the spine to the point at hand, T is the tangent there, s the arc length up to there, κξ the
//! curvature vector times r, d the signed distance from the strip, R the support, g(d/R) the profile, and m the velocity of the
//! spine. S′ rises smoothly from zero at the ends of the spine. Along, the core streams at unit speed; across, it moves by the part
//! of m normal to the spine over 1 − κξ. The frame of the spine drops out of both: any smooth normal vectors would give the same
//! field.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, sections 11.2.2 (type I) and 11.2.3 (type II). There
//! the scalar across is any that grows along the spine and stops at its ends, where the field then jumps; it is the arc length
//! here, and fades.

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
use error::REACH_SHARE;
use extent::farthest;
use placed_strip::PlacedStrip;
use spine_curve::SpineCurve;
use spine_instant::{SpineInstant, StartFrame, default_reference};
use strip_shape::CrossSection;

/// Instants at which a spine that changes its shape is looked at. Fewer might miss the moment at which it bends most; more takes
/// longer.
const CHECKED_INSTANTS: usize = 65;

/// Samples of each smooth piece of the spine for its reach, and of the whole at least and at most. The time grows with the square
/// of their number, the error falls with it.
const REACH_SAMPLES_PER_PIECE: usize = 16;
const LEAST_REACH_SAMPLES: usize = 64;
const MOST_REACH_SAMPLES: usize = 512;

/// Where a strip carries the material inside it, over the time from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StripMotion {
    /// Along the spine, towards its end. The field stays in place, but for a spine that changes its shape.
    Along {
        /// How far the core is carried, model units; towards the start of the spine where that is negative.
        distance: f64,
    },
    /// With the spine, as a pushed rod does. Where the spine also changes its shape, that motion is added.
    Across {
        /// How far the spine travels, model units.
        travel: DVec3,
    },
}

/// A strip about a spine, over the time from 0 to 1.
#[derive(Debug, Clone)]
pub struct Strip {
    spine: Arc<StripSpine>,
    shape: Arc<StripShape>,
    motion: StripMotion,
    /// The spine at time 0, which is that of all times where the shape does not change.
    start: Arc<SpineInstant>,
    start_frame: Option<StartFrame>,
    extent: f64,
    core_speed: f64,
}

impl Strip {
    /// The strip of a `shape` about a `spine` that carries what is inside it by `motion`.
    ///
    /// # Errors
    /// [`StripError`], most of all where the field would reach points that have no nearest point on the spine.
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

    /// How it moves.
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

    /// How far from the spine the field reaches.
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
        // A spine that stands still somewhere may have no number for its reach.
        if distance.is_nan() || self.extent >= REACH_SHARE * distance {
            return Err(StripError::Reach { extent: self.extent, curvature_radius, bottleneck_radius, time });
        }
        let (length, taper) = (instant.length(), self.extent);
        if matches!(self.motion, StripMotion::Across { .. }) && !instant.is_closed() && length <= 2.0 * taper {
            return Err(StripError::TooShort { length, taper, time });
        }
        Ok(())
    }

    /// Largest speed in the core, from samples.
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
            // The spine may change its shape, but the tool stays what it is.
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
