//! The recipe, which is also the log of a session: a target, tools, and the strokes made with them.

mod deserialize;
mod error;
mod mask;
mod names;
pub(crate) mod pose;
mod region;
mod ring;
pub(crate) mod rotation;
mod shape;
mod strip;
mod stroke;
mod tagged;
mod tree;
mod validate;

use std::{collections::BTreeMap, fmt};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use error::{Location, RecipeError, RecipeProblem};
pub use mask::{Mask, MirrorPlane, Pin, VertexWeights};
pub use pose::{Bone, BoneKey, Pose};
pub use region::{
    CapsuleRegion, HalfSpaceRegion, InnerRegion, Region, RegionMotion, RegionTurn, SphereRegion, ToolRegion,
};
pub use ring::Ring;
pub use shape::{
    BoxMesh, Capsule, Ellipsoid, HostShape, Icosphere, MeshTool, RoundedBox, Sphere, SphereMesh, TargetShape,
    ToolShape, Torus,
};
pub use strip::{Radius, SpinePoints, Strip, StripMode};
pub use stroke::{Bend, Key, Move, Stamp, Stroke, Twist};
pub use tree::Override;

use rotation::no_rotation;
use tree::Node;

/// What to deform, with which tools and strokes, how closely, and where to put the results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Version of the recipe's format: 1.
    #[schemars(range(min = 1, max = 1))]
    pub recipe: u32,
    /// What is deformed.
    pub target: Target,
    /// The tools by name.
    #[serde(default, skip_serializing_if = "is_default")]
    pub tools: BTreeMap<String, Tool>,
    /// The strokes in the order in which they are made.
    #[serde(default, rename = "stroke", skip_serializing_if = "is_default")]
    pub strokes: Vec<Stroke>,
    /// Size of the time steps.
    #[serde(default, skip_serializing_if = "is_default")]
    pub integrate: Integrate,
    /// Where triangles are split.
    #[serde(default, skip_serializing_if = "is_default")]
    pub refine: Refine,
    /// What the written mesh is held to.
    #[serde(default, skip_serializing_if = "is_default")]
    pub promise: Promise,
    /// The final correction of the volume.
    #[serde(default, skip_serializing_if = "is_default")]
    pub volume: Volume,
    /// What holds the strokes back.
    #[serde(default, skip_serializing_if = "is_default")]
    pub mask: Mask,
    /// Where the results go.
    #[serde(default, skip_serializing_if = "is_default")]
    pub output: Output,
}

/// What is deformed: a mesh or a shape, and where it stands.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Mesh file, relative to the recipe. Either this or `shape`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub mesh: Option<String>,
    /// A shape made here. Either this or `mesh`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub shape: Option<TargetShape>,
    /// Placement in the world.
    #[serde(default, skip_serializing_if = "is_default")]
    pub transform: Transform,
}

/// A similarity: scaled, then rotated, then translated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Transform {
    /// Factor, above zero.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
    /// Axis x, y, z and angle in degrees, right-handed.
    pub rotate: [f64; 4],
    /// Displacement, model units.
    pub translate: [f64; 3],
}

impl Default for Transform {
    fn default() -> Self {
        Self { scale: 1.0, rotate: no_rotation(), translate: [0.0; 3] }
    }
}

/// A shape with a support around it, in which its field fades to nothing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// The solid that moves.
    pub shape: ToolShape,
    /// How far beyond the surface the field reaches, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub support: f64,
    /// How the field fades.
    #[serde(default)]
    pub profile: Profile,
    /// How much of the free-form gauge is added to the vector potential, from 0 to 1. More makes the flow around an elongated tool
    /// slower and its way shorter, but its grooves sharper, which takes more triangles.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(range(min = 0, max = 1))]
    pub free_form: f64,
}

/// How a tool's field falls from one on the surface to zero where the support ends.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    /// Twice continuously differentiable; the inside of the tool moves rigidly.
    #[default]
    Quintic,
    /// Three times continuously differentiable; the inside of the tool moves rigidly.
    Septic,
    /// The polynomial of von Funck's region fields; the inside of the tool moves rigidly.
    Quartic,
    /// Steep at the surface, so that material comes close to the tool; goes on into the tool without a kink.
    Contact,
    /// The quadratic of the 2008 thesis, with a kink at the surface.
    Thesis,
}

impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// Size of the time steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Integrate {
    /// Travel of the fastest point of the tool's surface in one step, as a fraction of the support or of half the tool's
    /// shortest extent, whichever is less.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub step: f64,
}

impl Default for Integrate {
    fn default() -> Self {
        Self { step: 0.125 }
    }
}

/// Where triangles are split so that flat facets follow the curved flow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Refine {
    /// False leaves the triangles as they are.
    pub enabled: bool,
    /// Refines until the estimated error of the volume is below this share of the volume.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub volume: f64,
    /// Farthest that an edge's image may lie from a straight line, as a fraction of the longest side of the target's bounds.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub deviation: f64,
    /// Longest edge of the deformed mesh, model units; without it, 1.5 times the longest edge of the target.
    #[serde(skip_serializing_if = "is_default")]
    pub max_edge: Option<f64>,
    /// Refinement ends at this many triangles.
    pub max_triangles: usize,
}

/// What the written mesh is held to. Promises steer nothing: they are judged at the end.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Promise {
    /// Largest relative change of the volume.
    #[serde(skip_serializing_if = "is_default")]
    pub volume: Option<f64>,
    /// True: the written mesh has no more self-intersecting triangles than the target.
    #[serde(skip_serializing_if = "is_default")]
    pub no_new_self_intersections: bool,
}

/// The final correction of the volume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Volume {
    /// Moves the deformed vertices by the least that restores the volume exactly.
    pub lock: bool,
}

impl Default for Volume {
    fn default() -> Self {
        Self { lock: true }
    }
}

/// Where the results go. Paths are relative to the recipe.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// The deformed mesh; the extension tells the format.
    #[serde(skip_serializing_if = "is_default")]
    pub mesh: Option<String>,
    /// The report, JSON.
    #[serde(skip_serializing_if = "is_default")]
    pub report: Option<String>,
    /// A picture of the target before and after, PNG.
    #[serde(skip_serializing_if = "is_default")]
    pub preview: Option<String>,
    /// Direction from the target to the eye of the preview, of any length; z is up. By default from the right, in front and above.
    #[serde(skip_serializing_if = "is_default")]
    pub view: Option<[f64; 3]>,
    /// The deformation as a sequence of meshes.
    #[serde(skip_serializing_if = "is_default")]
    pub frames: Option<Frames>,
}

/// A sequence of meshes with the same triangles, from the target at rest to the finished mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Frames {
    /// How many, the first and the last included.
    #[schemars(range(min = 2))]
    pub count: u32,
    /// Folder that takes them, in the format of the output mesh and numbered from zero: `frame_0000.obj`.
    pub directory: String,
}

/// How the text of a recipe is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// TOML 1.
    Toml,
    /// JSON with the same keys.
    Json,
}

impl Format {
    /// JSON where `text` begins with a brace, TOML otherwise.
    pub fn of_text(text: &str) -> Self {
        if text.trim_start().starts_with('{') { Self::Json } else { Self::Toml }
    }
}

impl Recipe {
    /// Reads a recipe, lets `overrides` win over what it says, and [validates](Self::validate) it.
    ///
    /// # Errors
    /// The first thing found to be wrong, with its line.
    pub fn parse(text: &str, format: Format, overrides: &[Override]) -> Result<Self, RecipeError> {
        let mut tree = match format {
            Format::Toml => Node::from_toml(text)?,
            Format::Json => Node::from_json(text)?,
        };
        for setting in overrides {
            tree.apply(setting)?;
        }
        let recipe = Self::deserialize(&tree).and_then(|recipe| recipe.validate().map(|()| recipe));
        recipe.map_err(|error| {
            let location = tree.locate(&error.key);
            error.at(location)
        })
    }

    /// The recipe as TOML. [`parse`](Self::parse) gives back the same recipe.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("a recipe has only strings for keys")
    }

    /// The recipe as JSON. [`parse`](Self::parse) gives back the same recipe.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a recipe has only strings for keys")
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
