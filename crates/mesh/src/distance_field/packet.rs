//! The nearest triangle for packets of neighboring grid nodes, in `f32` lanes.
//!
//! Neighbors share their way through the hierarchy and start from what the packet beside them found, and the arithmetic has no
//! branches, so that lanes become vector registers.

use super::Grid;
use super::preparation::Preparation;
use crate::{Aabb, Bvh};

/// Nodes in a packet along x, y and z.
pub(super) const PACKET: [usize; 3] = [4, 2, 2];

/// Nodes in a packet.
pub(super) const LANES: usize = PACKET[0] * PACKET[1] * PACKET[2];

/// A number for each node of a packet.
pub(super) type Lanes = [f32; LANES];

/// The lane that says which of two boxes to search first: one in the middle.
const MIDDLE: usize = 5;

/// Triangles and boxes prepared for the kernel, with the hierarchy to find them in.
#[derive(Debug)]
pub(super) struct PacketSearch {
    prepared: Preparation,
    largest: f64,
}

/// Points in the unit frame with the nearest triangles found so far.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(super) struct Packet {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
    pub(super) z: Lanes,
    /// Squared distances.
    pub(super) squared: Lanes,
    /// Nearest triangles, in leaf order; [`NOTHING`] where all are farther than the search reaches.
    pub(super) slot: [u32; LANES],
}

/// The slot of no triangle.
pub(super) const NOTHING: u32 = u32::MAX;

/// A node that waits for its search, with the squared distances to its box.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(super) struct Pending {
    squared: Lanes,
    node: usize,
}

impl Packet {
    /// Whether any of these squared distances is less than that to the nearest triangle.
    #[inline(always)]
    fn may_improve(&self, squared: &Lanes) -> bool {
        let mut nearer = 0;
        for i in 0..LANES {
            nearer |= u32::from(squared[i] < self.squared[i]);
        }
        nearer != 0
    }
}

impl PacketSearch {
    /// For the nodes of `grid`.
    pub(super) fn new(bvh: &Bvh, grid: &Grid) -> Self {
        let bounds = grid.bounds();
        let extent = Aabb { min: bvh.frame().inward(bounds.min), max: bvh.frame().inward(bounds.max) };
        let largest = extent.min.abs().max(extent.max.abs()).max_element();
        Self { prepared: Preparation::new(bvh, largest), largest }
    }

    /// The largest coordinate of a node in the unit frame.
    pub(super) fn largest_coordinate(&self) -> f64 {
        self.largest
    }

    /// Square of the length of the longest edge in the unit frame.
    pub(super) fn longest_edge2(&self) -> f64 {
        self.prepared.longest2
    }

    /// Finds the nearest triangle for each lane. `guesses` are triangles likely to be near; they save time. `stack` is scratch.
    #[inline(always)]
    pub(super) fn search(&self, packet: &mut Packet, guesses: &[u32], stack: &mut Vec<Pending>) {
        let Preparation { boxes, triangles, .. } = &self.prepared;
        for &slot in guesses {
            triangles[slot as usize].update(packet, slot);
        }
        stack.clear();
        stack.push(Pending { squared: [0.0; LANES], node: 0 });
        while let Some(pending) = stack.pop() {
            if !packet.may_improve(&pending.squared) {
                continue;
            }
            let mut index = pending.node;
            // Down to a leaf or to where no box is near enough, the nearer box first.
            loop {
                let Some(first) = boxes[index].children() else {
                    for slot in boxes[index].triangles() {
                        triangles[slot as usize].update(packet, slot);
                    }
                    break;
                };
                let left = boxes[first].squared_distances(packet);
                let right = boxes[first + 1].squared_distances(packet);
                index = match (packet.may_improve(&left), packet.may_improve(&right)) {
                    (false, false) => break,
                    (true, false) => first,
                    (false, true) => first + 1,
                    (true, true) if left[MIDDLE] <= right[MIDDLE] => {
                        stack.push(Pending { squared: right, node: first + 1 });
                        first
                    }
                    (true, true) => {
                        stack.push(Pending { squared: left, node: first });
                        first + 1
                    }
                };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use multiversion::multiversion;

    use super::*;
    use crate::{DistanceField, DistanceFieldOptions, NoProgress, primitives};

    /// Nearest triangles and squared distances for packets along the diagonal of the grid, each beginning from what the last found.
    #[inline(always)]
    fn along_the_diagonal(search: &PacketSearch, grid: &Grid) -> Vec<([u32; LANES], [u32; LANES])> {
        let bounds = grid.bounds();
        let mut guesses = Vec::new();
        let mut stack = Vec::new();
        let mut found = Vec::new();
        for step in 0..32 {
            let middle = bounds.min + (bounds.max - bounds.min) * (f64::from(step) / 31.0);
            let along =
                |axis: usize, scale: f32| std::array::from_fn(|lane| middle[axis] as f32 + scale * (lane as f32 - 7.3));
            let (x, y, z) = (along(0, 0.01), along(1, -0.02), along(2, 0.007));
            let mut packet = Packet { x, y, z, squared: [f32::INFINITY; LANES], slot: [NOTHING; LANES] };
            search.search(&mut packet, &guesses, &mut stack);
            guesses = packet.slot.to_vec();
            found.push((packet.slot, packet.squared.map(f32::to_bits)));
        }
        found
    }

    #[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
    fn in_widest_registers(search: &PacketSearch, grid: &Grid) -> Vec<([u32; LANES], [u32; LANES])> {
        along_the_diagonal(search, grid)
    }

    #[test]
    fn packets_find_the_same_bits_in_registers_of_any_width() {
        let mesh = primitives::icosphere(1.0, 4);
        let options = DistanceFieldOptions { resolution: 12, ..Default::default() };
        let grid = *DistanceField::new(&mesh, &options, &NoProgress).unwrap().grid();
        let search = PacketSearch::new(&Bvh::new(&mesh.positions, &mesh.triangles).unwrap(), &grid);
        // Without the attribute, the search is compiled for the least that the target has.
        let narrowest = along_the_diagonal(&search, &grid);
        assert!(narrowest.iter().all(|(slots, _)| slots.iter().all(|&slot| slot != NOTHING)));
        assert_eq!(in_widest_registers(&search, &grid), narrowest);
    }
}
