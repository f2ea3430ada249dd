//! Values of vertices handed to corners.

use crate::huge_pages::in_huge_pages;

/// The value of each corner's vertex; none where there are no values.
///
/// # Panics
/// If a vertex has no value.
pub(super) fn by_corner<T: bytemuck::Pod>(triangles: &[[u32; 3]], values: &[T]) -> Vec<[T; 3]> {
    if values.is_empty() {
        return Vec::new();
    }
    // One value after the other: arrays of three would go over the stack, in pieces that make the processor wait.
    let mut corners = in_huge_pages(Vec::with_capacity(3 * triangles.len()));
    corners.extend(triangles.as_flattened().iter().map(|&vertex| values[vertex as usize]));
    bytemuck::cast_vec(corners)
}
