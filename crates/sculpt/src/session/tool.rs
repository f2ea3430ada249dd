//! Named tools of a session and their entries in the log.

use std::sync::Arc;

use isochore_field as field;
use isochore_mesh::Monitor;

use super::HostToolError;
use crate::{
    recipe::{self, HostShape, ToolShape},
    scene::{BuildToolError, Meshes, build_tool},
};

/// A tool ready for strokes, with its name and its entry in the log. Build it once and share it
/// between strokes and sessions.
///
/// [`new`](Self::new) builds a tool from its description in a recipe:
///
/// ```
/// use isochore_mesh::NoProgress;
/// use isochore_sculpt::{Meshes, recipe, session::SessionTool};
///
/// let shape = recipe::ToolShape::Sphere(recipe::Sphere { radius: 0.2 });
/// let brush = recipe::Tool { shape, support: 0.3, profile: recipe::Profile::Quintic, free_form: 0.0 };
/// let brush = SessionTool::new("brush", brush, &Meshes::new(), &NoProgress)?;
/// assert_eq!(brush.name(), "brush");
/// assert_eq!(brush.tool().support(), 0.3);
/// # Ok::<(), isochore_sculpt::BuildToolError>(())
/// ```
///
/// [`from_tool`](Self::from_tool) accepts any [`field::Tool`], and so any
/// [`Distance`](isochore_mesh::Distance) of the host.
#[derive(Debug, Clone)]
pub struct SessionTool {
    name: String,
    description: recipe::Tool,
    tool: Arc<field::Tool>,
    warnings: Vec<String>,
}

impl SessionTool {
    /// Builds the tool that a recipe describes. If its shape is a mesh, `meshes` must contain that
    /// mesh, and sampling its distance on a grid takes from milliseconds to seconds.
    ///
    /// # Errors
    /// [`BuildToolError`], with the key as in a recipe that names the tool `name`.
    pub fn new(
        name: &str,
        description: recipe::Tool,
        meshes: &Meshes,
        monitor: &dyn Monitor,
    ) -> Result<Self, BuildToolError> {
        let (tool, warnings) = build_tool(name, &description, meshes, monitor)?;
        Ok(Self { name: name.to_owned(), description, tool: Arc::new(tool), warnings })
    }

    /// Names a tool that the host has built itself, for example from its own
    /// [`Distance`](isochore_mesh::Distance).
    ///
    /// The log names the tool and records its support, but a recipe cannot describe its shape: the
    /// entry's shape is [`ToolShape::Host`]. To replay such a log, the host supplies the tool again
    /// in [`Supplies::tools`](super::Supplies::tools).
    ///
    /// # Errors
    /// [`HostToolError::Unbounded`] if the bounds of the tool's distance are not finite: a session
    /// searches the surface within these bounds.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use glam::DVec3;
    /// use isochore_field::{Pose, Profile, Tool};
    /// use isochore_mesh::{Aabb, Distance, DistanceBlock, LANES, NoProgress, PointBlock, primitives::icosphere};
    /// use isochore_sculpt::session::{Session, SessionOptions, SessionTool, StrokeOptions, Supplies};
    ///
    /// /// A ball of radius 0.2, as the host computes it.
    /// #[derive(Debug)]
    /// struct Ball;
    ///
    /// impl Distance for Ball {
    ///     fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
    ///         for lane in 0..LANES {
    ///             let point = points.get(lane);
    ///             out.value[lane] = point.length() - 0.2;
    ///             out.gradient.set(lane, point.normalize_or_zero());
    ///         }
    ///     }
    ///     fn bounds(&self) -> Aabb {
    ///         Aabb { min: DVec3::splat(-0.2), max: DVec3::splat(0.2) }
    ///     }
    ///     fn centroid(&self) -> DVec3 {
    ///         DVec3::ZERO
    ///     }
    /// }
    ///
    /// let tool = Arc::new(Tool::new(Arc::new(Ball), 0.3, Profile::Quintic)?);
    /// let brush = Arc::new(SessionTool::from_tool("ball", Arc::clone(&tool))?);
    /// let mut session = Session::open(icosphere(1.0, 3), SessionOptions::default())?;
    /// session.begin_stroke(&brush, StrokeOptions::default())?;
    /// session.move_to(&Pose::at(DVec3::Z), 0.0)?;
    /// session.move_to(&Pose::at(1.1 * DVec3::Z), 0.1)?;
    /// assert!(session.end_stroke()?.touched_vertices > 0);
    ///
    /// // A replay needs the tool.
    /// let mut again = Session::open(icosphere(1.0, 3), SessionOptions::default())?;
    /// let mut supplies = Supplies::default();
    /// assert!(again.replay(&session.log(), &supplies, &StrokeOptions::default(), &NoProgress).is_err());
    /// supplies.tools.insert("ball".to_owned(), tool);
    /// again.replay(&session.log(), &supplies, &StrokeOptions::default(), &NoProgress)?;
    /// assert_eq!(again.positions(), session.positions());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_tool(name: &str, tool: impl Into<Arc<field::Tool>>) -> Result<Self, HostToolError> {
        let tool = tool.into();
        // Corners at infinity would become NaN in a rotated pose.
        if !tool.distance().bounds().size().is_finite() {
            return Err(HostToolError::Unbounded { name: name.to_owned() });
        }
        let description = recipe::Tool {
            shape: ToolShape::Host(HostShape {}),
            support: tool.support(),
            profile: profile(tool.profile()),
            free_form: 0.0,
        };
        Ok(Self { name: name.to_owned(), description, tool, warnings: Vec::new() })
    }

    /// Name in the log.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Entry in the log. Its shape is [`ToolShape::Host`] if the host has built the tool.
    pub fn description(&self) -> &recipe::Tool {
        &self.description
    }

    /// The tool itself.
    pub fn tool(&self) -> &Arc<field::Tool> {
        &self.tool
    }

    /// Notes for the user on how the description was interpreted.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Whether one entry of the log can describe both tools.
    pub(super) fn has_same_entry(&self, other: &Self) -> bool {
        let is_host = matches!(self.description.shape, ToolShape::Host(_));
        self.description == other.description && (!is_host || Arc::ptr_eq(&self.tool, &other.tool))
    }
}

/// The recipe's name of a profile. A recipe has no squared profiles: those are recorded as the
/// profile that is squared.
fn profile(profile: field::Profile) -> recipe::Profile {
    match profile {
        field::Profile::Quintic | field::Profile::QuinticSquared => recipe::Profile::Quintic,
        field::Profile::Septic | field::Profile::SepticSquared => recipe::Profile::Septic,
        field::Profile::Quartic | field::Profile::QuarticSquared => recipe::Profile::Quartic,
        field::Profile::Contact | field::Profile::ContactSquared => recipe::Profile::Contact,
        field::Profile::Thesis => recipe::Profile::Thesis,
    }
}
