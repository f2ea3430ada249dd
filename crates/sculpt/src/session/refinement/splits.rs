use super::{InteractiveRefinement, Limits, MayTouch, Pass, survey};

/// Rounds of splitting in one pass: each halves what is too long, so this many resolve edges a thousand times too long. What is
/// left then is split by the next move.
const MAX_ROUNDS: usize = 10;

/// How many times over one stroke halves what it has moved. Larger follows the flow farther where it stirs without end, as at the rim
/// of a core that goes through the surface, where each time may double the triangles; smaller leaves deep pulls coarse.
const MOST_HALVINGS: u8 = 4;

impl Pass<'_> {
    /// Splits edges that are too long, longest first, and goes on with what that leaves.
    ///
    /// A new vertex lies in the middle of the edge on the surface as it stood when the stroke began, and is carried from there
    /// through all that the stroke did: it is where the flow takes that point, not in the middle of the ends.
    ///
    /// Where the stroke stirs the surface, that would never end: then edges stay, and the receipt tells how many.
    pub(super) fn split(
        &mut self,
        mut long: Vec<(f64, [u32; 2])>,
        options: &InteractiveRefinement,
        limits: &Limits,
        may_touch: Option<MayTouch<'_>>,
    ) {
        let mut refused = Vec::new();
        for _ in 0..MAX_ROUNDS {
            long.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            long.dedup_by_key(|(_, edge)| *edge);
            long.retain(|&(_, edge)| self.editable(edge, options).is_some());
            long.retain(|(_, ends)| {
                let helps = self.halvings(*ends) <= MOST_HALVINGS;
                if !helps {
                    refused.push(*ends);
                }
                helps
            });
            let room = limits.max_triangles.saturating_sub(self.surface.topology.alive()) / 2;
            self.done.is_limited |= long.len() > room;
            long.truncate(room);
            if long.is_empty() {
                break;
            }
            let base = |&(_, ends): &(f64, [u32; 2])| {
                let [a, b] = ends.map(|vertex| self.surface.base(vertex));
                0.5 * (a + b)
            };
            let bases: Vec<_> = long.iter().map(base).collect();
            let mut images = bases.clone();
            self.done.evaluations += self.stroke.advect(&mut images);

            let known = self.edited.len();
            for ((&(_, ends), base), image) in long.iter().zip(bases).zip(images) {
                // Other splits of this round leave the edge as it is. A point that is carried out of the range of numbers is none.
                let Some(half_edge) = self.editable(ends, options).filter(|_| image.is_finite()) else { continue };
                let halvings = self.halvings(ends);
                let (split, gained) = self.surface.split(half_edge, image);
                self.surface.inserted.push(split.vertex, base, halvings);
                self.stroke.splits.add(gained);
                self.edited.extend(split.near.into_iter().chain(split.far.into_iter().flatten()));
                self.done.inserted_vertices += 1;
            }
            let edited = self.edited[known..].to_vec();
            let again = Limits { shortest2: 0.0, flip: false, ..*limits };
            long = survey(self.surface, &edited, &again, may_touch).long;
        }
        refused.sort_unstable();
        refused.dedup();
        self.done.refused_splits = self.done.refused_splits.max(refused.len());
    }

    /// How many times a vertex between two others would be one of halving what the stroke has moved.
    fn halvings(&self, ends: [u32; 2]) -> u8 {
        let has_moved = ends.iter().any(|&end| self.surface.base(end) != self.surface.position(end));
        let [one, other] = ends.map(|end| self.surface.halvings(end));
        one.max(other) + u8::from(has_moved)
    }
}
