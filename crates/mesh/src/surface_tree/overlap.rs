//! Triangles near a part of the surface.

use super::{NONE, SurfaceTree};

impl SurfaceTree {
    /// The triangles of all leaves whose boxes overlap a box around one of `triangles`, in ascending
    /// order. They include all triangles whose boxes overlap a box of `triangles`, and `triangles`
    /// themselves.
    ///
    /// Takes time proportional to the number of `triangles` and of the triangles near them.
    /// Triangles that are not in the tree are ignored.
    ///
    /// ```
    /// use isochore_mesh::{SurfaceTree, primitives};
    ///
    /// let ball = primitives::icosphere(1.0, 5);
    /// let tree = SurfaceTree::new(&ball.positions, &ball.triangles)?;
    /// let near = tree.triangles_near(&[7]);
    /// assert!(near.contains(&7) && near.len() < 200);
    /// # Ok::<(), isochore_mesh::BvhError>(())
    /// ```
    pub fn triangles_near(&self, triangles: &[u32]) -> Vec<u32> {
        let is_marked = self.ancestors(triangles);
        let mut is_found = vec![false; self.nodes.len()];
        let mut found = Vec::new();
        let mut stack = Vec::new();
        if is_marked[0] {
            stack.push((0, 0));
        }
        // Pairs of a marked node and any node.
        while let Some((marked, other)) = stack.pop() {
            let nodes: [_; 2] = [marked, other].map(|index: u32| &self.nodes[index as usize]);
            if is_found[other as usize] || !nodes[0].bounds.overlaps(nodes[1].bounds) {
                continue;
            }
            let below = |index: u32, child: u32| if child == NONE { [index, NONE] } else { [child, child + 1] };
            if nodes[0].child == NONE && nodes[1].child == NONE {
                is_found[other as usize] = true;
                found.extend(self.of_leaf(other));
                continue;
            }
            for marked in below(marked, nodes[0].child).into_iter().filter(|&index| index != NONE) {
                if is_marked[marked as usize] {
                    let others = below(other, nodes[1].child).into_iter().filter(|&index| index != NONE);
                    stack.extend(others.map(|other| (marked, other)));
                }
            }
        }
        found.sort_unstable();
        found
    }

    /// For each node, whether it is or contains a leaf with one of `triangles`.
    fn ancestors(&self, triangles: &[u32]) -> Vec<bool> {
        let mut is_marked = vec![false; self.nodes.len()];
        for &triangle in triangles {
            let mut node = self.leaf_of.get(triangle as usize).copied().unwrap_or(NONE);
            while node != NONE && !is_marked[node as usize] {
                is_marked[node as usize] = true;
                node = self.nodes[node as usize].parent;
            }
        }
        is_marked
    }
}
