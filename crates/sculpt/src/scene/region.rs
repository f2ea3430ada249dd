//! Strokes of moving regions.

use std::{collections::BTreeMap, sync::Arc};

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{self as mesh, Aabb, Distance};

use super::{problem::SceneProblem, profile::profile};
use crate::recipe::{InnerRegion, RecipeError, Region, rotation::quaternion};

/// The stroke that `region` describes, for a target in the box `reference`, in world coordinates.
/// The outer error has a key of the region.
pub(super) fn stroke(
    region: &Region,
    tools: &BTreeMap<&str, Arc<field::Tool>>,
    step: f64,
    reference: Aabb,
) -> Result<Result<field::Stroke, field::StrokeError>, RecipeError<SceneProblem>> {
    let (inner, placement) = inner(&region.inner, tools).map_err(|error| RecipeError::new("inner", error))?;
    let moving = field::Region::new(inner, placement, region.outer_distance, profile(region.profile))
        .map_err(|error| RecipeError::new("", error))?;
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

/// The distance to an inner region in local coordinates, and the pose world from local.
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
