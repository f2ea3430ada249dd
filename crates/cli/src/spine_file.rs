//! A spine read from a file, and its stations with frames, for `frames` and `sweep`.

use glam::DVec3;
use isochore_curve::{
    Frame, FrameError, HermiteError, MoebiusSpline, PhSpline, Spine, SpineError, TangentError, TangentRule, Tilt,
    close_frames, closing_angle, rotation_minimizing_frames, spread,
};
use isochore_sculpt::files::{CsvError, CsvTable};
use serde::Serialize;

use crate::{
    command_error::CommandError,
    spine_options::{FrameOptions, Rotation, SpineOptions, TangentSource},
};

/// A spine and the table that it was read from, which errors refer to.
#[derive(Debug)]
pub(crate) struct SpineFile {
    table: CsvTable,
    pub(crate) spine: Spine,
}

/// Points and frames along a spine.
#[derive(Debug)]
pub(crate) struct Stations {
    /// Points and frames. A closed spine repeats the first point at the end.
    pub(crate) stations: Vec<(DVec3, Frame)>,
    pub(crate) is_closed: bool,
    pub(crate) facts: SpineFacts,
}

/// Measures of a spine.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct SpineFacts {
    /// Angle about the tangent from the last to the first untwisted frame of a closed spine,
    /// radians.
    closing_angle: Option<f64>,
    /// Length of the polygon through the stations, model units.
    length: f64,
    /// Sum of the angles between neighboring tangents, radians.
    total_curvature: f64,
}

impl SpineFile {
    /// Reads the curve and determines its tangents.
    ///
    /// # Errors
    /// The file is not a table of three or six columns, it lacks the requested tangents, or its
    /// rows do not form a spine. The error names the rows.
    pub(crate) fn read(options: &SpineOptions) -> Result<Self, CommandError> {
        let table = CsvTable::read(&options.curve, &[3, 6])?;
        let has_tangents = table.columns() == 6;
        let points = table.rows().iter().map(|row| DVec3::from_slice(&row[..3])).collect();
        let rule = match options.tangents {
            TangentSource::Circle => Some(TangentRule::Circle),
            TangentSource::Stencil => Some(TangentRule::Automatic),
            TangentSource::Automatic if !has_tangents => Some(TangentRule::Automatic),
            TangentSource::Columns if !has_tangents => {
                let problem =
                    "the file has three columns and no tangents; add tx,ty,tz, or use --tangents stencil or circle";
                return Err(table.error_in_file(problem).into());
            }
            TangentSource::Automatic | TangentSource::Columns => None,
        };
        let spine = match rule {
            Some(rule) => Spine::from_points(points, options.is_closed, rule),
            None => {
                let tangents = table.rows().iter().map(|row| DVec3::from_slice(&row[3..])).collect();
                Spine::new(points, tangents, options.is_closed)
            }
        };
        let spine = spine.map_err(|error| spine_error(&table, error))?;
        Ok(Self { table, spine })
    }

    /// Initial reference vector.
    pub(crate) fn reference(&self, options: &SpineOptions) -> DVec3 {
        options.reference.unwrap_or_else(|| self.spine.default_reference())
    }

    /// Computes frames along the spine and twists them.
    ///
    /// # Errors
    /// The reference vector is parallel to the first tangent, or a segment has no frames or no
    /// curve of the chosen method. The error names the rows of the segment.
    pub(crate) fn stations(&self, options: &SpineOptions) -> Result<Stations, CommandError> {
        let reference = self.reference(options);
        let failed = |error| self.frame_error(error);
        let untwisted = match options.frames {
            FrameOptions::Ph { samples } => self.ph_spline()?.exact_frames(reference, samples).map_err(failed)?,
            FrameOptions::Moebius { samples } => MoebiusSpline::through(&self.spine, Tilt::WhenNeeded)
                .map_err(|error| self.hermite_error(&error))?
                .frames(reference, samples)
                .map_err(failed)?,
            FrameOptions::Sampled(method) => {
                let frames =
                    rotation_minimizing_frames(&self.spine, reference, method, Default::default()).map_err(failed)?;
                (0..).map(|station| self.spine.point(station)).zip(frames.stations).collect()
            }
        };
        self.twist(untwisted, options)
    }

    /// The spline of Pythagorean-hodograph cubics through the rows.
    pub(crate) fn ph_spline(&self) -> Result<PhSpline, CommandError> {
        PhSpline::through(&self.spine).map_err(|error| self.hermite_error(&error))
    }

    fn twist(&self, untwisted: Vec<(DVec3, Frame)>, options: &SpineOptions) -> Result<Stations, CommandError> {
        let is_closed = self.spine.is_closed();
        let (points, mut frames): (Vec<DVec3>, Vec<Frame>) = untwisted.into_iter().unzip();
        // An open spine through all stations, because the stations of a closed one repeat the first
        // point.
        let tangents = frames.iter().map(|frame| frame.t).collect();
        let spine = Spine::new(points.clone(), tangents, false).map_err(|error| spine_error(&self.table, error))?;
        let facts = SpineFacts {
            closing_angle: is_closed.then(|| closing_angle(&frames)),
            length: spine.chords().iter().sum(),
            total_curvature: spine.turning_angles().iter().sum(),
        };
        frames = match options.rotation {
            Rotation::None => frames,
            Rotation::Closing { turns } => close_frames(&spine, &frames, options.law, turns).stations,
            Rotation::Spread { angle } => spread(&spine, &frames, angle, options.law).stations,
        };
        Ok(Stations { stations: points.into_iter().zip(frames).collect(), is_closed, facts })
    }

    fn frame_error(&self, error: FrameError) -> CommandError {
        match error {
            FrameError::Reference => CommandError::Usage(format!("--r0: {error}")),
            FrameError::DegenerateSegment { segment } => self.segment_error(
                segment,
                "the tangents are reversed, the curve has a cusp, or the rows are too far apart",
            ),
            FrameError::OppositeTangents { segment } => {
                self.segment_error(segment, "the tangents are opposite; add a row between")
            }
        }
    }

    fn hermite_error(&self, error: &HermiteError) -> CommandError {
        self.segment_error(error.segment, format!("{}; more rows may help", error.reason))
    }

    /// Error about the two rows at the ends of a segment.
    fn segment_error(&self, segment: usize, problem: impl std::fmt::Display) -> CommandError {
        self.table.error_between(segment, self.next(segment), problem).into()
    }

    fn next(&self, segment: usize) -> usize {
        (segment + 1) % self.table.rows().len()
    }
}

/// Translates indices of points into rows of the file.
fn spine_error(table: &CsvTable, error: SpineError) -> CsvError {
    match error {
        SpineError::TooFewPoints { .. } | SpineError::TangentCount { .. } => table.error_in_file(error),
        SpineError::PointNotFinite { index } => table.error(index, "a coordinate is too large"),
        SpineError::TangentNotFinite { index } => table.error(index, "the tangent is too long"),
        SpineError::ZeroTangent { index } => table.error(index, "the tangent is zero"),
        SpineError::ClosingPointRepeated { index } => {
            table.error(index, "the row repeats the first point; remove it, because --closed connects the ends")
        }
        SpineError::NotClosed { gap, longest } => table.error_in_file(format!(
            "--closed: the gap between the last and first row is {gap}, but other neighbors are at most {longest} \
             apart; the curve is open"
        )),
        SpineError::Tangent(TangentError::RepeatedPoint { index, next }) => {
            table.error_between(index, next, "the points coincide; remove one, or give tangents")
        }
        SpineError::Tangent(TangentError::Undetermined { index }) => {
            table.error(index, "the neighboring points do not determine a tangent: a cusp, or rows too far apart")
        }
        SpineError::Tangent(TangentError::Parameter { .. }) => table.error_in_file(error),
    }
}
