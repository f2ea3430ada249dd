//! The ring.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Profile,
    error::RecipeProblem,
    is_default,
    validate::{Check, all_finite, direction, fail, finite, positive},
};

/// See [`Stroke::Ring`](super::Stroke::Ring).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ring {
    /// Middle of the ring at the beginning, model units.
    pub center: [f64; 3],
    /// Direction in which the ring moves, across its plane; of any length.
    pub axis: [f64; 3],
    /// Radius of the circle in the middle of the tube, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub major: f64,
    /// Radius of the tube, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub minor: f64,
    /// How far the field reaches beyond the tube, short of the axis; model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub support: f64,
    /// How far the ring is carried, model units; backwards where it is negative.
    pub distance: f64,
    /// How the field fades; any but `thesis`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub profile: Profile,
}

pub(super) fn validate(ring: &Ring) -> Check {
    all_finite("center", &ring.center)?;
    direction("axis", &ring.axis)?;
    positive("major", ring.major)?;
    positive("minor", ring.minor)?;
    positive("support", ring.support)?;
    finite("distance", ring.distance)?;
    smooth_profile(ring.profile)
}

/// Refuses the profile whose kink tears fields that are no rigid motion.
pub(super) fn smooth_profile(profile: Profile) -> Check {
    match profile {
        Profile::Thesis => {
            let text = "`thesis` is kinked on the surface and only for tools that move rigidly; choose another";
            fail("profile", RecipeProblem::Other(text.to_owned()))
        }
        _ => Ok(()),
    }
}
