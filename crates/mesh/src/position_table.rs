//! Numbers by position, for welding.

use glam::DVec3;

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
        (hash(key) >> self.shift) as usize
    }
}

/// Bits of [`with_repeated_hash`] for a vertex, at least. Fewer, and more vertices share one by chance and are looked up
/// in vain, about one in as many; more, and the bits do not fit into a cache.
const BITS_PER_VERTEX: usize = 8;

/// The `vertices` whose positions may occur twice among theirs, in their order: all that do, and few others.
///
/// Most files split few vertices or none. Two passes over a bit or two a vertex leave little for a [`PositionTable`],
/// which waits for memory at every step.
pub(crate) fn with_repeated_hash(positions: &[DVec3], vertices: impl Iterator<Item = u32> + Clone) -> Vec<u32> {
    let size = (BITS_PER_VERTEX * vertices.clone().count()).next_power_of_two().max(u64::BITS as usize);
    let shift = u64::BITS - size.trailing_zeros();
    // Which hashes there are, and which there are again.
    let mut words = vec![[0_u64; 2]; size / u64::BITS as usize];
    let place = |vertex: u32| {
        let bit = hash(key(positions[vertex as usize])) >> shift;
        ((bit / u64::from(u64::BITS)) as usize, 1 << (bit % u64::from(u64::BITS)))
    };
    for (word, bit) in vertices.clone().map(place) {
        let [once, again] = &mut words[word];
        *again |= *once & bit;
        *once |= bit;
    }
    let mut repeated = Vec::new();
    for vertex in vertices {
        let (word, bit) = place(vertex);
        if words[word][1] & bit != 0 {
            repeated.push(vertex);
        }
    }
    repeated
}

/// A number whose upper bits are spread evenly.
#[inline]
fn hash(key: [u64; 3]) -> u64 {
    let mixed = key.iter().fold(0_u64, |hash, &bits| {
        let product = (hash ^ bits).wrapping_mul(GOLDEN);
        // Brings the signs down: a product alone keeps them in its uppermost bit, and mirror images would share a hash.
        product ^ (product >> 32)
    });
    mixed.wrapping_mul(GOLDEN)
}

/// Bits of the coordinates, the same for both zeros.
#[inline]
fn key(position: DVec3) -> [u64; 3] {
    (position + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// 2⁶⁴ over the golden ratio: multiplying by it spreads neighbors (Knuth, "The Art of Computer Programming", 6.4).
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
