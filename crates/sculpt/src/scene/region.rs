//! Strokes of moving regions.

use std::{
    collections::{BTreeMap, btree_map::Entry},
    sync::Arc,
};

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{self as mesh, Aabb, Distance};

use super::{error::BuildToolError, problem::SceneProblem, profile::profile, tool::ToolBuilder};
use crate::recipe::{InnerRegion, Recipe, RecipeError, Region, Stroke, rotation::quaternion};

/// Distances of the tools that are inner regions, by the name of the tool and the bits of the
/// region's thickness. A smooth distance is built for one thickness, which takes the place of the
/// tool's support.
pub(super) type InnerTools<'a> = BTreeMap<(&'a str, u64), Arc<dyn Distance>>;

/// Builds the distances of all inner regions of `recipe` that are tools.
pub(super) fn inner_tools<'a>(
    recipe: &'a Recipe,
    builder: &mut ToolBuilder<'_>,
) -> Result<InnerTools<'a>, BuildToolError> {
    let mut tools = InnerTools::new();
    for stroke in &recipe.strokes {
        if let Stroke::Region(region) = stroke
            && let InnerRegion::Tool(inner) = &region.inner
        {
            let (name, thickness) = (inner.tool.as_str(), region.outer_distance);
            if let Entry::Vacant(vacant) = tools.entry((name, thickness.to_bits())) {
                vacant.insert(builder.distance(name, &recipe.tools[name], thickness, thickness)?);
            }
        }
    }
    Ok(tools)
}

/// The stroke that `region` describes, for a target in the box `reference`, in world coordinates.
/// The outer error has a key of the region.
pub(super) fn stroke(
    region: &Region,
    tools: &InnerTools<'_>,
    step: f64,
    reference: Aabb,
) -> Result<Result<field::Stroke, field::StrokeError>, RecipeError<SceneProblem>> {
    let (inner, placement) = inner(region, tools).map_err(|error| RecipeError::new("inner", error))?;
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
fn inner(region: &Region, tools: &InnerTools<'_>) -> Result<(Arc<dyn Distance>, field::Pose), mesh::ShapeError> {
    let thickness = region.outer_distance.to_bits();
    Ok(match &region.inner {
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
            (Arc::clone(&tools[&(region.tool.as_str(), thickness)]), pose)
        }
    })
}
