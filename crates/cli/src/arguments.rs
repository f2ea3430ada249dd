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

    /// Deformed mesh (.obj .gltf .glb .ply .stl .off) [default: the recipe's output.mesh]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Report, JSON [default: the recipe's output.report]
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,

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
}
