//! Common corners of two triangles.

/// The common corners of two triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct CommonCorners {
    /// Number of common corners. It is 3 also for triangles with a repeated corner.
    pub(super) count: u8,
    /// Corners of the first triangle, common ones first.
    pub(super) first: [u8; 3],
    /// Corners of the second triangle, common ones in the same order.
    pub(super) second: [u8; 3],
}

impl CommonCorners {
    #[inline(always)]
    pub(super) fn of<T: PartialEq>(first: &[T; 3], second: &[T; 3]) -> &'static Self {
        // Bit 3 i + j is set if corner i of the first triangle equals corner j of the second.
        let mut same = 0_usize;
        for i in 0..3 {
            for j in 0..3 {
                same |= usize::from(first[i] == second[j]) << (3 * i + j);
            }
        }
        // A table instead of branches, which a processor could not predict.
        &TABLE[same & (TABLE.len() - 1)]
    }

    const fn of_bits(same: usize) -> Self {
        const FROM: [[u8; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
        if same == 0 {
            return Self { count: 0, first: FROM[0], second: FROM[0] };
        }
        let lowest = same.trailing_zeros() as usize;
        let (i, j) = (lowest / 3, lowest % 3);
        let rest = same & (same - 1);
        if rest == 0 {
            return Self { count: 1, first: FROM[i], second: FROM[j] };
        }
        let next = rest.trailing_zeros() as usize;
        let (k, l) = (next / 3, next % 3);
        if rest & (rest - 1) == 0 && i != k && j != l {
            let first = [i as u8, k as u8, (3 - i - k) as u8];
            return Self { count: 2, first, second: [j as u8, l as u8, (3 - j - l) as u8] };
        }
        Self { count: 3, first: FROM[0], second: FROM[0] }
    }
}

static TABLE: [CommonCorners; 512] = {
    let mut table = [CommonCorners::of_bits(0); 512];
    let mut same = 0;
    while same < table.len() {
        table[same] = CommonCorners::of_bits(same);
        same += 1;
    }
    table
};

#[test]
fn common_corners_come_first_and_in_order() {
    let of = |first: [char; 3], second: [char; 3]| {
        let &CommonCorners { count, first: one, second: other } = CommonCorners::of(&first, &second);
        let text = |corners: [char; 3], order: [u8; 3]| order.map(|corner| corners[corner as usize]).iter().collect();
        (count, text(first, one), text(second, other))
    };
    let expected = |count, one: &str, other: &str| (count, one.to_owned(), other.to_owned());
    assert_eq!(of(['a', 'b', 'c'], ['d', 'e', 'f']), expected(0, "abc", "def"));
    assert_eq!(of(['a', 'b', 'c'], ['d', 'e', 'b']), expected(1, "bca", "bde"));
    assert_eq!(of(['a', 'b', 'c'], ['c', 'e', 'a']), expected(2, "acb", "ace"));
    assert_eq!(of(['a', 'b', 'c'], ['c', 'b', 'a']).0, 3);
    assert_eq!(of(['a', 'b', 'b'], ['d', 'e', 'b']).0, 3);
}
