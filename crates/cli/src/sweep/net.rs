//! The swept surface as exact rational patches.

use isochore_curve::{RationalPatch, RationalRotation};
use serde::Serialize;

use crate::{
    arguments::{Method, SweepArguments, Twist},
    command_error::CommandError,
    spine_file::SpineFile,
    spine_options::SpineOptions,
    sweep::cross_section::CrossSection,
};

/// Rational tensor-product Bézier patches over a spline of Pythagorean-hodograph cubics.
#[derive(Debug)]
pub(super) struct Net {
    /// Patches, indexed by segment of the curve, then by curve of the cross-section.
    pub(super) patches: Vec<Vec<RationalPatch>>,
    /// Whether the cross-section is closed.
    pub(super) is_cross_section_closed: bool,
}

/// Contents of the JSON file.
#[derive(Debug, Serialize)]
struct NetFile {
    kind: &'static str,
    /// Degree along the cross-section.
    degree_u: usize,
    /// Degree along the curve.
    degree_v: usize,
    patches: Vec<PatchFile>,
}

/// One patch over [0, 1]².
#[derive(Debug, Serialize)]
struct PatchFile {
    /// Index of the segment of the curve.
    segment: usize,
    /// Index of the curve of the cross-section.
    side: usize,
    /// Control points [x, y, z, weight] in Cartesian coordinates; indexed by u, then v.
    control_points: Vec<Vec<[f64; 4]>>,
}

impl Net {
    /// Sweeps a cross-section along the Pythagorean-hodograph spline through the rows of `spine`.
    ///
    /// # Errors
    /// A segment has no such cubic, or the reference vector is parallel to the first tangent.
    pub(super) fn new(
        options: &SpineOptions,
        spine: &SpineFile,
        cross_section: &CrossSection,
    ) -> Result<Self, CommandError> {
        let curves = cross_section.curves();
        let spline = spine.ph_spline()?;
        let frames = spline
            .exact_frames(spine.reference(options), 1)
            .map_err(|error| CommandError::Usage(format!("--r0: {error}")))?;
        let patches = spline
            .segments()
            .iter()
            .zip(&frames)
            .map(|(cubic, (_, frame))| {
                let rotation = RationalRotation::symmetric(cubic);
                // Aligns the cross-section with the exact frame at the start of the segment.
                let angle = cubic.frenet_frame(0.0).angle_to(frame.r);
                curves.iter().map(|curve| RationalPatch::sweep(cubic, &rotation, curve, angle)).collect()
            })
            .collect();
        Ok(Self { patches, is_cross_section_closed: cross_section.is_closed })
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
        // Compact, because indented JSON puts every number on its own line.
        format!("{}\n", serde_json::to_string(&net).expect("all keys of a net are strings"))
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
        write!(f, "{count} patches of degree {along} along the curve and {across} along the cross-section")
    }
}

/// Rejects options that do not apply to an exact surface.
pub(super) fn check(arguments: &SweepArguments) -> Result<(), CommandError> {
    let spine = &arguments.spine;
    let problem = if spine.method.is_some_and(|method| method != Method::Ph) {
        "an exact surface needs Pythagorean-hodograph cubics; use --method ph, or write a mesh"
    } else if spine.twist.is_some_and(|twist| twist != Twist::None) {
        "an exact surface needs rotation-minimizing frames, which --twist changes; remove it, or write a mesh"
    } else if arguments.caps {
        "an exact surface has no caps; remove --caps, or write a mesh"
    } else if spine.samples_per_segment.is_some() {
        "an exact surface is not sampled; remove --samples-per-segment, or write a mesh"
    } else {
        return Ok(());
    };
    Err(CommandError::Usage(problem.to_owned()))
}

fn rows(patch: &RationalPatch) -> Vec<Vec<[f64; 4]>> {
    let point = |h: &glam::DVec4| (h.truncate() / h.w).extend(h.w).to_array();
    patch.control_points.chunks(patch.spine_degree + 1).map(|row| row.iter().map(point).collect()).collect()
}
