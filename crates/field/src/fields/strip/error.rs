//! Errors of strips.

use isochore_curve::SplineError;

use crate::fields::Profile;

/// Errors when constructing a [`Strip`](crate::Strip), its shape or its spine.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StripError {
    /// No spline passes through the points of the spine.
    #[error("{list}: {source}")]
    Spine {
        /// Name of the list of points.
        list: &'static str,
        /// Error of the spline.
        source: SplineError,
    },
    /// The spine has different numbers of points at the start and at the end.
    #[error(
        "the spine has {start} points at the start and {end} at the end; give equally many, as each point moves to its counterpart"
    )]
    PointCounts {
        /// Number of points at the start.
        start: usize,
        /// Number of points at the end.
        end: usize,
    },
    /// The support is not a positive, finite length.
    #[error("the support must be a positive length, not {0}")]
    Support(f64),
    /// A radius is not a positive, finite length.
    #[error("radius {index} must be a positive length, not {value}")]
    Radius {
        /// Index in the list, from 0.
        index: usize,
        /// Radius given.
        value: f64,
    },
    /// The list of radii is empty.
    #[error("the list of radii is empty; give at least one radius")]
    NoRadius,
    /// The smooth curve through the radii falls to zero or below.
    #[error("between radii {index} and {} the smooth curve through the radii falls to zero; give more radii between them", .index + 1)]
    RadiusSwings {
        /// Index of the first of the two radii, from 0.
        index: usize,
    },
    /// A cross-section has fewer than three points, or a point that is not finite.
    #[error("a cross-section needs at least 3 points, all finite")]
    SectionPoints,
    /// A cross-section has no interior.
    #[error("the cross-section encloses no area")]
    SectionEmpty,
    /// A cross-section is too large compared with its thinnest part and the support.
    #[error(
        "the cross-section would take {cells:.0} samples, more than {most}; give a larger support or a less flat cross-section"
    )]
    SectionCells {
        /// Required number of samples.
        cells: f64,
        /// Largest allowed number of samples.
        most: usize,
    },
    /// The direction of a cross-section's x axis is zero or along the spine.
    #[error("the reference direction of the cross-section must be nonzero and not along the start of the spine")]
    Reference,
    /// A cross-section or a list of radii needs an open spine, as it begins at the start of the
    /// spine.
    #[error("cross-sections and lists of radii need an open spine; open it, or give one radius")]
    Closed,
    /// The profile has a kink on the surface, which would tear the material at the strip.
    #[error("the profile `{0}` has a kink on the surface, which a strip cannot have; choose another")]
    Profile(Profile),
    /// The field would reach points without a unique nearest point on the spine.
    #[error(
        "the field reaches {extent:.6} from the spine, but the spine {}allows only {:.6}: its smallest radius of \
         curvature is {curvature_radius:.6}, and its parts come within {:.6} of each other; use a thinner strip, a smaller \
         support or a straighter spine",
        when(*.time), REACH_FRACTION * .curvature_radius.min(*.bottleneck_radius), 2.0 * .bottleneck_radius
    )]
    Reach {
        /// Distance from the spine that the field reaches: radius plus support.
        extent: f64,
        /// Smallest radius of curvature of the spine.
        curvature_radius: f64,
        /// Half the smallest distance between two facing parts of the spine.
        bottleneck_radius: f64,
        /// Time of the failure, from 0 to 1.
        time: f64,
    },
    /// The spine is too short for its ends to fade.
    #[error(
        "the spine {}is {length:.6} long, but each of its ends fades over {taper:.6}, the radius plus the support; make it \
         longer",
        when(*.time)
    )]
    TooShort {
        /// Length of the spine.
        length: f64,
        /// Length over which an end fades.
        taper: f64,
        /// Time of the failure, from 0 to 1.
        time: f64,
    },
    /// A number is infinite or NaN.
    #[error("{0} must be finite")]
    NotFinite(&'static str),
}

/// Largest fraction of the spine's reach that a field may use. Larger: close to the reach, a strip
/// across is stretched without bound, and the reach is itself estimated from above. Smaller:
/// rejects valid strips.
pub(super) const REACH_FRACTION: f64 = 0.95;

/// A time as words for a message; empty at the start.
fn when(time: f64) -> String {
    if time > 0.0 { format!("at {:.0} % of the time ", 100.0 * time) } else { String::new() }
}
