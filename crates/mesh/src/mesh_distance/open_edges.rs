/// Returns the directed edges that remain after opposite directions cancel, with multiplicity.
/// Takes linear time.
///
/// The result is empty if every edge is used equally often in both directions. Then winding numbers
/// are integers off the surface. At every vertex, equally many of these edges begin and end.
///
/// # Panics
/// If an index is not below `vertices`.
pub(crate) fn open_edges(triangles: &[[u32; 3]], vertices: usize) -> Vec<[u32; 2]> {
    let directed =
        || (triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])).filter(|[from, to]| from != to);
    // A bucket per vertex collects the larger ends of the edges whose smaller end it is: forward
    // edges from the front, backward edges from the back.
    let mut starts = vec![0_u32; vertices + 1];
    for [from, to] in directed() {
        starts[from.min(to) as usize + 1] += 1;
    }
    for vertex in 0..vertices {
        starts[vertex + 1] += starts[vertex];
    }
    let (mut fronts, mut backs) = (starts[..vertices].to_vec(), starts[1..].to_vec());
    let mut bucketed = vec![0; starts[vertices] as usize];
    for [from, to] in directed() {
        if from < to {
            let front = &mut fronts[from as usize];
            bucketed[*front as usize] = to;
            *front += 1;
        } else {
            let back = &mut backs[to as usize];
            *back -= 1;
            bucketed[*back as usize] = from;
        }
    }
    let mut open = Vec::new();
    for (vertex, &middle) in fronts.iter().enumerate() {
        // Sort both halves of each bucket. Edges without an opposite appear in only one of them.
        let (start, end) = (starts[vertex] as usize, starts[vertex + 1] as usize);
        let (forward, backward) = bucketed[start..end].split_at_mut(middle as usize - start);
        forward.sort_unstable();
        backward.sort_unstable();
        if forward != backward {
            push_unpaired(&mut open, vertex as u32, forward, backward);
        }
    }
    open
}

/// Adds the edges between `vertex` and larger vertices that have no opposite. Both lists are
/// sorted.
fn push_unpaired(open: &mut Vec<[u32; 2]>, vertex: u32, mut forward: &[u32], mut backward: &[u32]) {
    loop {
        match (forward.first(), backward.first()) {
            (Some(to), Some(from)) if to == from => (forward, backward) = (&forward[1..], &backward[1..]),
            (Some(&to), from) if from.is_none_or(|&from| to < from) => {
                open.push([vertex, to]);
                forward = &forward[1..];
            }
            (_, Some(&from)) => {
                open.push([from, vertex]);
                backward = &backward[1..];
            }
            (_, None) => break,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_edges_without_an_opposite() {
        let closed = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [3, 2, 1]];
        assert_eq!(open_edges(&closed, 4), [[0; 2]; 0]);
        assert_eq!(open_edges(&closed[1..], 4), [[1, 0], [0, 2], [2, 1]]);
        // The same triangle twice. Edges of length zero do not count.
        assert_eq!(
            open_edges(&[[2, 1, 0], [2, 1, 0], [1, 1, 3]], 4),
            [[1, 0], [1, 0], [0, 2], [0, 2], [2, 1], [2, 1], [1, 3], [3, 1]][..6]
        );
    }
}
