//! Keys that are omitted when a recipe is written.

/// Whether `value` is what a reader assumes if the key is missing.
pub(super) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Whether a flag is true, which is what a reader assumes if its key is missing.
pub(super) fn is_true(value: &bool) -> bool {
    *value
}
