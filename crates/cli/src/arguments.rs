//! The command line as plain data: the first of two stages.
//!
//! This module opens and computes nothing. The module of each subcommand turns its arguments into
//! objects and rejects combinations that do not fit.

mod curves;
mod numbers;

use std::{num::NonZeroUsize, path::PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};
use clap_complete::Shell;

pub use curves::{FramesArguments, Law, Method, SpineArguments, SweepArguments, Tangents, Twist};

/// Heading of the options that all subcommands accept.
const GLOBAL: &str = "Global options";

/// Deform triangle meshes and preserve their volume.
///
/// Exit codes: 0 success; 1 a promise of the recipe was missed, outputs are written; 2 invalid
/// input or usage, nothing is written; 130 interrupted, nothing is written.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(name = "isochore", version, max_term_width = 100)]
pub struct Arguments {
    /// Subcommand
    #[command(subcommand)]
    pub command: Command,

    /// Number of threads [default: all cores]; the results are bitwise identical for any number
    #[arg(
        long,
        global = true,
        value_name = "N",
        help_heading = GLOBAL,
        value_parser = numbers::threads,
        allow_negative_numbers = true
    )]
    pub threads: Option<NonZeroUsize>,

    /// Print only errors, warnings and missed promises
    #[arg(long, short, global = true, help_heading = GLOBAL)]
    pub quiet: bool,

    /// Print results on stdout and errors on stderr as JSON, one object each
    #[arg(long, global = true, help_heading = GLOBAL)]
    pub json: bool,
}

/// The subcommands.
#[derive(Debug, Clone, PartialEq, Subcommand)]
pub enum Command {
    /// Deform the target mesh of a recipe
    Run(RunArguments),
    /// Print mesh statistics
    Inspect(InspectArguments),
    /// Sample the signed distance to a mesh on a grid
    Distance(DistanceArguments),
    /// Compute rotation-minimizing frames along a sampled curve
    Frames(FramesArguments),
    /// Sweep a cross-section along a curve
    Sweep(SweepArguments),
    /// Replace the triangles of a mesh by even ones on the same surface
    Remesh(RemeshArguments),
    /// Press one mesh into another as a first example
    Demo(DemoArguments),
    /// Print the JSON schema of recipes or reports
    Schema(SchemaArguments),
    /// Print a completion script for a shell
    Completions(CompletionsArguments),
    /// Print the manual page, or write the pages of all subcommands
    Man(ManArguments),
}

/// Arguments of `isochore run`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct RunArguments {
    /// Recipe in TOML, or in JSON if its extension is .json. The paths in it, such as output.report
    /// and output.preview, are relative to its folder
    #[arg(value_name = "RECIPE", value_hint = ValueHint::FilePath)]
    pub recipe: PathBuf,

    /// Deformed mesh (.obj .gltf .glb .ply .stl .off; with --stream the format of the input),
    /// relative to the current folder [default: output.mesh of the recipe]
    #[arg(long, short, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,

    /// Report in JSON, relative to the current folder [default: output.report of the recipe]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub report: Option<PathBuf>,

    /// Deform the target as a point set, chunk by chunk, so that it need not fit into memory. The
    /// target is a .ply file, whose faces and other properties are copied, or an N×3 array in a
    /// .npy file. Stamps, refinement and the volume lock are not available
    #[arg(long)]
    pub stream: bool,

    /// Override a recipe key; may be repeated, as in --set tools.ball.support=0.2 --set
    /// stroke.0.tool=ball. Paths stay relative to the recipe
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub settings: Vec<String>,
}

/// Arguments of `isochore inspect`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct InspectArguments {
    /// Mesh file (.obj .gltf .glb .ply .stl .off)
    #[arg(value_name = "MESH", value_hint = ValueHint::FilePath)]
    pub mesh: PathBuf,
}

/// Arguments of `isochore distance`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct DistanceArguments {
    /// Mesh file (.obj .gltf .glb .ply .stl .off); the winding number defines the inside of an open
    /// mesh
    #[arg(value_name = "MESH", value_hint = ValueHint::FilePath)]
    pub mesh: PathBuf,

    /// Number of cells along the longest side of the mesh, without padding
    #[arg(long, value_name = "N", value_parser = numbers::cells, allow_negative_numbers = true)]
    pub resolution: u32,

    /// Margin of the grid around the mesh, in model units [default: 2 cells]
    #[arg(long, value_name = "LENGTH", value_parser = numbers::length, allow_negative_numbers = true)]
    pub padding: Option<f64>,

    /// Samples as a NumPy array of f32 with index [z, y, x]; a .json file beside it holds origin,
    /// cell, dims and error_bound
    #[arg(long, short, value_name = "GRID.npy", value_hint = ValueHint::FilePath)]
    pub output: PathBuf,
}

/// Arguments of `isochore remesh`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct RemeshArguments {
    /// Mesh file (.obj .gltf .glb .ply .stl .off); an oriented manifold surface, closed or open
    #[arg(value_name = "MESH", value_hint = ValueHint::FilePath)]
    pub mesh: PathBuf,

    /// Remeshed surface (.obj .gltf .glb .ply .stl .off), with all attributes that the format can
    /// store [default: MESH with -remeshed before the extension]
    #[arg(value_name = "OUTPUT", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,

    /// Length of the edges, in model units [default: as long as the deviation allows]
    #[arg(long, value_name = "LENGTH", value_parser = numbers::positive, allow_negative_numbers = true)]
    pub edge_length: Option<f64>,

    /// Largest distance between the two surfaces, as a fraction of the longest side of MESH
    /// [default: 0.001; with --edge-length a tenth of that length]
    #[arg(long, value_name = "FRACTION", value_parser = numbers::positive, allow_negative_numbers = true)]
    pub deviation: Option<f64>,

    /// Report in JSON: triangles, angles, volume and self-intersections before and after
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub report: Option<PathBuf>,
}

/// Arguments of `isochore demo`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct DemoArguments {
    /// Folder for the meshes, the picture and the report; created if missing
    #[arg(long, short, value_name = "DIR", default_value = "isochore-demo", value_hint = ValueHint::DirPath)]
    pub output: PathBuf,
}

/// Arguments of `isochore schema`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct SchemaArguments {
    /// Document that the schema describes
    #[arg(value_enum)]
    pub document: Document,
}

/// A kind of document that has a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Document {
    /// Input of `run`
    Recipe,
    /// Report of `run`
    Report,
    /// Report of `run --stream`
    StreamReport,
}

/// Arguments of `isochore completions`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct CompletionsArguments {
    /// Shell that reads the script
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Arguments of `isochore man`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct ManArguments {
    /// Write one page per subcommand into this folder instead of printing the main page; created if
    /// missing
    #[arg(long, short, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub output: Option<PathBuf>,
}
