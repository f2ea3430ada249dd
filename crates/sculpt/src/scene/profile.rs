//! Falloff profiles.

use isochore_field as field;

use crate::recipe::Profile;

/// The profile of the field crate with this name.
pub(super) fn profile(profile: Profile) -> field::Profile {
    match profile {
        Profile::Quintic => field::Profile::Quintic,
        Profile::Septic => field::Profile::Septic,
        Profile::Quartic => field::Profile::Quartic,
        Profile::Contact => field::Profile::Contact,
        Profile::Thesis => field::Profile::Thesis,
    }
}
