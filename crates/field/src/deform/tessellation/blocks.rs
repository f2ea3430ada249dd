//! A cached summary of each block of a long list, so that a local change costs little.

use std::ops::Range;

use rayon::prelude::*;

use crate::flow::advection::CHUNK;

/// A cached value for each block of [`CHUNK`] consecutive elements.
#[derive(Debug, Clone)]
pub(super) struct Blocks<T> {
    known: Vec<Option<T>>,
}

impl<T: Copy + Send + Sync> Blocks<T> {
    /// An empty cache.
    pub(super) const NONE: Self = Self { known: Vec::new() };

    /// Drops the value of the block that contains an element.
    pub(super) fn invalidate(&mut self, index: usize) {
        if let Some(known) = self.known.get_mut(index / CHUNK) {
            *known = None;
        }
    }

    /// Drops all values.
    pub(super) fn clear(&mut self) {
        self.known.clear();
    }

    /// Fills the cache for `count` elements. `compute` gives the missing values, by range of elements.
    pub(super) fn fill(&mut self, count: usize, compute: impl Fn(Range<usize>) -> T + Sync) -> &Self {
        self.known.resize(count.div_ceil(CHUNK), None);
        self.known.par_iter_mut().enumerate().for_each(|(block, known)| {
            known.get_or_insert_with(|| compute(block * CHUNK..count.min((block + 1) * CHUNK)));
        });
        self
    }

    /// The cached values, by block.
    pub(super) fn iter(&self) -> impl Iterator<Item = T> {
        self.known.iter().copied().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recomputes_only_dropped_blocks() {
        let mut blocks = Blocks::NONE;
        let lengths = |blocks: &mut Blocks<usize>, count: usize, extra: usize| {
            blocks.fill(count, |range| range.len() + extra).iter().collect::<Vec<_>>()
        };
        assert_eq!(lengths(&mut blocks, CHUNK + 3, 0), [CHUNK, 3]);
        blocks.invalidate(CHUNK + 2);
        assert_eq!(lengths(&mut blocks, CHUNK + 4, 1), [CHUNK, 5]);
        blocks.clear();
        assert_eq!(lengths(&mut blocks, 1, 1), [2]);
    }
}
