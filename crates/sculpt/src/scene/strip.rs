//! Fields of strips and rings.

use std::{collections::BTreeMap, sync::Arc};

use glam::{DVec2, DVec3};
use isochore_field as field;

use super::profile::profile;
use crate::recipe::{Ring, Strip, StripMode};

/// The field of a valid strip, in which points have replaced curve files.
pub(super) fn strip(
    strip: &Strip,
    tools: &BTreeMap<&str, Arc<field::Tool>>,
) -> Result<field::Strip, field::StripError> {
    let points = |points: &[[f64; 3]]| points.iter().copied().map(DVec3::from_array).collect::<Vec<_>>();
    let start = points(strip.spine.points());
    let spine = match &strip.spine_end {
        Some(end) => field::StripSpine::between(&start, &points(end.points()))?,
        None => field::StripSpine::through(&start)?,
    };
    let motion = match strip.mode {
        StripMode::Along => field::StripMotion::Along { distance: strip.distance },
        StripMode::Across => {
            let direction = strip.direction.map_or(DVec3::ZERO, DVec3::from_array).normalize_or_zero();
            field::StripMotion::Across { travel: strip.distance * direction }
        }
    };
    field::Strip::new(spine, shape(strip, tools)?, motion)
}

fn shape(strip: &Strip, tools: &BTreeMap<&str, Arc<field::Tool>>) -> Result<field::StripShape, field::StripError> {
    if let Some(tool) = &strip.tool {
        return field::StripShape::tool(Arc::clone(&tools[tool.as_str()]));
    }
    let (support, profile) = (strip.support.unwrap_or_default(), profile(strip.profile.unwrap_or_default()));
    if let Some(section) = &strip.section {
        let polygon: Vec<DVec2> = section.iter().copied().map(DVec2::from_array).collect();
        return field::StripShape::polygon(&polygon, strip.reference.map(DVec3::from_array), support, profile);
    }
    let radii = strip.radius.as_ref().map_or(&[][..], |radius| radius.values());
    field::StripShape::varying(radii, support, profile)
}

pub(super) fn ring(ring: &Ring) -> Result<field::Ring, field::RingError> {
    let shape = field::RingShape {
        center: DVec3::from_array(ring.center),
        axis: DVec3::from_array(ring.axis),
        major: ring.major,
        minor: ring.minor,
        support: ring.support,
        profile: profile(ring.profile),
    };
    field::Ring::new(shape, ring.distance)
}
