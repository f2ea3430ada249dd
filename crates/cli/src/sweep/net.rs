//! The swept surface as exact rational patches.

use isochore_curve::{RationalPatch, RationalCrossSection, RationalRotation};
use serde::Serialize;

use crate::{
    arguments::{Method, SweepArguments, Twist},
    command_error::CommandError,
    spine_file::SpineFile,
};

/// Rational tensor-product Bézier patches over a spline of Pythagorean-hodograph cubics.
#[derive(Debug)]
pub(super) struct Net {
    /// Patches by segment of the curve and by curve of the profile.
    pub(super) patches: Vec<Vec<RationalPatch>>,
    /// Whether the last curve of the profile is followed by the first.
    pub(super) is_profile_closed: bool,
}

/// The net as it is written.
#[derive(Debug, Serialize)]
struct NetFile {
    kind: &'static str,
    /// Degree along the profile.
    degree_u: usize,
    /// Degree along the curve.
    degree_v: usize,
    patches: Vec<PatchFile>,
}

/// One patch over [0, 1]².
#[derive(Debug, Serialize)]
struct PatchFile {
    /// Segment of the curve.
    segment: usize,
    /// Curve of the profile.
    side: usize,
    /// Control points [x, y, z, weight], not multiplied by their weight; index [u][v].
    control_points: Vec<Vec<[f64; 4]>>,
}

impl Net {
    /// The surface that `profile` sweeps along the rows of `spine`.
    pub(super) fn new(
        arguments: &SweepArguments,
        spine: &SpineFile,
        profile: Vec<RationalCrossSection>,
        is_profile_closed: bool,
    ) -> Result<Self, CommandError> {
        refuse(arguments)?;
        let spline = spine.ph_spline()?;
        let frames = spline
            .exact_frames(spine.reference(&arguments.spine), 1)
            .map_err(|error| CommandError::Usage(format!("--r0: {error}")))?;
        let patches = spline
            .segments()
            .iter()
            .zip(&frames)
            .map(|(cubic, (_, frame))| {
                let rotation = RationalRotation::symmetric(cubic);
                // The profile stands where the exact frame does at the start of the segment.
                let angle = cubic.frenet_frame(0.0).angle_to(frame.r);
                profile.iter().map(|curve| RationalPatch::sweep(cubic, &rotation, curve, angle)).collect()
            })
            .collect();
        Ok(Self { patches, is_profile_closed })
    }

    pub(super) fn to_json(&self) -> String {
        let [degree_u, degree_v] = self.degrees();
        let patches = self
            .patches
            .iter()
            .enumerate()
            .flat_map(|(segment, sides)| {
                let file = move |(side, patch)| PatchFile { segment, side, control_points: rows(patch) };
                sides.iter().enumerate().map(file)
            })
            .collect();
        let net = NetFile { kind: "rational Bézier patches", degree_u, degree_v, patches };
        // On one line: indented, every number would have its own.
        format!("{}\n", serde_json::to_string(&net).expect("a net has only strings for keys"))
    }

    fn degrees(&self) -> [usize; 2] {
        let first = &self.patches[0][0];
        [first.cross_section_degree, first.spine_degree]
    }
}

impl std::fmt::Display for Net {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [across, along] = self.degrees();
        let count: usize = self.patches.iter().map(Vec::len).sum();
        write!(f, "{count} patches of degree {along} along the curve and {across} along the profile")
    }
}

/// What a rational surface cannot have.
fn refuse(arguments: &SweepArguments) -> Result<(), CommandError> {
    let spine = &arguments.spine;
    let problem = if spine.method.is_some_and(|method| method != Method::Ph) {
        "an exact surface is one over Pythagorean-hodograph cubics: take --method ph, or write a mesh"
    } else if spine.twist.is_some_and(|twist| twist != Twist::None) {
        "an exact surface has rotation-minimizing frames, which --twist would change; write a mesh"
    } else if arguments.caps {
        "an exact surface has no caps; write a mesh"
    } else if spine.samples_per_segment.is_some() {
        "an exact surface is not sampled: leave out --samples-per-segment"
    } else {
        return Ok(());
    };
    Err(CommandError::Usage(problem.to_owned()))
}

fn rows(patch: &RationalPatch) -> Vec<Vec<[f64; 4]>> {
    let point = |h: &glam::DVec4| (h.truncate() / h.w).extend(h.w).to_array();
    patch.control_points.chunks(patch.spine_degree + 1).map(|row| row.iter().map(point).collect()).collect()
}
