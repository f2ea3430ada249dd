//! The half-edges along each edge.

use isochore_mesh::Topology;

/// The half-edges along each edge, in a cycle: one at a boundary, two inside a manifold surface, more
/// on a nonmanifold edge.
///
/// Half-edge `3 t + k` runs from corner `k` to corner `k + 1` (modulo three) of triangle `t`.
#[derive(Debug, Clone)]
pub(super) struct EdgeCycles {
    next: Vec<u32>,
}

impl EdgeCycles {
    pub(super) fn new(topology: &Topology) -> Self {
        let mut next = vec![0; topology.edge_of_half_edge.len()];
        for edge in 0..topology.edges.len() {
            let around = topology.half_edges(edge);
            for (index, &half_edge) in around.iter().enumerate() {
                next[half_edge as usize] = around[(index + 1) % around.len()];
            }
        }
        Self { next }
    }

    /// The half-edges along an edge, starting with the given one.
    pub(super) fn around(&self, half_edge: u32) -> impl Iterator<Item = u32> + '_ {
        let following = move |&current: &u32| Some(self.next(current)).filter(|&next| next != half_edge);
        std::iter::successors(Some(half_edge), following)
    }

    /// The half-edge after this one in its cycle.
    pub(super) fn next(&self, half_edge: u32) -> u32 {
        self.next[half_edge as usize]
    }

    /// Changes the number of triangles. New half-edges are alone on their edges.
    pub(super) fn resize(&mut self, triangles: usize) {
        let known = self.next.len();
        self.next.resize(3 * triangles, 0);
        for half_edge in known..self.next.len() {
            self.isolate(half_edge as u32);
        }
    }

    /// Makes a half-edge alone on its edge. Does not repair the cycle that contained it.
    pub(super) fn isolate(&mut self, half_edge: u32) {
        self.next[half_edge as usize] = half_edge;
    }

    /// Adds a half-edge that is alone to the cycle of another.
    pub(super) fn join(&mut self, half_edge: u32, other: u32) {
        self.next[half_edge as usize] = std::mem::replace(&mut self.next[other as usize], half_edge);
    }

    /// Replaces half-edge `from` by `to`, which is alone. `from` is alone afterwards.
    pub(super) fn replace(&mut self, from: u32, to: u32) {
        let before = self.around(from).last().unwrap_or(from);
        if before != from {
            self.next[to as usize] = self.next[from as usize];
            self.next[before as usize] = to;
            self.isolate(from);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joins_and_replaces_half_edges() {
        // Three triangles on the edge 0–1.
        let mut cycles = EdgeCycles::new(&Topology::of_triangles(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]], 5));
        assert_eq!(cycles.around(3).collect::<Vec<_>>(), [3, 6, 0]);
        assert_eq!(cycles.around(1).collect::<Vec<_>>(), [1]);
        cycles.resize(4);
        cycles.replace(6, 9);
        assert_eq!(cycles.around(0).collect::<Vec<_>>(), [0, 3, 9]);
        assert_eq!(cycles.around(6).collect::<Vec<_>>(), [6]);
        cycles.join(10, 3);
        assert_eq!(cycles.around(0).collect::<Vec<_>>(), [0, 3, 10, 9]);
    }
}
