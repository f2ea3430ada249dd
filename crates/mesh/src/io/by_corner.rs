//! Vertex values distributed to the corners.

use crate::huge_pages::in_huge_pages;

/// The value of each corner's vertex. Empty if `values` is empty.
///
/// # Panics
/// If a vertex has no value.
pub(super) fn by_corner<T: bytemuck::Pod>(triangles: &[[u32; 3]], values: &[T]) -> Vec<[T; 3]> {
    if values.is_empty() {
        return Vec::new();
    }
    // Single values rather than arrays of three, which would be assembled on the stack and stall
    // the processor when they are loaded from it.
    let mut corners = in_huge_pages(Vec::with_capacity(3 * triangles.len()));
    corners.extend(triangles.as_flattened().iter().map(|&vertex| values[vertex as usize]));
    bytemuck::cast_vec(corners)
}
