//! The names under which faces list their vertices.

/// Whether a property of a face is its list of vertex indices.
pub(super) fn is_indices(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}
