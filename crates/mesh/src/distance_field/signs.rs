//! Which nodes of a grid lie inside.

use super::Grid;

/// Parts of a grid whose nodes lie on the same side of any closed surface.
///
/// Two neighbors whose distances to the surface sum to more than what lies between them cannot have the surface between them:
/// it would meet the straight way at a point whose distances to both sum to exactly that way.
pub(super) struct Regions {
    /// Of each node, a node of the same region; the root of a region names itself.
    parent: Vec<u32>,
}

impl Regions {
    /// Regions of a grid with unsigned `distances`, each off by `error` at most.
    pub(super) fn new(grid: &Grid, distances: &[f32], error: f64) -> Self {
        let [nx, ny, nz] = grid.dims;
        let apart = (grid.cell + 2.0 * error) * ROUNDING;
        let mut regions = Self { parent: (0..distances.len() as u32).collect() };
        for k in 0..nz {
            for j in 0..ny {
                let row = (k * ny + j) * nx;
                for index in row..row + nx {
                    let distance = f64::from(distances[index]);
                    let mut join = |neighbor: usize| {
                        if distance + f64::from(distances[neighbor]) > apart {
                            regions.join(index as u32, neighbor as u32);
                        }
                    };
                    if index > row {
                        join(index - 1);
                    }
                    if j > 0 {
                        join(index - nx);
                    }
                    if k > 0 {
                        join(index - nx * ny);
                    }
                }
            }
        }
        for index in 0..regions.parent.len() {
            regions.parent[index] = regions.root(index as u32);
        }
        regions
    }

    /// Of each region, the node farthest from the surface, where inside and outside are easiest to tell apart.
    pub(super) fn representatives(&self, distances: &[f32]) -> Vec<u32> {
        let mut farthest: Vec<u32> = (0..self.parent.len() as u32).collect();
        for (index, &root) in self.parent.iter().enumerate() {
            let best = &mut farthest[root as usize];
            if distances[index] > distances[*best as usize] {
                *best = index as u32;
            }
        }
        (self.parent.iter().enumerate())
            .filter(|&(index, &root)| index as u32 == root)
            .map(|(index, _)| farthest[index])
            .collect()
    }

    /// Makes the distances of the regions of these nodes negative.
    pub(super) fn negate(&self, distances: &mut [f32], inside: impl Iterator<Item = u32>) {
        let mut is_inside = vec![false; self.parent.len()];
        for node in inside {
            is_inside[self.parent[node as usize] as usize] = true;
        }
        for (distance, &root) in distances.iter_mut().zip(&self.parent) {
            if is_inside[root as usize] {
                *distance = -*distance;
            }
        }
    }

    fn root(&mut self, mut node: u32) -> u32 {
        while self.parent[node as usize] != node {
            let grandparent = self.parent[self.parent[node as usize] as usize];
            self.parent[node as usize] = grandparent;
            node = grandparent;
        }
        node
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        self.parent[high as usize] = low;
    }
}

/// Allows for rounding of the sum of two distances. Larger: more regions, each of which costs a query.
const ROUNDING: f64 = 1.0 + 1e-6;
