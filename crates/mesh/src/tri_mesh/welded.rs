//! Merging vertices that files split at seams.

use std::hash::Hasher;

use glam::DVec3;
use rustc_hash::FxHasher;

use crate::{Topology, TriMesh};

impl TriMesh {
    /// This mesh with all vertices at the same position made one, as files need that split vertices at seams.
    ///
    /// Vertices keep the order of their first occurrence. Vertex colors that differ at one position move to the
    /// corners; of differing skin influences the first ones stay. Triangles that lose a side are left out: the surface
    /// is the same without them.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn welded(self) -> TriMesh {
        self.welded_where(|_| true)
    }

    /// This mesh with the vertices of its boundary welded where they are at the same position.
    ///
    /// Unlike [`welded`](Self::welded) it leaves alone surfaces that touch each other in vertices they keep apart.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn welded_at_boundary(self) -> TriMesh {
        let topology = Topology::of(&self);
        let mut at_boundary = vec![false; self.positions.len()];
        for edge in 0..topology.edges.len() {
            if topology.half_edges(edge).len() == 1 {
                topology.edges[edge].iter().for_each(|&vertex| at_boundary[vertex as usize] = true);
            }
        }
        match at_boundary.contains(&true) {
            true => self.welded_where(|vertex| at_boundary[vertex]),
            false => self,
        }
    }

    fn welded_where(mut self, is_candidate: impl Fn(usize) -> bool) -> TriMesh {
        let mut table = PositionTable::of(&self.positions);
        let mut kept: Vec<u32> = Vec::with_capacity(self.positions.len());
        let merged: Vec<u32> = (0..self.positions.len())
            .map(|vertex| {
                let new = kept.len() as u32;
                let target = match is_candidate(vertex) {
                    true => table.find_or_insert(vertex, new),
                    false => new,
                };
                if target == new {
                    kept.push(vertex as u32);
                }
                target
            })
            .collect();
        if kept.len() == self.positions.len() {
            return self;
        }
        self.move_differing_colors_to_corners(&merged, &kept);
        self.keep_vertices(&kept);
        for triangle in &mut self.triangles {
            *triangle = triangle.map(|vertex| merged[vertex as usize]);
        }
        self.drop_collapsed_triangles();
        self
    }

    fn move_differing_colors_to_corners(&mut self, merged: &[u32], kept: &[u32]) {
        let colors = &self.vertex.colors;
        let first = |vertex: usize| kept[merged[vertex] as usize] as usize;
        if (0..colors.len()).any(|vertex| colors[vertex] != colors[first(vertex)]) {
            self.corner.colors = self.triangles.iter().map(|t| t.map(|vertex| colors[vertex as usize])).collect();
            self.vertex.colors.clear();
        }
    }

    fn keep_vertices(&mut self, kept: &[u32]) {
        fn keep<T: Clone>(values: &mut Vec<T>, kept: &[u32]) {
            if !values.is_empty() {
                *values = kept.iter().map(|&vertex| values[vertex as usize].clone()).collect();
            }
        }
        keep(&mut self.positions, kept);
        keep(&mut self.vertex.colors, kept);
        keep(&mut self.vertex.skin, kept);
    }

    /// Removes triangles that use a vertex twice, together with what their corners carry.
    fn drop_collapsed_triangles(&mut self) {
        let collapsed: Vec<bool> = self.triangles.iter().map(|&[a, b, c]| a == b || b == c || c == a).collect();
        if !collapsed.contains(&true) {
            return;
        }
        fn drop_where<T>(values: &mut Vec<T>, dropped: &[bool]) {
            let mut dropped = dropped.iter();
            values.retain(|_| !dropped.next().is_some_and(|&dropped| dropped));
        }
        drop_where(&mut self.triangles, &collapsed);
        drop_where(&mut self.triangle_materials, &collapsed);
        self.corner.uvs.iter_mut().for_each(|set| drop_where(set, &collapsed));
        drop_where(&mut self.corner.normals, &collapsed);
        drop_where(&mut self.corner.colors, &collapsed);
    }
}

/// Vertices by position: a hash table with linear probing of nothing but vertex numbers.
struct PositionTable<'a> {
    positions: &'a [DVec3],
    /// New number of a kept vertex and the vertex itself; [`VACANT`](Self::VACANT) where there is none.
    slots: Vec<(u32, u32)>,
    shift: u32,
}

impl<'a> PositionTable<'a> {
    const VACANT: (u32, u32) = (u32::MAX, u32::MAX);

    fn of(positions: &'a [DVec3]) -> Self {
        let size = (2 * positions.len()).next_power_of_two().max(2);
        Self { positions, slots: vec![Self::VACANT; size], shift: 64 - size.trailing_zeros() }
    }

    /// The number of the vertex that was first seen at the position of `vertex`: `new` if that is this one.
    fn find_or_insert(&mut self, vertex: usize, new: u32) -> u32 {
        let key = self.key(vertex);
        let mut hasher = FxHasher::default();
        key.iter().for_each(|&bits| hasher.write_u64(bits));
        let mut slot = (hasher.finish().wrapping_mul(GOLDEN) >> self.shift) as usize;
        loop {
            match self.slots[slot] {
                Self::VACANT => {
                    self.slots[slot] = (new, vertex as u32);
                    return new;
                }
                (number, known) if self.key(known as usize) == key => return number,
                _ => slot = (slot + 1) & (self.slots.len() - 1),
            }
        }
    }

    /// Bits of the coordinates, the same for both zeros.
    fn key(&self, vertex: usize) -> [u64; 3] {
        (self.positions[vertex] + DVec3::ZERO).to_array().map(f64::to_bits)
    }
}

/// 2⁶⁴ over the golden ratio: multiplying by it spreads neighbors (Knuth, "The Art of Computer Programming", 6.4).
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
