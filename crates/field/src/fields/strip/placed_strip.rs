//! The field of a strip at one instant.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use isochore_mesh::{Aabb, DistanceBlock, LANES, PointBlock};

use super::{
    StripMotion, StripSpine,
    spine_instant::{SpineInstant, Station},
    strip_shape::{CrossSection, StripShape},
};
use crate::fields::{Field, FieldBlock, NO_CORE, Profile, Tool, WeightedPotential};

/// A strip where it is at one instant, and how it moves.
#[derive(Debug, Clone)]
pub(super) struct PlacedStrip {
    pub(super) shape: Arc<StripShape>,
    pub(super) spine: Arc<SpineInstant>,
    pub(super) path: Arc<StripSpine>,
    pub(super) motion: StripMotion,
    /// How far spine and tool have traveled since time 0.
    pub(super) shift: DVec3,
    /// The field reaches no farther from the spine.
    pub(super) extent: f64,
    pub(super) bounds: Aabb,
}

/// The field at one point.
#[derive(Debug, Clone, Copy)]
enum Sample {
    /// Beyond the support by at least this.
    Outside(f64),
    Inside(WeightedPotential),
}

/// A distance that is below the support, and its gradient; or how far at least the support is.
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
            // Lanes that fill a block repeat the one before.
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
    /// The field at a point relative to the traveled strip; the distance from a tool comes along.
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

    /// S′ g as the share and −(U·r) ∇s as the potential, whose curl is ∇s × U.
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

    /// The share of the motion that the ends leave, and its derivative by the parameter.
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

    fn near_spine(&self, station: &Station) -> Near {
        let clearance = station.offset.length() - self.extent;
        if clearance > 0.0 {
            return Err(clearance);
        }
        match &self.shape.cross_section {
            CrossSection::Round(law) => {
                let length = station.offset.length();
                // On the spine itself the distance has no gradient, and is given none.
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
                let place = DVec2::new(normal.vector.dot(offset), side.dot(offset));
                let (flat, slopes) = section.sample(place).ok_or(0.0)?;
                let flat_gradient = slopes.x * axis_gradient(normal.vector, normal.derivative)
                    + slopes.y * axis_gradient(side, side_derivative);
                if station.beyond == 0.0 {
                    return Ok((flat, flat_gradient));
                }
                // Round caps: seen from the depths of the section, its distance and the one beyond the end are two legs.
                let beyond = offset.dot(station.tangent);
                let leg = flat + section.depth();
                let length = (leg * leg + beyond * beyond).sqrt();
                Ok((length - section.depth(), (leg * flat_gradient + beyond * station.tangent) / length))
            }
            CrossSection::Tool(_) => Err(0.0),
        }
    }
}

fn near_tool(tool: &Tool, distance: f64, gradient: DVec3) -> Near {
    if distance < tool.support() {
        return Ok((distance, gradient));
    }
    let beyond = (distance - tool.support()) / tool.distance().lipschitz();
    // Beyond the samples of a grid the distance is infinite, and nothing is known but that.
    Err(if beyond.is_finite() { beyond } else { 0.0 })
}

/// From zero at 0 to one at 1, twice continuously differentiable, and the derivative.
fn smoothstep(t: f64) -> (f64, f64) {
    let (value, slope) = Profile::Quintic.evaluate(1.0 - t);
    (value, -slope)
}
