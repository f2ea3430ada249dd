//! Rounds of merges without common triangles, each checked for crossings.

use isochore_mesh::Cancelled;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::{
    Coarsened,
    collapse::{Collapse, Limits, best_collapse},
};
use crate::deform::{
    certificate::Crossings,
    passage::Context,
    tessellation::{Piece, Tessellation},
};

/// The state between rounds.
pub(super) struct Coarsening {
    pieces: Vec<Piece>,
    /// How far merges have moved the surface at each vertex, model units.
    worn: Vec<f64>,
    /// Whether each vertex must be looked at in the next round.
    is_open: Vec<bool>,
    /// Vertices of the input.
    input_vertices: usize,
    limits: Limits,
    /// Largest change of the volume.
    max_volume: f64,
    /// Change of the volume so far.
    volume: f64,
    coarsened: Coarsened,
}

impl Coarsening {
    /// `max_volume` is the largest change of the volume.
    pub(super) fn new(mesh: &Tessellation, input_vertices: usize, limits: Limits, max_volume: f64) -> Self {
        let mut is_open = vec![false; mesh.image.len()];
        is_open[input_vertices..].fill(true);
        Self {
            pieces: mesh.pieces(),
            worn: vec![0.0; mesh.image.len()],
            is_open,
            input_vertices,
            limits,
            max_volume,
            volume: 0.0,
            coarsened: Coarsened::default(),
        }
    }

    /// Merges vertices without common triangles. Returns their number.
    pub(super) fn round(&mut self, mesh: &mut Tessellation, context: &Context<'_>) -> Result<usize, Cancelled> {
        let mut chosen = self.choose(mesh);
        while !chosen.is_empty() {
            let (pieces, merge_of) = self.replaced(&chosen);
            mesh.set_pieces(&pieces);
            let changed: Vec<u32> =
                (0..).zip(&merge_of).filter(|(_, merge)| merge.is_some()).map(|(index, _)| index).collect();
            let crossings = Crossings::of(mesh, &mesh.image, &changed, context)?;
            self.coarsened.pairs_tested += crossings.pairs_tested;
            if crossings.is_empty() {
                self.accept(&chosen, pieces);
                return Ok(chosen.len());
            }
            let crossing = crossings.pairs.iter().flatten().filter_map(|&index| merge_of[index as usize]);
            let crossing: FxHashSet<u32> = crossing.collect();
            if crossing.is_empty() {
                break;
            }
            let mut number = 0..;
            chosen.retain(|_| number.next().is_none_or(|number| !crossing.contains(&number)));
        }
        mesh.set_pieces(&self.pieces);
        Ok(0)
    }

    /// The result, once `mesh` has its final edges.
    pub(super) fn finish(self, mesh: &mut Tessellation) -> Coarsened {
        if self.coarsened.removed > 0 {
            mesh.settle(self.input_vertices);
        }
        self.coarsened
    }

    /// Merges without common triangles, the newest vertices first: that undoes splits.
    fn choose(&mut self, mesh: &Tessellation) -> Vec<Collapse> {
        let rings = self.rings();
        let candidates: Vec<u32> =
            (0..).zip(&self.is_open).filter(|(_, is_open)| **is_open).map(|(vertex, _)| vertex).collect();
        let best = |&vertex: &u32| {
            let ring: Vec<(u32, Piece)> =
                rings.of(vertex).iter().map(|&index| (index, self.pieces[index as usize])).collect();
            best_collapse(vertex, &ring, &mesh.image, self.worn[vertex as usize], &self.limits)
        };
        let mut possible: Vec<Collapse> = candidates.par_iter().filter_map(best).collect();
        possible.reverse();
        // Vertices without a merge are looked at again when their surroundings change.
        self.is_open.fill(false);
        let mut is_taken = vec![false; self.pieces.len()];
        let mut volume = self.volume;
        let mut chosen = Vec::new();
        for collapse in possible {
            self.is_open[collapse.removed as usize] = true;
            let next = volume + collapse.volume;
            let is_free = collapse.ring.iter().all(|&index| !is_taken[index as usize]);
            if !is_free || next.abs() > self.max_volume.max(volume.abs()) {
                continue;
            }
            collapse.ring.iter().for_each(|&index| is_taken[index as usize] = true);
            volume = next;
            chosen.push(collapse);
        }
        chosen
    }

    /// The pieces after the chosen merges, and the merge that made each, by index into `chosen`.
    fn replaced(&self, chosen: &[Collapse]) -> (Vec<Piece>, Vec<Option<u32>>) {
        let mut is_replaced = vec![false; self.pieces.len()];
        chosen.iter().flat_map(|collapse| &collapse.ring).for_each(|&index| is_replaced[index as usize] = true);
        let kept = self.pieces.iter().zip(&is_replaced).filter(|(_, is_replaced)| !**is_replaced);
        let mut all: Vec<(Piece, Option<u32>)> = kept.map(|(piece, _)| (*piece, None)).collect();
        for (number, collapse) in (0..).zip(chosen) {
            all.extend(collapse.pieces.iter().map(|piece| (*piece, Some(number))));
        }
        // The first piece of each input triangle has its index.
        let parents = 1 + all.iter().map(|(piece, _)| piece.parent as usize).max().unwrap_or(0);
        let mut first: Vec<Option<(Piece, Option<u32>)>> = vec![None; parents];
        let mut others = Vec::new();
        for entry in all {
            match &mut first[entry.0.parent as usize] {
                slot @ None => *slot = Some(entry),
                Some(_) => others.push(entry),
            }
        }
        first.into_iter().flatten().chain(others).unzip()
    }

    fn accept(&mut self, chosen: &[Collapse], pieces: Vec<Piece>) {
        for collapse in chosen {
            self.volume += collapse.volume;
            self.coarsened.removed += 1;
            self.coarsened.deviation = self.coarsened.deviation.max(collapse.deviation);
            self.is_open[collapse.removed as usize] = false;
            for vertex in collapse.pieces.iter().flat_map(|piece| piece.vertices) {
                let worn = &mut self.worn[vertex as usize];
                *worn = worn.max(collapse.deviation);
                self.is_open[vertex as usize] = vertex as usize >= self.input_vertices;
            }
        }
        self.pieces = pieces;
    }

    /// The pieces at each vertex.
    fn rings(&self) -> Rings {
        let mut starts = vec![0_u32; self.worn.len() + 1];
        for &vertex in self.pieces.iter().flat_map(|piece| &piece.vertices) {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..self.worn.len() {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut pieces = vec![0; 3 * self.pieces.len()];
        for (index, piece) in (0..).zip(&self.pieces) {
            for vertex in piece.vertices {
                let slot = &mut next[vertex as usize];
                pieces[*slot as usize] = index;
                *slot += 1;
            }
        }
        Rings { starts, pieces }
    }
}

/// The pieces at each vertex.
struct Rings {
    starts: Vec<u32>,
    pieces: Vec<u32>,
}

impl Rings {
    fn of(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.pieces[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}
