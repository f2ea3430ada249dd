//! The command line as plain data.

use std::{num::NonZeroUsize, path::PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};

/// Deforms triangle meshes and keeps their volume.
///
/// Exit codes: 0 done; 1 a promise of the recipe was missed, outputs are written; 2 bad input, nothing is written; 130
/// interrupted, nothing is written.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(name = "isochore", version, max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,

    /// Threads to compute with [default: all]; the results are the same bits for any number
    #[arg(long, global = true, value_name = "N")]
    pub threads: Option<NonZeroUsize>,

    /// Say nothing but errors and missed promises
    #[arg(long, short, global = true)]
    pub quiet: bool,

    /// Print results on stdout and errors on stderr as JSON, one object each
    #[arg(long, global = true)]
    pub json: bool,
}

/// The subcommands.
#[derive(Debug, Clone, PartialEq, Subcommand)]
pub enum Command {
    /// Deform the target of a recipe
    Run(RunArguments),
    /// Show what a mesh is like
    Inspect(InspectArguments),
    /// Sample the signed distance of a mesh on a grid
    Distance(DistanceArguments),
    /// Compute rotation-minimizing frames of a sampled curve
    Frames(FramesArguments),
    /// Sweep a profile along a curve
    Sweep(SweepArguments),
    /// Press one shape into another, to see what this program does
    Demo(DemoArguments),
    /// Print the JSON schema of recipes or reports
    Schema(SchemaArguments),
}

/// Arguments of `isochore run`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct RunArguments {
    /// Recipe, TOML or (by its extension .json) JSON; paths in it are relative to its folder
    #[arg(value_name = "RECIPE")]
    pub recipe: PathBuf,

    /// Deformed mesh (.obj .gltf .glb .ply .stl .off; of a stream as its input) [default: the recipe's output.mesh]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Report, JSON [default: the recipe's output.report]
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,

    /// Deform the target as bare points, chunk by chunk, so that it need not fit into memory: .ply, whose faces and other
    /// properties are passed through, or an N×3 array .npy; no stamps, refinement or volume lock
    #[arg(long)]
    pub stream: bool,

    /// Setting that wins over the recipe, such as tools.ball.support=0.2 or stroke.0.tool=ball
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub settings: Vec<String>,
}

/// Arguments of `isochore inspect`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct InspectArguments {
    /// Mesh file (.obj .gltf .glb .ply .stl .off)
    #[arg(value_name = "MESH")]
    pub mesh: PathBuf,
}

/// Arguments of `isochore distance`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct DistanceArguments {
    /// Mesh file (.obj .gltf .glb .ply .stl .off); an open one is taken by its winding number
    #[arg(value_name = "MESH")]
    pub mesh: PathBuf,

    /// Cells along the longest side of the mesh, padding not counted
    #[arg(long, value_name = "N")]
    pub resolution: u32,

    /// How far the grid reaches beyond the mesh, model units [default: 2 cells]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pub padding: Option<f64>,

    /// Samples as NumPy array, f32, index [z, y, x]; a .json beside it tells origin, cell, dims and error_bound
    #[arg(long, short, value_name = "GRID.npy")]
    pub output: PathBuf,
}

/// Arguments of `isochore frames`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct FramesArguments {
    /// The curve and its frames
    #[command(flatten)]
    pub spine: SpineArguments,

    /// Frames, one row a sample: x,y,z,rx,ry,rz,sx,sy,sz,tx,ty,tz with 17 significant digits
    #[arg(long, short, value_name = "FRAMES.csv")]
    pub output: PathBuf,
}

/// Arguments of `isochore sweep`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct SweepArguments {
    /// The curve and its frames
    #[command(flatten)]
    pub spine: SpineArguments,

    /// Profile, one point a row, columns along r and s; with --bezier a third column may give weights
    #[arg(long, value_name = "PROFILE.csv")]
    pub profile: PathBuf,

    /// Surface: a mesh (.obj .gltf .glb .ply .stl .off), or exact rational patches of degree 9 along the curve (.json
    /// .step .stp)
    #[arg(long, short, value_name = "SURFACE")]
    pub output: PathBuf,

    /// The last point of the profile is followed by its first
    #[arg(long)]
    pub profile_closed: bool,

    /// The profile's rows are the control points of one Bézier curve
    #[arg(long)]
    pub bezier: bool,

    /// Close the ends of an open curve with the inside of a closed profile
    #[arg(long)]
    pub caps: bool,
}

/// A sampled curve and how frames are carried along it.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct SpineArguments {
    /// Samples, one a row: x,y,z or x,y,z,tx,ty,tz; a header is optional
    #[arg(value_name = "CURVE.csv")]
    pub curve: PathBuf,

    /// How frames are carried [default: double-reflection; ph for exact surfaces]
    #[arg(long, value_enum)]
    pub method: Option<Method>,

    /// Where tangents come from [default: given where there are six columns, else stencil]
    #[arg(long, value_enum)]
    pub tangents: Option<Tangents>,

    /// The last row is followed by the first, of which it is not a copy
    #[arg(long)]
    pub closed: bool,

    /// Reference vector to start from; the part normal to the curve counts [default: the Frenet normal, where there is
    /// one]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    pub r0: Option<[f64; 3]>,

    /// Rotation about the curve: none, minimal (closes a closed curve), or that plus a number of full turns [default:
    /// none; minimal for the sweep of a closed curve]
    #[arg(long, value_name = "none|minimal|TURNS", value_parser = parse_twist, allow_hyphen_values = true)]
    pub twist: Option<Twist>,

    /// What the rotation is proportional to
    #[arg(long, value_enum, default_value = "arc")]
    pub law: Law,

    /// Samples of each curve between two rows, for the methods ph and mobius [default: 1]
    #[arg(long, value_name = "M")]
    pub samples_per_segment: Option<NonZeroUsize>,
}

/// How frames are carried.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Method {
    /// Fourth order; exact on spheres and planes
    #[default]
    DoubleReflection,
    /// Second order, for comparison
    Projection,
    /// Second order, for comparison
    Rotation,
    /// Fourth order from the tangents of evenly spaced samples
    TangentsOnly,
    /// Exact on a Pythagorean-hodograph cubic from row to row
    Ph,
    /// Exact on a rational curve of degree six from row to row
    Mobius,
}

/// Where tangents come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Tangents {
    /// The last three columns
    Given,
    /// Differences over five rows; uneven spacing is recognized
    Stencil,
    /// The circle through three rows
    Circle,
}

/// What a twist is proportional to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Law {
    /// Arc length
    #[default]
    Arc,
    /// Turning of the tangent
    Curvature,
}

/// Rotation about the curve beyond the rotation-minimizing frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Twist {
    /// None.
    None,
    /// The least that closes the frames of a closed curve.
    Minimal,
    /// That and some full turns; on an open curve, the turns alone.
    Turns(i32),
}

fn parse_twist(text: &str) -> Result<Twist, String> {
    match text {
        "none" => Ok(Twist::None),
        "minimal" => Ok(Twist::Minimal),
        turns => turns.parse().map(Twist::Turns).map_err(|_| "neither none, minimal nor a whole number".to_owned()),
    }
}

fn parse_vector(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|number| number.trim().parse().ok().filter(|number: &f64| number.is_finite()))
        .collect::<Option<_>>()
        .ok_or("not three numbers such as 0,0,1")?;
    numbers.try_into().map_err(|_| "not three numbers such as 0,0,1".to_owned())
}

/// Arguments of `isochore demo`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct DemoArguments {
    /// Folder for the meshes, the picture and the report; made if it is missing
    #[arg(long, short, value_name = "DIR", default_value = "isochore-demo")]
    pub output: PathBuf,
}

/// Arguments of `isochore schema`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct SchemaArguments {
    /// Which of the two
    #[arg(value_enum)]
    pub document: Document,
}

/// A kind of document that has a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Document {
    /// What `run` reads
    Recipe,
    /// What `run` writes about it
    Report,
    /// What `run --stream` writes about it
    StreamReport,
}
