/// Directed edges that are left over when opposite directions cancel, each as often as it is left: none if every edge is used as
/// often in one direction as in the other, and then winding numbers are whole off the surface. Takes linear time.
///
/// At every vertex as many of them arrive as leave.
///
/// # Panics
/// If an index is not below `vertices`.
pub(crate) fn open_edges(triangles: &[[u32; 3]], vertices: usize) -> Vec<[u32; 2]> {
    let directed =
        || (triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])).filter(|[from, to]| from != to);
    // Edges in buckets by their smaller vertex.
    let mut ends = vec![0_u32; vertices];
    for [from, to] in directed() {
        ends[from.min(to) as usize] += 1;
    }
    let mut start = 0;
    for end in &mut ends {
        (*end, start) = (start, start + *end);
    }
    let mut bucketed = vec![(0, false); start as usize];
    for [from, to] in directed() {
        let end = &mut ends[from.min(to) as usize];
        bucketed[*end as usize] = (from.max(to), from < to);
        *end += 1;
    }
    let mut open = Vec::new();
    let mut start = 0;
    for (smaller, &end) in ends.iter().enumerate() {
        let bucket = &mut bucketed[start..end as usize];
        start = end as usize;
        bucket.sort_unstable();
        for uses in bucket.chunk_by(|one, other| one.0 == other.0) {
            let (smaller, larger) = (smaller as u32, uses[0].0);
            let forward = uses.iter().filter(|(_, is_forward)| *is_forward).count();
            let backward = uses.len() - forward;
            open.extend(std::iter::repeat_n([smaller, larger], forward.saturating_sub(backward)));
            open.extend(std::iter::repeat_n([larger, smaller], backward.saturating_sub(forward)));
        }
    }
    open
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_of_the_edges() {
        let closed = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [3, 2, 1]];
        assert_eq!(open_edges(&closed, 4), [[0; 2]; 0]);
        assert_eq!(open_edges(&closed[1..], 4), [[1, 0], [0, 2], [2, 1]]);
        // Twice the same triangle; edges without length do not count.
        assert_eq!(
            open_edges(&[[2, 1, 0], [2, 1, 0], [1, 1, 3]], 4),
            [[1, 0], [1, 0], [0, 2], [0, 2], [2, 1], [2, 1], [1, 3], [3, 1]][..6]
        );
    }
}
