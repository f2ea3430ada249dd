//! How a triangle is split at the middles of its sides: into two, three or four parts by the number of sides that are.
//!
//! All that splits triangles takes this pattern, each with corners and sides of its own kind.

/// A side of a triangle on its way around it.
pub trait TriangleSide: Copy {
    /// The half that comes first.
    fn first(self) -> Self;

    /// The half that comes second.
    fn second(self) -> Self;

    /// The same, run along in the other direction.
    fn reversed(self) -> Self;
}

/// A triangle about to be split, with its sides 01, 12 and 20, and the middles of those of them that are.
#[derive(Debug, Clone, Copy)]
pub struct TriangleSplit<C, S> {
    /// The corners.
    pub corners: [C; 3],
    /// The sides 01, 12 and 20.
    pub sides: [S; 3],
    /// The middle of each side, if it is split there.
    pub middles: [Option<C>; 3],
}

impl<C: Copy, S: TriangleSide> TriangleSplit<C, S> {
    /// Calls `push` for the corners and sides of each part, turned as the whole. A triangle that is not split has no parts.
    ///
    /// Of the two ways to cut the quadrilateral that is left behind two middles, the one with the shorter diagonal is taken, by
    /// `distance_squared`. `inner_side` is asked once for every side between two parts, seen from one of them; where it has none,
    /// the rest is left out and there is no result.
    #[inline(always)]
    pub fn parts(
        &self,
        distance_squared: impl Fn(&C, &C) -> f64,
        mut inner_side: impl FnMut(&C, &C) -> Option<S>,
        mut push: impl FnMut([C; 3], [S; 3]),
    ) -> Option<()> {
        // Turned so that the cases need one pattern each.
        let turns = match self.middles {
            [Some(_), None, None] | [Some(_), Some(_), None] | [Some(_), Some(_), Some(_)] => 0,
            [None, Some(_), _] => 1,
            _ => 2,
        };
        let [i, j, k] = [turns, (turns + 1) % 3, (turns + 2) % 3];
        let [a, b, c] = [self.corners[i], self.corners[j], self.corners[k]];
        let [ab, bc, ca] = [self.sides[i], self.sides[j], self.sides[k]];
        match [self.middles[i], self.middles[j], self.middles[k]] {
            [Some(p), Some(q), Some(r)] => {
                let (pq, qr, rp) = (inner_side(&p, &q)?, inner_side(&q, &r)?, inner_side(&r, &p)?);
                push([p, q, r], [pq, qr, rp]);
                push([r, q, c], [qr.reversed(), bc.second(), ca.first()]);
                push([p, b, q], [ab.second(), bc.first(), pq.reversed()]);
                push([a, p, r], [ab.first(), rp.reversed(), ca.second()]);
            }
            [Some(p), Some(q), None] => {
                let pq = inner_side(&p, &q)?;
                if distance_squared(&a, &q) < distance_squared(&p, &c) {
                    let aq = inner_side(&a, &q)?;
                    push([a, q, c], [aq, bc.second(), ca]);
                    push([a, p, q], [ab.first(), pq, aq.reversed()]);
                } else {
                    let pc = inner_side(&p, &c)?;
                    push([p, q, c], [pq, bc.second(), pc.reversed()]);
                    push([a, p, c], [ab.first(), pc, ca]);
                }
                push([p, b, q], [ab.second(), bc.first(), pq.reversed()]);
            }
            [Some(p), ..] => {
                let pc = inner_side(&p, &c)?;
                push([a, p, c], [ab.first(), pc, ca]);
                push([p, b, c], [ab.second(), bc, pc.reversed()]);
            }
            [None, ..] => {}
        }
        Some(())
    }
}
