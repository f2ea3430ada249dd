//! The field of a strip at one instant.
//!
//! The parent module states the formulas. Along, the weight is g² and the potential ½ T×r. Across,
//! the weight is S′ g and the potential −(U·r) ∇s.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use isochore_mesh::{Aabb, DistanceBlock, LANES, PointBlock};

use super::{
    StripMotion, StripSpine,
    spine_instant::{SpineInstant, Station},
    strip_shape::{CrossSection, StripShape},
};
use crate::fields::{Field, FieldBlock, NO_CORE, Profile, Tool, WeightedPotential};

/// A strip at one instant, with its motion.
#[derive(Debug, Clone)]
pub(super) struct PlacedStrip {
    pub(super) shape: Arc<StripShape>,
    pub(super) spine: Arc<SpineInstant>,
    pub(super) path: Arc<StripSpine>,
    pub(super) motion: StripMotion,
    /// Displacement of spine and tool since time 0.
    pub(super) shift: DVec3,
    /// Distance from the spine that the field reaches.
    pub(super) extent: f64,
    pub(super) bounds: Aabb,
}

/// The field at one point.
#[derive(Debug, Clone, Copy)]
enum Sample {
    /// Beyond the support by at least this distance.
    Outside(f64),
    /// Within the support.
    Inside(WeightedPotential),
}

/// A distance below the support with its gradient, or a lower bound on the distance from the
/// support.
type Near = Result<(f64, DVec3), f64>;

impl Field for PlacedStrip {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        let mut local = PointBlock::ZERO;
        let mut is_near = false;
        for lane in 0..LANES {
            is_near |= self.bounds.distance(points.get(lane)) == 0.0;
            local.set(lane, points.get(lane) - self.shift);
        }
        let mut distances = DistanceBlock::FAR;
        if let (CrossSection::Tool(tool), true) = (&self.shape.cross_section, is_near) {
            tool.distance().sample_into(&local, &mut distances);
        }
        let mut sample = Sample::Outside(0.0);
        for lane in 0..LANES {
            // Unused lanes of a block repeat the point before.
            if lane == 0 || points.get(lane) != points.get(lane - 1) {
                let beyond = self.bounds.distance(points.get(lane));
                sample = if beyond > 0.0 {
                    Sample::Outside(beyond)
                } else {
                    self.sample(local.get(lane), distances.value[lane], distances.gradient.get(lane))
                };
            }
            match sample {
                Sample::Outside(clearance) => out.set_outside(lane, clearance),
                Sample::Inside(product) => out.set_inside(lane, product, NO_CORE),
            }
        }
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }
}

impl PlacedStrip {
    /// The field at a point in the coordinates of the displaced strip, with the distance from a
    /// tool, if the strip has one.
    fn sample(&self, point: DVec3, tool_distance: f64, tool_gradient: DVec3) -> Sample {
        if let CrossSection::Tool(tool) = &self.shape.cross_section
            && let Err(clearance) = near_tool(tool, tool_distance, tool_gradient)
        {
            return Sample::Outside(clearance);
        }
        let station = self.spine.station(point);
        let near = match &self.shape.cross_section {
            CrossSection::Tool(_) => Ok((tool_distance, tool_gradient)),
            _ => self.near_spine(&station),
        };
        let (distance, gradient) = match near {
            Err(clearance) => return Sample::Outside(clearance),
            Ok((distance, _)) if distance >= self.shape.support => return Sample::Outside(0.0),
            Ok(near) => near,
        };
        let (value, slope) = self.shape.profile.evaluate(distance / self.shape.support);
        let gradient = slope / self.shape.support * gradient;
        match self.motion {
            StripMotion::Along { distance: speed } => Sample::Inside(WeightedPotential {
                weight: value * value,
                gradient: 2.0 * value * gradient,
                potential: 0.5 * speed * station.tangent.cross(station.offset),
                curl: speed * station.tangent,
            }),
            StripMotion::Across { travel } => self.across(&station, travel, value, gradient),
        }
    }

    /// Weight S′ g and potential −(U·r) ∇s, whose curl is ∇s × U.
    fn across(&self, station: &Station, travel: DVec3, value: f64, gradient: DVec3) -> Sample {
        let (taper, taper_slope) = self.taper(station);
        if station.beyond > 0.0 || taper == 0.0 {
            return Sample::Outside(0.0);
        }
        let length_gradient = station.speed * station.parameter_gradient;
        let velocity = travel + self.path.velocity(station.parameter);
        let direction = velocity.cross(station.tangent);
        Sample::Inside(WeightedPotential {
            weight: taper * value,
            gradient: taper * gradient + value * taper_slope * station.parameter_gradient,
            potential: -direction.dot(station.offset) * length_gradient,
            curl: length_gradient.cross(direction),
        })
    }

    /// Weight S′ that fades at the ends of the spine, and its derivative by the parameter.
    fn taper(&self, station: &Station) -> (f64, f64) {
        let total = self.spine.length();
        let (length, speed) = self.spine.length_to(station);
        if self.spine.is_closed() || (length >= self.extent && total - length >= self.extent) {
            return (1.0, 0.0);
        }
        let (start, start_slope) = smoothstep(length / self.extent);
        let (end, end_slope) = smoothstep((total - length) / self.extent);
        (start * end, (start_slope * end - start * end_slope) * speed / self.extent)
    }

    /// Distance from a round strip or a polygonal cross-section, and its gradient.
    fn near_spine(&self, station: &Station) -> Near {
        let clearance = station.offset.length() - self.extent;
        if clearance > 0.0 {
            return Err(clearance);
        }
        match &self.shape.cross_section {
            CrossSection::Round(law) => {
                let length = station.offset.length();
                // On the spine the distance has no gradient; zero is used.
                let radial = if length > 0.0 { station.offset / length } else { DVec3::ZERO };
                if law.is_constant() {
                    return Ok((length - law.largest(), radial));
                }
                let total = self.spine.length();
                let (along, speed) = self.spine.length_to(station);
                let (radius, slope) = law.evaluate(along / total);
                Ok((length - radius, radial - slope * (speed / total) * station.parameter_gradient))
            }
            CrossSection::Polygon { section, .. } => {
                let normal = self.spine.normal(station);
                let side = station.tangent.cross(normal.vector);
                let side_derivative =
                    station.tangent_derivative.cross(normal.vector) + station.tangent.cross(normal.derivative);
                let offset = station.offset;
                // ∇(N·r) = N + (N′·r) ∇u, since N is normal to the spine.
                let axis_gradient =
                    |vector: DVec3, derivative: DVec3| vector + derivative.dot(offset) * station.parameter_gradient;
                let plane_point = DVec2::new(normal.vector.dot(offset), side.dot(offset));
                let (flat, slopes) = section.sample(plane_point).ok_or(0.0)?;
                let flat_gradient = slopes.x * axis_gradient(normal.vector, normal.derivative)
                    + slopes.y * axis_gradient(side, side_derivative);
                if station.beyond == 0.0 {
                    return Ok((flat, flat_gradient));
                }
                // Round caps: beyond the end, the distance from the deepest line of the section is
                // the hypotenuse of the distance in the plane and the distance along the tangent.
                let beyond = offset.dot(station.tangent);
                let leg = flat + section.depth();
                let length = (leg * leg + beyond * beyond).sqrt();
                Ok((length - section.depth(), (leg * flat_gradient + beyond * station.tangent) / length))
            }
            CrossSection::Tool(_) => Err(0.0),
        }
    }
}

/// Distance from a tool and its gradient, if below its support.
fn near_tool(tool: &Tool, distance: f64, gradient: DVec3) -> Near {
    if distance < tool.support() {
        return Ok((distance, gradient));
    }
    let beyond = (distance - tool.support()) / tool.distance().lipschitz();
    // Beyond the samples of a grid the distance is infinite and gives no bound.
    Err(if beyond.is_finite() { beyond } else { 0.0 })
}

/// Step from zero at 0 to one at 1, twice continuously differentiable, and its derivative.
fn smoothstep(t: f64) -> (f64, f64) {
    let (value, slope) = Profile::Quintic.evaluate(1.0 - t);
    (value, -slope)
}
