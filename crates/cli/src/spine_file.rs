//! From a file of points to stations with frames: what `frames` and `sweep` have in common.

use glam::DVec3;
use isochore_curve::{
    Frame, FrameError, FrameMethod, HermiteError, MoebiusSpline, PhSpline, Spine, SpineError, TangentError,
    TangentRule, Tilt, TwistLaw, close_frames, closing_angle, rotation_minimizing_frames, spread,
};
use serde::Serialize;

use crate::{
    arguments::{Law, Method, SpineArguments, Tangents, Twist},
    command_error::CommandError,
    csv_table::CsvTable,
};

/// A spine read from a file.
#[derive(Debug)]
pub(crate) struct SpineFile {
    table: CsvTable,
    pub(crate) spine: Spine,
}

/// Frames along a spine, ready to be written or swept.
#[derive(Debug)]
pub(crate) struct Stations {
    /// Points and frames; on a closed spine the first comes again at the end.
    pub(crate) stations: Vec<(DVec3, Frame)>,
    pub(crate) is_closed: bool,
    pub(crate) facts: SpineFacts,
}

/// Measures of a spine.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct SpineFacts {
    /// Angle about the tangent that takes the last untwisted frame of a closed spine to the first, radians.
    closing_angle: Option<f64>,
    /// Length of the polygon through the stations, model units.
    length: f64,
    /// Sum of the angles between neighboring tangents, radians.
    total_curvature: f64,
}

impl SpineFile {
    pub(crate) fn read(arguments: &SpineArguments) -> Result<Self, CommandError> {
        let table = CsvTable::read(&arguments.curve, &[3, 6])?;
        let has_tangents = table.columns() == 6;
        let points = table.rows.iter().map(|row| DVec3::from_slice(&row[..3])).collect();
        let tangents = arguments.tangents.unwrap_or(if has_tangents { Tangents::Given } else { Tangents::Stencil });
        let spine = match tangents {
            Tangents::Given if !has_tangents => {
                return Err(table.error_in_file(
                    "has no tangents: three columns; add tx,ty,tz, or choose --tangents stencil or circle",
                ));
            }
            Tangents::Given => {
                let tangents = table.rows.iter().map(|row| DVec3::from_slice(&row[3..])).collect();
                Spine::new(points, tangents, arguments.closed)
            }
            Tangents::Stencil => Spine::from_points(points, arguments.closed, TangentRule::Automatic),
            Tangents::Circle => Spine::from_points(points, arguments.closed, TangentRule::Circle),
        };
        let spine = spine.map_err(|error| spine_error(&table, error))?;
        Ok(Self { table, spine })
    }

    /// The initial reference vector.
    pub(crate) fn reference(&self, arguments: &SpineArguments) -> DVec3 {
        arguments.r0.map_or_else(|| self.spine.default_reference(), DVec3::from_array)
    }

    /// Carries frames along the spine and twists them; `default_twist` is taken where the command line names none.
    pub(crate) fn stations(&self, arguments: &SpineArguments, default_twist: Twist) -> Result<Stations, CommandError> {
        let reference = self.reference(arguments);
        let method = arguments.method.unwrap_or_default();
        let samples = arguments.samples_per_segment.map(std::num::NonZeroUsize::get);
        if samples.is_some() && !matches!(method, Method::Ph | Method::Mobius) {
            let problem = "--samples-per-segment goes with --method ph or mobius, which make curves between the rows";
            return Err(CommandError::Usage(problem.to_owned()));
        }
        let failed = |error| self.frame_error(error);
        let untwisted = match method {
            Method::Ph => self.ph_spline()?.exact_frames(reference, samples.unwrap_or(1)).map_err(failed)?,
            Method::Mobius => MoebiusSpline::through(&self.spine, Tilt::WhenNeeded)
                .map_err(|error| self.hermite_error(&error))?
                .frames(reference, samples.unwrap_or(1))
                .map_err(failed)?,
            sampled => {
                let method = match sampled {
                    Method::Projection => FrameMethod::Projection,
                    Method::Rotation => FrameMethod::Rotation,
                    Method::TangentsOnly => FrameMethod::TangentsOnly,
                    _ => FrameMethod::DoubleReflection,
                };
                let frames =
                    rotation_minimizing_frames(&self.spine, reference, method, Default::default()).map_err(failed)?;
                (0..).map(|station| self.spine.point(station)).zip(frames.stations).collect()
            }
        };
        self.twist(untwisted, arguments, default_twist)
    }

    /// The spline of Pythagorean-hodograph cubics through the rows.
    pub(crate) fn ph_spline(&self) -> Result<PhSpline, CommandError> {
        PhSpline::through(&self.spine).map_err(|error| self.hermite_error(&error))
    }

    fn twist(
        &self,
        untwisted: Vec<(DVec3, Frame)>,
        arguments: &SpineArguments,
        default_twist: Twist,
    ) -> Result<Stations, CommandError> {
        let is_closed = self.spine.is_closed();
        let (points, mut frames): (Vec<DVec3>, Vec<Frame>) = untwisted.into_iter().unzip();
        // The stations as an open spine: a closed one has its first point at both ends here.
        let tangents = frames.iter().map(|frame| frame.t).collect();
        let spine = Spine::new(points.clone(), tangents, false).map_err(|error| spine_error(&self.table, error))?;
        let facts = SpineFacts {
            closing_angle: is_closed.then(|| closing_angle(&frames)),
            length: spine.chords().iter().sum(),
            total_curvature: spine.turning_angles().iter().sum(),
        };
        let law = match arguments.law {
            Law::Arc => TwistLaw::ArcLength,
            Law::Curvature => TwistLaw::Curvature,
        };
        frames = match arguments.twist.unwrap_or(default_twist) {
            Twist::None => frames,
            Twist::Minimal if !is_closed => {
                let problem = "--twist minimal closes the frames of a closed curve; add --closed, or give turns";
                return Err(CommandError::Usage(problem.to_owned()));
            }
            Twist::Minimal => close_frames(&spine, &frames, law, 0).stations,
            Twist::Turns(turns) if is_closed => close_frames(&spine, &frames, law, turns).stations,
            Twist::Turns(turns) => spread(&spine, &frames, std::f64::consts::TAU * f64::from(turns), law).stations,
        };
        Ok(Stations { stations: points.into_iter().zip(frames).collect(), is_closed, facts })
    }

    fn frame_error(&self, error: FrameError) -> CommandError {
        match error {
            FrameError::Reference => CommandError::Usage(format!("--r0: {error}")),
            FrameError::DegenerateSegment { segment } => self.table.error_between(
                segment,
                self.next(segment),
                "the tangents there are reversed, the curve has a cusp, or the rows are too far apart",
            ),
            FrameError::OppositeTangents { segment } => {
                self.table.error_between(segment, self.next(segment), "the tangents there are opposite")
            }
        }
    }

    pub(crate) fn hermite_error(&self, error: &HermiteError) -> CommandError {
        let problem = format!("{}; more rows may help", error.reason);
        self.table.error_between(error.segment, self.next(error.segment), problem)
    }

    fn next(&self, segment: usize) -> usize {
        (segment + 1) % self.table.rows.len()
    }
}

/// The same error with rows of the file for indices.
fn spine_error(table: &CsvTable, error: SpineError) -> CommandError {
    match error {
        SpineError::TooFewPoints { .. } | SpineError::TangentCount { .. } => table.error_in_file(error),
        SpineError::PointNotFinite { index } => table.error(index, "a coordinate is too large"),
        SpineError::TangentNotFinite { index } => table.error(index, "a tangent is too large"),
        SpineError::ZeroTangent { index } => table.error(index, "the tangent is zero"),
        SpineError::ClosingPointRepeated { index } => {
            table.error(index, "repeats the first point; with --closed leave it out, the curve returns by itself")
        }
        SpineError::NotClosed { gap, longest } => table.error_in_file(format!(
            "--closed: the last and first row are {gap} apart, other neighbors at most {longest}; these rows are open"
        )),
        SpineError::Tangent(TangentError::RepeatedPoint { index, next }) => {
            table.error_between(index, next, "the points coincide; remove one, or give tangents")
        }
        SpineError::Tangent(TangentError::Undetermined { index }) => {
            table.error(index, "the points around it determine no tangent: a cusp, or rows too far apart")
        }
        SpineError::Tangent(TangentError::Parameter { .. }) => table.error_in_file(error),
    }
}
