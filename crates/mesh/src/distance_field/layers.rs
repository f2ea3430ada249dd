//! Lines of a grid that cross its layers.

/// Splits the values of a grid (x fastest) into groups of rows along x: one group for each y, with
/// a row for each z. A group holds the lines along z that start in one row.
pub(super) fn rows_across_layers(values: &mut [f32], [nx, ny, nz]: [usize; 3]) -> Vec<Vec<&mut [f32]>> {
    let mut groups: Vec<Vec<&mut [f32]>> = (0..ny).map(|_| Vec::with_capacity(nz)).collect();
    values.chunks_mut(nx).enumerate().for_each(|(row, values)| groups[row % ny].push(values));
    groups
}
