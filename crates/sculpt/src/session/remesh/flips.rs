//! Flips of edges that make the smallest angle larger.

use isochore_mesh::{NONE, previous_half_edge};

use super::{
    change::{Change, Replacement},
    lines::Freedom,
    passes::Action,
    remesher::Remesher,
    shape::{direction, smallest_sine2},
};

/// Factor by which a flip must increase the square of the sine of the smallest angle. Nearer to one:
/// edges flip to and fro while vertices move. Larger: small angles remain.
const WORTHWHILE: f64 = 1.05;

/// Number of times that edges next to flipped ones are examined in one pass. Larger: rounding could
/// keep a flat grid busy. Smaller: a pass ends before all angles are as large as flips can make them.
const MOST_SWEEPS: usize = 10;

impl Remesher<'_> {
    /// Flips edges of `triangles`, and then edges next to those that were flipped.
    pub(super) fn flip(&mut self, mut triangles: Vec<u32>) {
        for _ in 0..MOST_SWEEPS {
            let worthwhile = self.ranked_edges(&triangles, |edge| self.gain_of_flip(edge));
            triangles = self.edit(&worthwhile, |remesher, ends, change| remesher.plan_flip(ends, change));
            if triangles.is_empty() {
                break;
            }
        }
    }

    /// Increase of the square of the sine of the smallest angle by a flip, if it is worthwhile.
    fn gain_of_flip(&self, half_edge: u32) -> Option<f64> {
        let topology = &self.surface.topology;
        let twin = topology.twin(half_edge);
        if twin == NONE || self.lines.is_line(half_edge) {
            return None;
        }
        let [a, b] = [half_edge, twin].map(|side| self.surface.position(topology.start(side)));
        let [c, d] = [half_edge, twin].map(|side| self.surface.position(topology.start(previous_half_edge(side))));
        let before = smallest_sine2(&[a, b, c]).min(smallest_sine2(&[b, a, d]));
        let after = smallest_sine2(&[a, d, c]).min(smallest_sine2(&[b, c, d]));
        (after > WORTHWHILE * before).then_some(after - before)
    }

    fn may_flip(&self, half_edge: u32) -> bool {
        let topology = &self.surface.topology;
        let twin = topology.twin(half_edge);
        let ends = [half_edge, twin].map(|edge| self.freedoms[topology.start(edge) as usize]);
        let apexes = [half_edge, twin].map(|edge| self.freedoms[topology.start(previous_half_edge(edge)) as usize]);
        !ends.contains(&Freedom::Frozen)
            && !apexes.contains(&Freedom::Frozen)
            && ends != [Freedom::Held; 2]
            && topology.can_flip(half_edge)
    }

    fn plan_flip(&self, ends: [u32; 2], change: &mut Change) -> Option<(u32, Action)> {
        let half_edge = self.half_edge(ends)?;
        self.gain_of_flip(half_edge).filter(|_| self.may_flip(half_edge))?;
        let topology = &self.surface.topology;
        let twin = topology.twin(half_edge);
        let [a, b] = [half_edge, twin].map(|side| self.surface.position(topology.start(side)));
        let [c, d] = [half_edge, twin].map(|side| self.surface.position(topology.start(previous_half_edge(side))));
        let before = direction(&[a, b, c]) + direction(&[b, a, d]);
        change.clear();
        for (edge, corners) in [(half_edge, [a, d, c]), (twin, [b, c, d])] {
            let anchor = self.anchors[edge as usize / 3];
            change.old.push(edge / 3);
            change.new.push(Replacement { triangle: edge / 3, corners, before, anchor });
        }
        change.edges.push(([c, d], self.anchors[half_edge as usize / 3]));
        self.allows(change).then_some((half_edge, Action::Flip))
    }

    pub(super) fn perform_flip(&mut self, half_edge: u32) {
        let twin = self.surface.topology.twin(half_edge);
        self.surface.flip(half_edge);
        self.lines.follow_flip(half_edge, twin);
        self.tally.flips += 1;
    }
}
