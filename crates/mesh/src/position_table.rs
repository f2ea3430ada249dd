//! Numbers by position, for welding.

use std::hash::Hasher;

use glam::DVec3;
use rustc_hash::FxHasher;

/// A hash table with linear probing that holds nothing but numbers; whoever asks knows their positions.
#[derive(Debug)]
pub(crate) struct PositionTable {
    slots: Vec<u32>,
    shift: u32,
    len: usize,
}

/// A slot without a number.
const VACANT: u32 = u32::MAX;

impl PositionTable {
    /// A table that need not grow for `count` positions.
    pub(crate) fn with_capacity(count: usize) -> Self {
        let size = (2 * count).next_power_of_two().max(2);
        Self { slots: vec![VACANT; size], shift: u64::BITS - size.trailing_zeros(), len: 0 }
    }

    /// The number that was first given for `position`: `new` if that is now. The two zeros are the same.
    #[inline]
    pub(crate) fn find_or_insert(&mut self, position: DVec3, new: u32, position_of: impl Fn(u32) -> DVec3) -> u32 {
        if 2 * self.len > self.slots.len() {
            self.grow(&position_of);
        }
        let slot = self.slot(position, &position_of);
        if self.slots[slot] == VACANT {
            self.slots[slot] = new;
            self.len += 1;
        }
        self.slots[slot]
    }

    /// The slot of the number of `position`, vacant where there is none yet.
    #[inline]
    fn slot(&self, position: DVec3, position_of: impl Fn(u32) -> DVec3) -> usize {
        let key = key(position);
        let mut slot = self.first_slot(key);
        while self.slots[slot] != VACANT && self::key(position_of(self.slots[slot])) != key {
            slot = (slot + 1) & (self.slots.len() - 1);
        }
        slot
    }

    fn grow(&mut self, position_of: impl Fn(u32) -> DVec3) {
        let mut grown = Self { len: self.len, ..Self::with_capacity(2 * self.len) };
        for &known in self.slots.iter().filter(|&&known| known != VACANT) {
            let slot = grown.slot(position_of(known), &position_of);
            grown.slots[slot] = known;
        }
        *self = grown;
    }

    #[inline]
    fn first_slot(&self, key: [u64; 3]) -> usize {
        let mut hasher = FxHasher::default();
        key.iter().for_each(|&bits| hasher.write_u64(bits));
        (hasher.finish().wrapping_mul(GOLDEN) >> self.shift) as usize
    }
}

/// Bits of the coordinates, the same for both zeros.
#[inline]
fn key(position: DVec3) -> [u64; 3] {
    (position + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// 2⁶⁴ over the golden ratio: multiplying by it spreads neighbors (Knuth, "The Art of Computer Programming", 6.4).
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
