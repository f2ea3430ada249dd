//! The log of a session, which is a recipe, and its replay in a session.

use std::{collections::BTreeMap, sync::Arc};

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{Cancelled, Monitor};

use super::{HostToolError, Session, SessionError, SessionTool, StrokeOptions, StrokeReceipt, Supplies};
use crate::{
    recipe::{Integrate, Key, Move, Recipe, Refine, Stroke, ToolShape, Volume},
    scene::SceneError,
};

/// A stroke as recorded in the log.
#[derive(Debug, Clone)]
pub(super) struct LoggedStroke {
    pub(super) tool: Arc<SessionTool>,
    pub(super) keys: Vec<Key>,
    /// Total change of the volume before any lock.
    pub(super) volume_change: Option<f64>,
    /// Change of the shown volume: what remains after the lock.
    pub(super) shown_change: f64,
    /// Number of new crossings that it left.
    pub(super) crossings: usize,
}

/// Errors of [`Session::replay`].
#[derive(Debug, thiserror::Error)]
pub enum SessionReplayError {
    /// The recipe is invalid, or a tool cannot be built.
    #[error(transparent)]
    Recipe(#[from] SceneError),
    /// The recipe names a tool of the host that was not supplied.
    #[error("tools.{name}.shape: is a shape of the host, which a recipe does not contain; supply the tool `{name}`")]
    MissingTool {
        /// Name of the tool in the recipe.
        name: String,
    },
    /// A tool that the host supplied is not usable in a session.
    #[error(transparent)]
    HostTool(#[from] HostToolError),
    /// The stroke is not a move of a tool.
    #[error("stroke.{index} is of kind `{kind}`; a session replays only strokes of kind `move`")]
    Kind {
        /// Index of the stroke, from zero.
        index: usize,
        /// Kind of the stroke.
        kind: &'static str,
    },
    /// The session rejected a stroke.
    #[error("stroke.{index}: {source}")]
    Stroke {
        /// Index of the stroke, from zero.
        index: usize,
        /// Reason.
        source: SessionError,
    },
}

/// The key that replays as `pose`: axis and angle in degrees of its rotation.
///
/// A key does not represent every quaternion exactly. [`Session::move_to`] therefore moves the tool
/// to the pose of this key.
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
    /// All strokes that are done and not undone, as a recipe. Strokes that undo has forgotten are
    /// included.
    ///
    /// Keys are recorded exactly as they were given to [`move_to_key`](Self::move_to_key). A
    /// [replay](crate::replay()), also of [points](crate::replay_points), moves the vertices of the
    /// mesh as opened to the same bits as [`positions`](Self::positions), provided that no lock
    /// acts and no time step is halved. The recipe enables the lock if the session has one, so that
    /// a replay keeps the volume that the host has seen.
    ///
    /// Edits of triangles are not logged: a replay refines by its own rules. The log can be applied
    /// to any mesh or point set.
    ///
    /// The shape of a tool [of the host](SessionTool::from_tool) is recorded as
    /// [`ToolShape::Host`]. Such a log needs the tool again, and can be replayed only [in a
    /// session](Self::replay).
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use isochore_mesh::{NoProgress, primitives::icosphere};
    /// # use isochore_sculpt::{Meshes, recipe::{self, Key}, session::{Session, SessionOptions, SessionTool, StrokeOptions}};
    /// # let shape = recipe::ToolShape::Sphere(recipe::Sphere { radius: 0.2 });
    /// # let brush = recipe::Tool { shape, support: 0.3, profile: recipe::Profile::Quintic, free_form: 0.0 };
    /// # let brush = Arc::new(SessionTool::new("brush", brush, &Meshes::new(), &NoProgress)?);
    /// let mut session = Session::open(icosphere(1.0, 3), SessionOptions::default())?;
    /// session.begin_stroke(&brush, StrokeOptions::default())?;
    /// session.move_to_key(&Key { at: [0.0, 0.0, 1.0], rotate: [0.0, 0.0, 1.0, 0.0] }, 0.0)?;
    /// session.move_to_key(&Key { at: [0.0, 0.0, 1.1], rotate: [0.0, 0.0, 1.0, 30.0] }, 0.1)?;
    /// session.end_stroke()?;
    /// let log = session.log();
    /// assert_eq!(log.strokes.len(), 1);
    /// assert!(log.to_toml().contains("30.0"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn log(&self) -> Recipe {
        let mut tools: BTreeMap<String, Arc<SessionTool>> = BTreeMap::new();
        let mut strokes = Vec::new();
        for stroke in self.logged() {
            // A different tool of the same name gets a number.
            let mut name = stroke.tool.name().to_owned();
            let mut number = 2;
            while tools.get(&name).is_some_and(|known| !known.has_same_entry(&stroke.tool)) {
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

    /// Performs the strokes of `recipe`, all of which must be moves. Each becomes a stroke that can
    /// be undone. The target, mask, time step and refinement of the recipe are ignored; the
    /// session's own are used. Tools whose shape is [`ToolShape::Host`] come from
    /// [`supplies`](Supplies::tools).
    ///
    /// # Errors
    /// [`SessionReplayError`]. The strokes before the failing one have been performed.
    pub fn replay(
        &mut self,
        recipe: &Recipe,
        supplies: &Supplies,
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
                    let tool = tool_of(recipe, name, supplies, monitor)?;
                    Arc::clone(tools.entry(name).or_insert(Arc::new(tool)))
                }
            };
            let receipt = self.replay_move(&tool, motion, options, monitor);
            receipts.push(receipt.map_err(|error| match error {
                MoveFailure::Cancelled(cancelled) => SessionReplayError::Recipe(SceneError::Cancelled(cancelled)),
                MoveFailure::Session(source) => SessionReplayError::Stroke { index, source },
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
    ) -> Result<StrokeReceipt, MoveFailure> {
        self.begin_stroke(tool, options.clone())?;
        for (index, key) in motion.keys.iter().enumerate() {
            let moved =
                monitor.check("replay", index as f64 / motion.keys.len() as f64).map_err(MoveFailure::Cancelled);
            let moved = moved.and_then(|()| self.move_to_key(key, index as f64).map_err(MoveFailure::Session));
            if let Err(error) = moved {
                self.cancel_stroke()?;
                return Err(error);
            }
        }
        Ok(self.end_stroke()?)
    }
}

/// The tool `name` of a valid recipe: supplied by the host, or built from its description.
fn tool_of(
    recipe: &Recipe,
    name: &str,
    supplies: &Supplies,
    monitor: &dyn Monitor,
) -> Result<SessionTool, SessionReplayError> {
    let description = &recipe.tools[name];
    if !matches!(description.shape, ToolShape::Host(_)) {
        let tool = SessionTool::new(name, description.clone(), &supplies.meshes, monitor);
        return Ok(tool.map_err(SceneError::from)?);
    }
    let tool = supplies.tools.get(name).ok_or_else(|| SessionReplayError::MissingTool { name: name.to_owned() })?;
    Ok(SessionTool::from_tool(name, Arc::clone(tool))?)
}

/// Reason why a replayed move was abandoned.
enum MoveFailure {
    Cancelled(Cancelled),
    Session(SessionError),
}

impl From<SessionError> for MoveFailure {
    fn from(error: SessionError) -> Self {
        Self::Session(error)
    }
}
