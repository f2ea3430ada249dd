//! What is known of every few things of a long list, so that what touches few of them need not look at all.

use std::ops::Range;

use rayon::prelude::*;

use crate::flow::advection::CHUNK;

/// What is known of each block of [`CHUNK`] things that follow one another.
#[derive(Debug, Clone)]
pub(super) struct Blocks<T> {
    known: Vec<Option<T>>,
}

impl<T: Copy + Send + Sync> Blocks<T> {
    /// Nothing is known yet.
    pub(super) const NONE: Self = Self { known: Vec::new() };

    /// Nothing is known any more of the block of this thing.
    pub(super) fn forget(&mut self, index: usize) {
        if let Some(known) = self.known.get_mut(index / CHUNK) {
            *known = None;
        }
    }

    /// Nothing is known any more.
    pub(super) fn forget_all(&mut self) {
        self.known.clear();
    }

    /// Gets to know all blocks of `count` things; `learn` is asked for what is not known.
    pub(super) fn know(&mut self, count: usize, learn: impl Fn(Range<usize>) -> T + Sync) -> &Self {
        self.known.resize(count.div_ceil(CHUNK), None);
        self.known.par_iter_mut().enumerate().for_each(|(block, known)| {
            known.get_or_insert_with(|| learn(block * CHUNK..count.min((block + 1) * CHUNK)));
        });
        self
    }

    /// What is known, by block.
    pub(super) fn iter(&self) -> impl Iterator<Item = T> {
        self.known.iter().copied().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_was_forgotten_is_learned_again() {
        let mut blocks = Blocks::NONE;
        let lengths = |blocks: &mut Blocks<usize>, count: usize, extra: usize| {
            blocks.know(count, |range| range.len() + extra).iter().collect::<Vec<_>>()
        };
        assert_eq!(lengths(&mut blocks, CHUNK + 3, 0), [CHUNK, 3]);
        blocks.forget(CHUNK + 2);
        assert_eq!(lengths(&mut blocks, CHUNK + 4, 1), [CHUNK, 5]);
        blocks.forget_all();
        assert_eq!(lengths(&mut blocks, 1, 1), [2]);
    }
}
