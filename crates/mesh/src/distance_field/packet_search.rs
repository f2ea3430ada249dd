//! Search for the nearest triangles of packets of neighboring grid nodes, in `f32` lanes.
//!
//! Neighbors traverse the hierarchy together and start from the triangles found for adjacent
//! packets. The arithmetic has no branches, so the compiler turns lanes into vector registers.

use super::Grid;
use super::lanes::{LANES, Lanes};
use super::packet::Packet;
use super::preparation::Preparation;
use crate::{Aabb, Bvh};

/// The lane that decides which of two boxes is searched first. Its node is near the packet's
/// center.
const DECIDING_LANE: usize = 5;

/// Triangles and boxes prepared for the search, and the size of the searched region.
#[derive(Debug)]
pub(super) struct PacketSearch {
    prepared: Preparation,
    largest: f64,
}

/// A node on the stack, with the squared distances to its box.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(super) struct Pending {
    squared: Lanes,
    node: usize,
}

impl PacketSearch {
    /// Prepares the search for the nodes of `grid`.
    pub(super) fn new(bvh: &Bvh, grid: &Grid) -> Self {
        let bounds = grid.bounds();
        let extent = Aabb { min: bvh.frame().to_unit(bounds.min), max: bvh.frame().to_unit(bounds.max) };
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

    /// Finds the nearest triangle for each lane. Good `guesses`, triangles likely to be near, save
    /// time. `stack` is scratch memory.
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
            // Descend to the nearer child until a leaf is reached or no box is near enough.
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
                    (true, true) if left[DECIDING_LANE] <= right[DECIDING_LANE] => {
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

    use super::super::packet::NOTHING;
    use super::*;
    use crate::{DistanceField, DistanceFieldOptions, NoProgress, primitives};

    /// Nearest triangles and squared distances for packets along the diagonal of the grid. Each
    /// search starts from the result of the previous one.
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
    fn in_wide_registers(search: &PacketSearch, grid: &Grid) -> Vec<([u32; LANES], [u32; LANES])> {
        along_the_diagonal(search, grid)
    }

    #[test]
    fn search_has_the_same_bits_for_any_register_width() {
        let mesh = primitives::icosphere(1.0, 4);
        let options = DistanceFieldOptions { resolution: 12, ..Default::default() };
        let grid = *DistanceField::new(&mesh, &options, &NoProgress).unwrap().grid();
        let search = PacketSearch::new(&Bvh::new(&mesh.positions, &mesh.triangles).unwrap(), &grid);
        // Without the attribute, the search is compiled for the baseline features of the target.
        let narrowest = along_the_diagonal(&search, &grid);
        assert!(narrowest.iter().all(|(slots, _)| slots.iter().all(|&slot| slot != NOTHING)));
        assert_eq!(in_wide_registers(&search, &grid), narrowest);
    }
}
