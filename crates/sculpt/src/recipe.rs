//! The recipe: a target, tools, and the strokes to apply. It is plain data, and the log of a
//! session is a recipe too.

mod defaults;
mod deserialize;
mod error;
mod mask;
mod names;
pub(crate) mod pose;
mod problem;
mod profile;
mod rebase;
mod region;
mod ring;
pub(crate) mod rotation;
mod shape;
mod strip;
mod stroke;
mod suggestion;
mod tagged;
mod transform;
mod tree;
mod validate;

use std::{collections::BTreeMap, path::Path};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use error::{Location, RecipeError};
pub use mask::{Mask, MirrorPlane, Pin, VertexWeights};
pub use pose::{Bone, BoneKey, Pose};
pub use problem::{
    CombinationProblem, GeometryProblem, InvalidRecipe, NoSuchElement, NumberProblem, RecipeProblem, ReferenceProblem,
    SkeletonProblem, StructureProblem, SyntaxProblem,
};
pub use profile::Profile;
pub use rebase::{Rebase, RebaseRule};
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
pub use suggestion::Suggestion;
#[cfg(feature = "io")]
pub(crate) use suggestion::similarity;
pub use transform::Transform;
pub use tree::Override;

use defaults::{is_default, is_true};
use tree::Node;

/// A deformation: the target, the tools and strokes, the accuracy, and the outputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Version of the recipe's format: 1.
    #[schemars(range(min = 1, max = 1))]
    pub recipe: u32,
    /// The mesh to deform.
    pub target: Target,
    /// Tools by name.
    #[serde(default, skip_serializing_if = "is_default")]
    pub tools: BTreeMap<String, Tool>,
    /// Strokes, in the order in which they act.
    #[serde(default, rename = "stroke", skip_serializing_if = "is_default")]
    pub strokes: Vec<Stroke>,
    /// Size of the time steps.
    #[serde(default, skip_serializing_if = "is_default")]
    pub integrate: Integrate,
    /// Criteria for splitting triangles.
    #[serde(default, skip_serializing_if = "is_default")]
    pub refine: Refine,
    /// Properties that the written mesh must have.
    #[serde(default, skip_serializing_if = "is_default")]
    pub promise: Promise,
    /// Final correction of the volume.
    #[serde(default, skip_serializing_if = "is_default")]
    pub volume: Volume,
    /// Parts that stay fixed, and planes of symmetry.
    #[serde(default, skip_serializing_if = "is_default")]
    pub mask: Mask,
    /// Files to write.
    #[serde(default, skip_serializing_if = "is_default")]
    pub output: Output,
}

/// The mesh to deform: a file or a generated shape, with its placement.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Mesh file, relative to the recipe. Either this or `shape`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub mesh: Option<String>,
    /// Generated shape. Either this or `mesh`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub shape: Option<TargetShape>,
    /// Placement in the world.
    #[serde(default, skip_serializing_if = "is_default")]
    pub transform: Transform,
}

/// A solid with a support around it, in which its field fades to zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// Solid that moves.
    pub shape: ToolShape,
    /// Distance from the surface at which the field ends, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub support: f64,
    /// Falloff of the field.
    #[serde(default)]
    pub profile: Profile,
    /// Fraction of the free-form gauge that is added to the vector potential, from 0 to 1. A larger
    /// value makes the flow around an elongated tool slower and shorter, but its grooves sharper,
    /// which takes more triangles.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(range(min = 0, max = 1))]
    pub free_form: f64,
}

/// Size of the time steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Integrate {
    /// Distance that the fastest point of the tool's surface moves in one step, as a fraction of
    /// the support or of half the tool's shortest extent, whichever is less.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub step: f64,
}

impl Default for Integrate {
    fn default() -> Self {
        Self { step: 0.125 }
    }
}

/// Criteria for splitting triangles so that flat facets follow the curved flow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Refine {
    /// False keeps the triangles unchanged.
    pub enabled: bool,
    /// Largest change of the volume before the lock, as a fraction of the volume. By default
    /// refinement ends when the lock would move the surface by a tenth of `deviation` on average,
    /// and the change is below 4e-4.
    #[schemars(extend("exclusiveMinimum" = 0))]
    #[serde(skip_serializing_if = "is_default")]
    pub volume: Option<f64>,
    /// Largest distance of an edge's image from a straight line, as a fraction of the longest side
    /// of the target's bounds.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub deviation: f64,
    /// Longest edge of the deformed mesh, model units; by default 1.5 times the longest edge of the
    /// target.
    #[serde(skip_serializing_if = "is_default")]
    pub max_edge: Option<f64>,
    /// Largest number of triangles, at which refinement ends.
    pub max_triangles: usize,
    /// When the result so far becomes the surface from which the next strokes start: `"never"`,
    /// `"auto"`, or after a number of strokes. Then triangles that nothing needs any more are merged.
    pub rebase: Rebase,
}

/// Properties that the written mesh must have. Promises do not influence the deformation: they are
/// checked at the end. If one does not hold, the exit code is 1, and the output is written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Promise {
    /// Largest relative change of the volume.
    #[serde(skip_serializing_if = "is_default")]
    pub volume: Option<f64>,
    /// Whether triangles of the written mesh must not intersect where the target does not.
    #[serde(skip_serializing_if = "is_true")]
    pub no_new_self_intersections: bool,
    /// Whether all sampled Jacobian determinants of the strokes must be positive.
    #[serde(skip_serializing_if = "is_true")]
    pub positive_jacobian: bool,
    /// Whether the volume lock must displace each vertex by at most half the shortest edge at it.
    #[serde(skip_serializing_if = "is_true")]
    pub lock_within_half_edge: bool,
    /// Whether every stroke must be complete. A stroke ends early if the surface would otherwise
    /// cross itself.
    #[serde(skip_serializing_if = "is_true")]
    pub strokes_completed: bool,
}

impl Default for Promise {
    fn default() -> Self {
        Self {
            volume: None,
            no_new_self_intersections: true,
            positive_jacobian: true,
            lock_within_half_edge: true,
            strokes_completed: true,
        }
    }
}

/// The final correction of the volume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Volume {
    /// Whether to restore the volume exactly, by moving each deformed vertex along its normal in
    /// proportion to its displacement.
    pub lock: bool,
}

impl Default for Volume {
    fn default() -> Self {
        Self { lock: true }
    }
}

/// Files to write. Paths are relative to the recipe.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Deformed mesh; the extension gives the format.
    #[serde(skip_serializing_if = "is_default")]
    pub mesh: Option<String>,
    /// Report, JSON.
    #[serde(skip_serializing_if = "is_default")]
    pub report: Option<String>,
    /// Picture of the target before and after, PNG.
    #[serde(skip_serializing_if = "is_default")]
    pub preview: Option<String>,
    /// Direction from the target to the camera of the preview, of any length; z is up. By default
    /// to the right, to the front and up.
    #[serde(skip_serializing_if = "is_default")]
    pub view: Option<[f64; 3]>,
    /// Deformation as a sequence of meshes.
    #[serde(skip_serializing_if = "is_default")]
    pub frames: Option<Frames>,
}

/// Sequence of meshes with the same triangles, from the target at rest to the finished mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Frames {
    /// Number of meshes, including the first and the last.
    #[schemars(range(min = 2))]
    pub count: u32,
    /// Folder for the meshes, in the format of the output mesh and numbered from zero:
    /// `frame_0000.obj`.
    pub directory: String,
}

/// Text format of a recipe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// TOML 1.
    Toml,
    /// JSON with the same keys.
    Json,
}

impl Format {
    /// JSON if `text` begins with a brace, otherwise TOML.
    ///
    /// ```
    /// use isochore_sculpt::recipe::Format;
    ///
    /// assert_eq!(Format::of_text(" { \"recipe\": 1 }"), Format::Json);
    /// assert_eq!(Format::of_text("recipe = 1"), Format::Toml);
    /// ```
    pub fn of_text(text: &str) -> Self {
        if text.trim_start().starts_with('{') { Self::Json } else { Self::Toml }
    }

    /// The format of the file at `path`: JSON if its extension is `json`.
    ///
    /// ```
    /// use std::path::Path;
    ///
    /// use isochore_sculpt::recipe::Format;
    ///
    /// assert_eq!(Format::of_path(Path::new("press.JSON")), Format::Json);
    /// assert_eq!(Format::of_path(Path::new("press.toml")), Format::Toml);
    /// ```
    pub fn of_path(path: &Path) -> Self {
        let is_json = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        if is_json { Self::Json } else { Self::Toml }
    }
}

impl Recipe {
    /// Parses a recipe, applies `overrides`, and [validates](Self::validate) the result.
    ///
    /// # Errors
    /// The first problem, with its key and its line.
    ///
    /// ```
    /// use isochore_sculpt::recipe::{Format, Recipe};
    ///
    /// let text = "recipe = 1\n[target]\nmish = 'column.obj'";
    /// let error = Recipe::parse(text, Format::Toml, &[]).unwrap_err();
    /// assert_eq!(error.to_string(), "line 3: target.mish: unknown key; did you mean `mesh`?");
    /// ```
    pub fn parse(text: &str, format: Format, overrides: &[Override]) -> Result<Self, RecipeError> {
        let tree = Node::parse(text, format, overrides)?;
        let recipe = Self::deserialize(&tree).map_err(|error| tree.located(error))?;
        recipe.validate().map_err(|error| tree.located(error))?;
        Ok(recipe)
    }

    /// Source location of the key `key` in the text of a recipe, or of the innermost table above it
    /// that the text contains. Unknown if the text or a setting is malformed.
    #[cfg(feature = "io")]
    pub(crate) fn locate(source: crate::Source<'_>, format: Format, key: &str) -> Location {
        let parse = || {
            let overrides: Vec<Override> =
                source.overrides.iter().map(|text| Override::parse(text).ok()).collect::<Option<_>>()?;
            Node::parse(std::str::from_utf8(source.text).ok()?, format, &overrides).ok()
        };
        parse().map_or(Location::Unknown, |tree| tree.locate(key))
    }

    /// The recipe as TOML, from which [`parse`](Self::parse) returns the same recipe.
    ///
    /// ```
    /// use isochore_sculpt::recipe::{Format, Recipe, Stroke, Twist};
    ///
    /// let text = "recipe = 1\ntarget = { mesh = 'column.obj' }";
    /// let mut recipe = Recipe::parse(text, Format::Toml, &[])?;
    /// let twist = Twist { origin: [0.0; 3], axis: [0.0, 0.0, 1.0], degrees_per_unit: 30.0 };
    /// recipe.strokes.push(Stroke::Twist(twist));
    /// recipe.validate()?;
    /// assert_eq!(Recipe::parse(&recipe.to_toml(), Format::Toml, &[])?, recipe);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("a recipe has only strings for keys")
    }

    /// The recipe as JSON, from which [`parse`](Self::parse) returns the same recipe.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a recipe has only strings for keys")
    }
}
