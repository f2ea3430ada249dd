//! The log of a session, which is a recipe.

use std::{collections::BTreeMap, sync::Arc};

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::Monitor;

use super::{Session, SessionError, SessionTool, StrokeOptions, StrokeReceipt};
use crate::{
    recipe::{Integrate, Key, Move, Recipe, Refine, Stroke, Volume},
    scene::{Meshes, SceneError},
};

/// A stroke as the log tells of it.
#[derive(Debug, Clone)]
pub(super) struct LoggedStroke {
    pub(super) tool: Arc<SessionTool>,
    pub(super) keys: Vec<Key>,
    /// The whole change of the volume.
    pub(super) volume_change: Option<f64>,
    /// The same of what the host sees: what the lock has left.
    pub(super) shown_change: f64,
}

/// Why a recipe could not be carried out in a session.
#[derive(Debug, thiserror::Error)]
pub enum SessionReplayError {
    /// A tool cannot be made, or the recipe is wrong in itself.
    #[error(transparent)]
    Recipe(#[from] SceneError),
    /// Only moves of tools can be strokes of a session.
    #[error("stroke.{index} is of kind `{kind}`, and a session only moves tools")]
    Kind {
        /// Its number, from zero.
        index: usize,
        /// What it is.
        kind: &'static str,
    },
    /// A stroke was refused.
    #[error("stroke.{index}: {source}")]
    Stroke {
        /// Its number, from zero.
        index: usize,
        /// Why.
        source: SessionError,
    },
}

/// A pose as the log writes it: an axis and an angle in degrees.
pub(super) fn key(pose: &field::Pose) -> Key {
    let rotation = if pose.rotation.w < 0.0 { -pose.rotation } else { pose.rotation };
    let axis = DVec3::new(rotation.x, rotation.y, rotation.z);
    let sine = axis.length();
    let at = pose.translation.to_array();
    if sine == 0.0 {
        return Key { at, rotate: [0.0, 0.0, 1.0, 0.0] };
    }
    let angle = 2.0 * libm::atan2(sine, rotation.w);
    let axis = axis / sine;
    Key { at, rotate: [axis.x, axis.y, axis.z, angle.to_degrees()] }
}

impl Session {
    /// All strokes that are done and not undone, as a recipe: what it gives by [`replay`](crate::replay) or
    /// [`replay_points`](crate::replay_points) for vertices of the mesh as opened is what they have here, to the bit, as long as no
    /// lock acts and no step is halved. It asks for the lock if the session has it, so that a replay keeps the volume that the host
    /// saw. Strokes that undo has forgotten are there, too.
    ///
    /// Edits of triangles are not logged: a replay refines by its own rules, and the log fits any other mesh or point set.
    pub fn log(&self) -> Recipe {
        let mut tools: BTreeMap<String, Arc<SessionTool>> = BTreeMap::new();
        let mut strokes = Vec::new();
        for stroke in self.logged() {
            let is_same = |known: &SessionTool| known.description() == stroke.tool.description();
            // Another tool of the same name gets a number.
            let mut name = stroke.tool.name().to_owned();
            let mut number = 2;
            while tools.get(&name).is_some_and(|known| !is_same(known)) {
                name = format!("{} {number}", stroke.tool.name());
                number += 1;
            }
            tools.entry(name.clone()).or_insert_with(|| Arc::clone(&stroke.tool));
            strokes.push(Stroke::Move(Move { tool: name, keys: stroke.keys.clone() }));
        }
        Recipe {
            recipe: 1,
            target: self.options.target.clone(),
            tools: tools.into_iter().map(|(name, tool)| (name, tool.description().clone())).collect(),
            strokes,
            integrate: Integrate { step: self.options.step },
            refine: Refine::default(),
            promise: Default::default(),
            volume: Volume { lock: self.options.lock && self.opened_volume.is_some() },
            mask: self.options.mask.clone(),
            output: Default::default(),
        }
    }

    /// Makes the strokes of `recipe`, all of which must be moves, one after the other as if a host made them: each a stroke that can
    /// be undone. Its target, mask, time step and refinement play no part; those of the session do.
    ///
    /// # Errors
    /// [`SessionReplayError`]. The strokes before the one named were made.
    pub fn replay(
        &mut self,
        recipe: &Recipe,
        meshes: &Meshes,
        options: &StrokeOptions,
        monitor: &dyn Monitor,
    ) -> Result<Vec<StrokeReceipt>, SessionReplayError> {
        recipe.validate().map_err(SceneError::from)?;
        let mut tools: BTreeMap<&str, Arc<SessionTool>> = BTreeMap::new();
        let mut receipts = Vec::new();
        for (index, stroke) in recipe.strokes.iter().enumerate() {
            let Stroke::Move(motion) = stroke else {
                return Err(SessionReplayError::Kind { index, kind: stroke.kind() });
            };
            let name = motion.tool.as_str();
            let tool = match tools.get(name) {
                Some(tool) => Arc::clone(tool),
                None => {
                    let tool = SessionTool::new(name, recipe.tools[name].clone(), meshes, monitor)
                        .map_err(SceneError::from)?;
                    Arc::clone(tools.entry(name).or_insert(Arc::new(tool)))
                }
            };
            let made = self.replay_move(&tool, motion, options, monitor);
            receipts.push(made.map_err(|error| match error {
                Failure::Cancelled(cancelled) => SessionReplayError::Recipe(SceneError::Cancelled(cancelled)),
                Failure::Session(source) => SessionReplayError::Stroke { index, source },
            })?);
        }
        Ok(receipts)
    }

    fn replay_move(
        &mut self,
        tool: &Arc<SessionTool>,
        motion: &Move,
        options: &StrokeOptions,
        monitor: &dyn Monitor,
    ) -> Result<StrokeReceipt, Failure> {
        self.begin_stroke(tool, options.clone())?;
        for (index, key) in motion.keys.iter().enumerate() {
            let done = monitor.check("replay", index as f64 / motion.keys.len() as f64).map_err(Failure::Cancelled);
            // The key itself is logged again, not what a way through poses would make of it.
            let done = done.and_then(|()| self.move_to_key(key.clone(), index as f64).map_err(Failure::Session));
            if let Err(error) = done {
                self.cancel_stroke()?;
                return Err(error);
            }
        }
        Ok(self.end_stroke()?)
    }
}

enum Failure {
    Cancelled(isochore_mesh::Cancelled),
    Session(SessionError),
}

impl From<SessionError> for Failure {
    fn from(error: SessionError) -> Self {
        Self::Session(error)
    }
}
