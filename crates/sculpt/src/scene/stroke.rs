//! Strokes built from their descriptions.

use std::{collections::BTreeMap, sync::Arc};

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::Aabb;

use super::{SceneError, pose, problem::SceneProblem, region, region::InnerTools, strip};
use crate::recipe::{InvalidRecipe, Key, RecipeError, Stroke};

/// Builds the strokes of a valid recipe, in which points replace curve files.
pub(super) struct StrokeBuilder<'a> {
    pub(super) tools: &'a BTreeMap<&'a str, Arc<field::Tool>>,
    pub(super) inner_tools: &'a InnerTools<'a>,
    /// Time step, `integrate.step`.
    pub(super) step: f64,
    /// Box around everything that is deformed, model units.
    pub(super) bounds: Aabb,
}

impl StrokeBuilder<'_> {
    pub(super) fn build(&self, index: usize, stroke: &Stroke) -> Result<field::Stroke, SceneError> {
        let stroke = match stroke {
            Stroke::Move(motion) => field::Move::new(self.tool(&motion.tool), poses(&motion.keys)?, self.step)
                .map(field::Stroke::Move)
                .map_err(field::StrokeError::from),
            Stroke::Twist(twist) => {
                let [origin, axis] = [twist.origin, twist.axis].map(DVec3::from_array);
                field::Twist::new(origin, axis, twist.degrees_per_unit.to_radians())
                    .map(field::Stroke::Twist)
                    .map_err(field::StrokeError::from)
            }
            Stroke::Bend(bend) => {
                let [origin, axis] = [bend.origin, bend.axis].map(DVec3::from_array);
                field::Bend::new(origin, axis, bend.degrees_per_unit2.to_radians())
                    .map(field::Stroke::Bend)
                    .map_err(field::StrokeError::from)
            }
            Stroke::Stamp(stamp) => {
                field::Stamp::new(self.tool(&stamp.tool), poses(&stamp.keys)?, self.step, stamp.relief)
                    .map(field::Stroke::Stamp)
                    .map_err(field::StrokeError::from)
            }
            Stroke::Strip(strip) => strip::strip(strip, self.tools)
                .map_err(field::StrokeError::from)
                .and_then(|strip| self.field_stroke(strip)),
            Stroke::Ring(ring) => {
                strip::ring(ring).map_err(field::StrokeError::from).and_then(|ring| self.field_stroke(ring))
            }
            Stroke::Region(region) => region::stroke(region, self.inner_tools, self.step, self.bounds)
                .map_err(|error| error.inside(&index.to_string()).inside("stroke"))?,
            Stroke::Pose(pose) => pose::stroke(pose, self.tools, self.step)
                .map_err(|error| RecipeError::<SceneProblem>::new(&format!("stroke.{index}"), error))?,
        };
        stroke.map_err(|source| SceneError::Stroke { index, source })
    }

    fn tool(&self, name: &str) -> Arc<field::Tool> {
        Arc::clone(&self.tools[name])
    }

    fn field_stroke(&self, field: impl field::MovingField + 'static) -> Result<field::Stroke, field::StrokeError> {
        Ok(field::Stroke::Field(field::FieldStroke::new(vec![Arc::new(field)], self.step)?))
    }
}

fn poses(keys: &[Key]) -> Result<Vec<field::Pose>, RecipeError<InvalidRecipe>> {
    keys.iter().map(|key| key.pose().map_err(RecipeError::widen)).collect()
}
