//! Arguments of the subcommands that read a sampled curve: `frames` and `sweep`.

use std::{num::NonZeroUsize, path::PathBuf};

use clap::{Args, ValueEnum, ValueHint};

use super::numbers;

/// Arguments of `isochore frames`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct FramesArguments {
    /// The curve and its frames
    #[command(flatten)]
    pub spine: SpineArguments,

    /// Frames, one row per sample: x,y,z,rx,ry,rz,sx,sy,sz,tx,ty,tz with 17 significant digits
    #[arg(long, short, value_name = "FRAMES.csv", value_hint = ValueHint::FilePath)]
    pub output: PathBuf,
}

/// Arguments of `isochore sweep`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct SweepArguments {
    /// The curve and its frames
    #[command(flatten)]
    pub spine: SpineArguments,

    /// Cross-section, one point per row, with coordinates along r and s; with --bezier an optional
    /// third column holds weights
    #[arg(long, value_name = "CROSS_SECTION.csv", value_hint = ValueHint::FilePath)]
    pub profile: PathBuf,

    /// Surface: a mesh (.obj .gltf .glb .ply .stl .off), or exact rational patches of degree 9
    /// along the curve (.json .step .stp)
    #[arg(long, short, value_name = "SURFACE", value_hint = ValueHint::FilePath)]
    pub output: PathBuf,

    /// Connect the last point of the cross-section to the first
    #[arg(long)]
    pub profile_closed: bool,

    /// Read the rows of the cross-section as the control points of one Bézier curve
    #[arg(long)]
    pub bezier: bool,

    /// Cap the ends of an open curve; the cross-section must be closed
    #[arg(long)]
    pub caps: bool,
}

/// A sampled curve and options of its frames.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct SpineArguments {
    /// Samples, one per row: x,y,z or x,y,z,tx,ty,tz; a header is optional
    #[arg(value_name = "CURVE.csv", value_hint = ValueHint::FilePath)]
    pub curve: PathBuf,

    /// Method that computes the frames [default: double-reflection; ph for exact surfaces]
    #[arg(long, value_enum)]
    pub method: Option<Method>,

    /// Source of the tangents [default: given if the file has six columns, else stencil]
    #[arg(long, value_enum)]
    pub tangents: Option<Tangents>,

    /// Connect the last row to the first; the last row must not repeat the first
    #[arg(long)]
    pub closed: bool,

    /// Initial reference vector, projected onto the plane normal to the curve [default: the Frenet
    /// normal if it exists]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    pub r0: Option<[f64; 3]>,

    /// Rotation about the curve: none, minimal (closes the frames of a closed curve), or a number
    /// of additional full turns [default: none; minimal when sweeping along a closed curve]
    #[arg(long, value_name = "none|minimal|TURNS", value_parser = parse_twist, allow_hyphen_values = true)]
    pub twist: Option<Twist>,

    /// Quantity that the rotation is proportional to
    #[arg(long, value_enum, default_value = "arc")]
    pub law: Law,

    /// Number of samples between two rows, for the methods ph and mobius [default: 1]
    #[arg(long, value_name = "M", value_parser = numbers::samples, allow_negative_numbers = true)]
    pub samples_per_segment: Option<NonZeroUsize>,
}

/// Method that computes frames.
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
    /// Exact along a Pythagorean-hodograph cubic between two rows
    Ph,
    /// Exact along a rational curve of degree six between two rows
    Mobius,
}

/// Source of the tangents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Tangents {
    /// The last three columns
    Given,
    /// Finite differences over five rows; uneven spacing is detected
    Stencil,
    /// The circle through three rows
    Circle,
}

/// Quantity that a twist is proportional to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Law {
    /// Arc length
    #[default]
    Arc,
    /// Turning angle of the tangent
    Curvature,
}

/// Rotation about the curve relative to the rotation-minimizing frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Twist {
    /// No rotation.
    None,
    /// The smallest rotation that closes the frames of a closed curve.
    Minimal,
    /// The minimal rotation plus a number of full turns; on an open curve, only the turns.
    Turns(i32),
}

fn parse_twist(text: &str) -> Result<Twist, String> {
    match text {
        "none" => Ok(Twist::None),
        "minimal" => Ok(Twist::Minimal),
        turns => {
            turns.parse().map(Twist::Turns).map_err(|_| "give none, minimal or a whole number of turns".to_owned())
        }
    }
}

fn parse_vector(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|number| number.trim().parse().ok().filter(|number: &f64| number.is_finite()))
        .collect::<Option<_>>()
        .ok_or("give three numbers, such as 0,0,1")?;
    numbers.try_into().map_err(|_| "give three numbers, such as 0,0,1".to_owned())
}
