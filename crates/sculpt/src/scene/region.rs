//! Regions of space that move.

use std::{collections::BTreeMap, sync::Arc};

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{self as mesh, Aabb, Distance};

use super::profile::profile;
use crate::recipe::{InnerRegion, RecipeError, RecipeProblem, Region, rotation::quaternion};

/// The stroke that `region` describes, with these tools, for what lies in the box `reference` of the world. The outer error names
/// a key of the region.
pub(super) fn stroke(
    region: &Region,
    tools: &BTreeMap<&str, Arc<field::Tool>>,
    step: f64,
    reference: Aabb,
) -> Result<Result<field::Stroke, field::StrokeError>, RecipeError> {
    let other = |key: &'static str| move |text: String| RecipeError::new(key, RecipeProblem::Other(text));
    let (inner, placement) = inner(&region.inner, tools).map_err(|error| other("inner")(error.to_string()))?;
    let moving = field::Region::new(inner, placement, region.outer_distance, profile(region.profile))
        .map_err(|error| other("")(error.to_string()))?;
    let motion = match (&region.motion.translate, &region.motion.rotate) {
        (_, Some(turn)) => field::RegionMotion::Rotation {
            origin: turn.origin.into(),
            axis: turn.axis.into(),
            angle: turn.degrees.to_radians(),
        },
        (shift, None) => field::RegionMotion::Translation(shift.map_or(DVec3::ZERO, DVec3::from_array)),
    };
    Ok(moving.stroke(motion, step, reference).map(field::Stroke::Move).map_err(Into::into))
}

/// The distance to an inner region in coordinates of its own, and the world from these.
fn inner(
    region: &InnerRegion,
    tools: &BTreeMap<&str, Arc<field::Tool>>,
) -> Result<(Arc<dyn Distance>, field::Pose), mesh::ShapeError> {
    Ok(match region {
        InnerRegion::Sphere(region) => {
            (Arc::new(mesh::Sphere::new(region.radius)?), field::Pose::at(region.center.into()))
        }
        InnerRegion::HalfSpace(region) => {
            (Arc::new(mesh::HalfSpace::new(region.point.into(), region.normal.into())?), field::Pose::IDENTITY)
        }
        InnerRegion::Capsule(region) => {
            let [from, to] = [region.from, region.to].map(DVec3::from_array);
            let half = 0.5 * (to - from);
            let axis = DVec3::Z.cross(half);
            let turn = axis.normalize_or(DVec3::X) * libm::atan2(axis.length(), half.z);
            let pose = field::Pose { rotation: field::rotation_from_vector(turn), translation: from + half };
            (Arc::new(mesh::Capsule::new(region.radius, half.length())?), pose)
        }
        InnerRegion::Tool(region) => {
            let pose = field::Pose { rotation: quaternion(region.rotate), translation: region.at.into() };
            (tools[region.tool.as_str()].shared_distance(), pose)
        }
    })
}
