//! The pattern that splits a triangle at the midpoints of its sides: into two, three or four parts
//! by the number of split sides.
//!
//! It is generic over the types of corners and sides, because all code that splits triangles uses
//! it.

/// A directed side of a triangle.
pub trait TriangleSide: Copy {
    /// The first half.
    fn first(self) -> Self;

    /// The second half.
    fn second(self) -> Self;

    /// The side in the opposite direction.
    fn reversed(self) -> Self;
}

/// A triangle to split, with the midpoints of the sides to split.
#[derive(Debug, Clone, Copy)]
pub struct TriangleSplit<C, S> {
    /// The corners.
    pub corners: [C; 3],
    /// The sides 01, 12 and 20.
    pub sides: [S; 3],
    /// The midpoint of each side, or `None` for a side that is not split.
    pub midpoints: [Option<C>; 3],
}

impl<C: Copy, S: TriangleSide> TriangleSplit<C, S> {
    /// Calls `push` with the corners and sides of each part, in the orientation of the triangle.
    /// Without midpoints, nothing is pushed.
    ///
    /// If two sides are split, the remaining quadrilateral is cut along its shorter diagonal by
    /// `distance_squared`. `inner_side` is called once for every side between two parts. If it
    /// returns `None`, so does this function, and the remaining parts are dropped.
    #[inline(always)]
    pub fn parts(
        &self,
        distance_squared: impl Fn(&C, &C) -> f64,
        mut inner_side: impl FnMut(&C, &C) -> Option<S>,
        mut push: impl FnMut([C; 3], [S; 3]),
    ) -> Option<()> {
        // Rotate the corners so that each case needs only one pattern.
        let rotation = match self.midpoints {
            [Some(_), None, None] | [Some(_), Some(_), None] | [Some(_), Some(_), Some(_)] => 0,
            [None, Some(_), _] => 1,
            _ => 2,
        };
        let [i, j, k] = [rotation, (rotation + 1) % 3, (rotation + 2) % 3];
        let [a, b, c] = [self.corners[i], self.corners[j], self.corners[k]];
        let [ab, bc, ca] = [self.sides[i], self.sides[j], self.sides[k]];
        match [self.midpoints[i], self.midpoints[j], self.midpoints[k]] {
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
