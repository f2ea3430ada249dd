use isochore_curve::SplineError;

use crate::fields::Profile;

/// Why there is no such strip.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StripError {
    /// The points of the spine have no curve.
    #[error("{list}: {source}")]
    Spine {
        /// Which list of points.
        list: &'static str,
        /// Why not.
        source: SplineError,
    },
    /// The spine ends with another number of points than it begins with.
    #[error("the spine begins with {start} points and ends with {end}; points move one by one, so give as many")]
    PointCounts {
        /// Points at the beginning.
        start: usize,
        /// Points at the end.
        end: usize,
    },
    /// The support is not a positive, finite length.
    #[error("the support must be a positive length, not {0}")]
    Support(f64),
    /// A radius is not a positive, finite length.
    #[error("radius {index} must be a positive length, not {value}")]
    Radius {
        /// Its place in the list, from 0.
        index: usize,
        /// The radius.
        value: f64,
    },
    /// There is no radius.
    #[error("the strip needs a radius")]
    NoRadius,
    /// The smooth law through the radii swings below zero.
    #[error("between radii {index} and {} the smooth law through them falls to zero; give more radii there", .index + 1)]
    RadiusSwings {
        /// The first of the two, from 0.
        index: usize,
    },
    /// A section is not made of at least three finite points.
    #[error("a section needs at least 3 points, all finite")]
    SectionPoints,
    /// A section has no inside.
    #[error("the section encloses no area")]
    SectionEmpty,
    /// A section is too large for its thinnest part and the support.
    #[error(
        "the section would take {cells:.0} samples, more than {most}; give a wider support, or a less flat section"
    )]
    SectionCells {
        /// Samples needed.
        cells: f64,
        /// Samples allowed.
        most: usize,
    },
    /// The direction of a section's x axis is along the spine, or none.
    #[error("the section's reference direction must not be zero or along the spine where it begins")]
    Reference,
    /// A closed spine has no place where a section or a list of radii could begin.
    #[error("sections and lists of radii need an open spine")]
    Closed,
    /// The profile has a kink on the surface, across which a strip would be torn.
    #[error("the profile `{0}` is for tools that move rigidly; choose another")]
    Profile(Profile),
    /// The field would reach points that have no nearest point on the spine.
    #[error(
        "the field reaches {extent:.6} from the spine, but the spine {}allows only {:.6}: it bends with a radius of \
         {curvature_radius:.6}, and its parts come within {:.6} of each other; take a thinner strip, a smaller support or a \
         gentler spine",
        when(*.time), REACH_SHARE * .curvature_radius.min(*.bottleneck_radius), 2.0 * .bottleneck_radius
    )]
    Reach {
        /// Radius and support together: how far from the spine the field reaches.
        extent: f64,
        /// Smallest radius of curvature of the spine.
        curvature_radius: f64,
        /// Half the distance at which two parts of the spine face each other.
        bottleneck_radius: f64,
        /// When, from 0 to 1.
        time: f64,
    },
    /// The spine is too short for its ends to fade.
    #[error(
        "the spine {}is {length:.6} long, but each of its ends fades over {taper:.6}, the radius and the support together; make \
         it longer",
        when(*.time)
    )]
    TooShort {
        /// Length of the spine.
        length: f64,
        /// Length over which an end fades.
        taper: f64,
        /// When, from 0 to 1.
        time: f64,
    },
    /// A number is infinite or not a number.
    #[error("{0} must be finite")]
    NotFinite(&'static str),
}

/// How much of the spine's reach a field may use. Larger: just short of the reach the strip across is stretched without bound,
/// and the reach itself is an estimate from above. Smaller refuses what works.
pub(super) const REACH_SHARE: f64 = 0.95;

/// Words for a time, none at the beginning.
fn when(time: f64) -> String {
    if time > 0.0 { format!("at {:.0} % of the time ", 100.0 * time) } else { String::new() }
}
