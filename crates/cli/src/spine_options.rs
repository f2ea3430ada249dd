//! Options of a spine and its frames, checked: the second stage of parsing `frames` and `sweep`.

use std::{f64::consts::TAU, path::PathBuf};

use glam::DVec3;
use isochore_curve::{FrameMethod, TwistLaw};

use crate::{
    arguments::{Law, Method, SpineArguments, Tangents, Twist},
    command_error::CommandError,
};

/// A consistent set of options, made from [`SpineArguments`] without reading a file.
#[derive(Debug, Clone)]
pub(crate) struct SpineOptions {
    pub(crate) curve: PathBuf,
    pub(crate) is_closed: bool,
    pub(crate) tangents: TangentSource,
    /// Initial reference vector; `None` selects the default of the curve.
    pub(crate) reference: Option<DVec3>,
    pub(crate) frames: FrameOptions,
    pub(crate) rotation: Rotation,
    pub(crate) law: TwistLaw,
}

/// Source of the tangents at the rows.
#[derive(Debug, Clone, Copy)]
pub(crate) enum TangentSource {
    /// The last three columns.
    Columns,
    /// Finite differences over five rows.
    Stencil,
    /// The circle through three rows.
    Circle,
    /// The last three columns if the file has six, else finite differences.
    Automatic,
}

/// Method that computes frames, with the number of samples between two rows if it defines a curve
/// there.
#[derive(Debug, Clone, Copy)]
pub(crate) enum FrameOptions {
    Sampled(FrameMethod),
    Ph { samples: usize },
    Moebius { samples: usize },
}

/// Rotation about the tangent relative to the rotation-minimizing frame.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Rotation {
    None,
    /// The minimal angle that closes a closed spine plus a number of full turns.
    Closing {
        turns: i32,
    },
    /// A total angle along an open spine, radians.
    Spread {
        angle: f64,
    },
}

impl SpineOptions {
    /// Checks `arguments`. `default_twist` applies if the command line has no `--twist`.
    ///
    /// # Errors
    /// `--samples-per-segment` with a method that defines no curve between rows, or `--twist
    /// minimal` for an open curve.
    pub(crate) fn new(arguments: &SpineArguments, default_twist: Twist) -> Result<Self, CommandError> {
        Ok(Self {
            curve: arguments.curve.clone(),
            is_closed: arguments.closed,
            tangents: tangent_source(arguments.tangents),
            reference: arguments.r0.map(DVec3::from_array),
            frames: frame_options(arguments)?,
            rotation: rotation(arguments.twist.unwrap_or(default_twist), arguments.closed)?,
            law: match arguments.law {
                Law::Arc => TwistLaw::ArcLength,
                Law::Curvature => TwistLaw::Curvature,
            },
        })
    }
}

fn tangent_source(tangents: Option<Tangents>) -> TangentSource {
    match tangents {
        None => TangentSource::Automatic,
        Some(Tangents::Given) => TangentSource::Columns,
        Some(Tangents::Stencil) => TangentSource::Stencil,
        Some(Tangents::Circle) => TangentSource::Circle,
    }
}

fn frame_options(arguments: &SpineArguments) -> Result<FrameOptions, CommandError> {
    let samples = arguments.samples_per_segment.map_or(1, usize::from);
    let method = match arguments.method.unwrap_or_default() {
        Method::Ph => return Ok(FrameOptions::Ph { samples }),
        Method::Mobius => return Ok(FrameOptions::Moebius { samples }),
        Method::DoubleReflection => FrameMethod::DoubleReflection,
        Method::Projection => FrameMethod::Projection,
        Method::Rotation => FrameMethod::Rotation,
        Method::TangentsOnly => FrameMethod::TangentsOnly,
    };
    if arguments.samples_per_segment.is_some() {
        let problem = "--samples-per-segment needs --method ph or mobius, which define a curve between the rows";
        return Err(CommandError::Usage(problem.to_owned()));
    }
    Ok(FrameOptions::Sampled(method))
}

fn rotation(twist: Twist, is_closed: bool) -> Result<Rotation, CommandError> {
    match twist {
        Twist::None => Ok(Rotation::None),
        Twist::Minimal if is_closed => Ok(Rotation::Closing { turns: 0 }),
        Twist::Minimal => {
            let problem = "--twist minimal closes the frames of a closed curve; add --closed, or use --twist TURNS";
            Err(CommandError::Usage(problem.to_owned()))
        }
        Twist::Turns(turns) if is_closed => Ok(Rotation::Closing { turns }),
        Twist::Turns(turns) => Ok(Rotation::Spread { angle: TAU * f64::from(turns) }),
    }
}
