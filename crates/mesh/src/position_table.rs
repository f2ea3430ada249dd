//! Vertex indices by position, for welding.

use glam::DVec3;
use hashbrown::HashTable;

/// A hash table of vertex indices with positions as keys. It does not store the positions; the
/// caller supplies them. It is never iterated, so results do not depend on the hash.
#[derive(Debug)]
pub(crate) struct PositionTable {
    indices: HashTable<u32>,
}

impl PositionTable {
    /// A table with capacity for `count` positions.
    pub(crate) fn with_capacity(count: usize) -> Self {
        Self { indices: HashTable::with_capacity(count) }
    }

    /// The index that was first inserted for `position`, which is `new` if there was none. Positive
    /// and negative zero are equal.
    #[inline]
    pub(crate) fn find_or_insert(&mut self, position: DVec3, new: u32, position_of: impl Fn(u32) -> DVec3) -> u32 {
        let key = key(position);
        let is_same = |&known: &u32| self::key(position_of(known)) == key;
        let hash_of = |&known: &u32| table_hash(self::key(position_of(known)));
        *self.indices.entry(table_hash(key), is_same, hash_of).or_insert(new).get()
    }
}

/// Minimum number of bits of [`with_repeated_hash`] per vertex. With fewer bits more vertices have
/// equal hashes by chance, about one in as many, and are looked up in vain. More bits exceed the
/// cache.
const BITS_PER_VERTEX: usize = 8;

/// Filters `vertices` to those whose position may occur twice among them, in order. All that do are
/// included, and few others.
///
/// Most files split few vertices or none. Two passes over a bit or two per vertex leave little work
/// for a [`PositionTable`], which waits for memory at every step.
pub(crate) fn with_repeated_hash(positions: &[DVec3], vertices: impl Iterator<Item = u32> + Clone) -> Vec<u32> {
    let size = (BITS_PER_VERTEX * vertices.clone().count()).next_power_of_two().max(u64::BITS as usize);
    let shift = u64::BITS - size.trailing_zeros();
    // Two bit sets: the hashes that occur, and those that occur again.
    let mut words = vec![[0_u64; 2]; size / u64::BITS as usize];
    let word_and_bit = |vertex: u32| {
        let bit = hash(key(positions[vertex as usize])) >> shift;
        ((bit / u64::from(u64::BITS)) as usize, 1 << (bit % u64::from(u64::BITS)))
    };
    for (word, bit) in vertices.clone().map(word_and_bit) {
        let [once, again] = &mut words[word];
        *again |= *once & bit;
        *once |= bit;
    }
    let mut repeated = Vec::new();
    for vertex in vertices {
        let (word, bit) = word_and_bit(vertex);
        if words[word][1] & bit != 0 {
            repeated.push(vertex);
        }
    }
    repeated
}

/// A hash for [`HashTable`], which needs evenly distributed lower bits as well.
#[inline]
fn table_hash(key: [u64; 3]) -> u64 {
    let hash = hash(key);
    hash ^ (hash >> 32)
}

/// A hash whose upper bits are evenly distributed.
#[inline]
fn hash(key: [u64; 3]) -> u64 {
    let mixed = key.iter().fold(0_u64, |hash, &bits| {
        let product = (hash ^ bits).wrapping_mul(GOLDEN);
        // Moves the sign bits down. A product alone keeps them in its uppermost bit, and mirror
        // images would have equal hashes.
        product ^ (product >> 32)
    });
    mixed.wrapping_mul(GOLDEN)
}

/// Bits of the coordinates, equal for both zeros.
#[inline]
fn key(position: DVec3) -> [u64; 3] {
    (position + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// 2⁶⁴ divided by the golden ratio. Multiplication by it separates neighbors (Knuth, "The Art of
/// Computer Programming", section 6.4).
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
