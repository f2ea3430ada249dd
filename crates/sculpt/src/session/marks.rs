//! Index sets whose operations take time proportional to their content.

/// A set of indices.
#[derive(Debug, Clone, Default)]
pub(super) struct Marks {
    /// One bit per index.
    words: Vec<u64>,
    /// Nonzero words.
    used: Vec<u32>,
}

impl Marks {
    /// Removes all indices.
    pub(super) fn clear(&mut self) {
        for word in self.used.drain(..) {
            self.words[word as usize] = 0;
        }
    }

    /// Extends the capacity to indices below `count`. Keeps the content.
    pub(super) fn resize(&mut self, count: usize) {
        let words = count.div_ceil(64);
        if self.words.len() < words {
            self.words.resize(words, 0);
        }
    }

    /// Adds `index`. Returns whether it is new.
    #[inline]
    pub(super) fn insert(&mut self, index: u32) -> bool {
        let word = &mut self.words[index as usize / 64];
        let bit = 1 << (index % 64);
        let is_new = *word & bit == 0;
        if *word == 0 {
            self.used.push(index / 64);
        }
        *word |= bit;
        is_new
    }

    /// Adds all of `indices`.
    pub(super) fn extend(&mut self, indices: impl IntoIterator<Item = u32>) {
        for index in indices {
            self.insert(index);
        }
    }

    /// Whether the set contains `index`.
    #[inline]
    pub(super) fn contains(&self, index: u32) -> bool {
        self.words.get(index as usize / 64).is_some_and(|word| word >> (index % 64) & 1 == 1)
    }

    /// All indices in ascending order. Does not [clear](Self::clear) the set.
    pub(super) fn sorted(&mut self) -> Vec<u32> {
        self.used.sort_unstable();
        let mut indices = Vec::with_capacity(8 * self.used.len());
        for &word in &self.used {
            let mut bits = self.words[word as usize];
            while bits != 0 {
                indices.push(64 * word + bits.trailing_zeros());
                bits &= bits - 1;
            }
        }
        indices
    }
}

/// Indices in the order in which they were added, each once.
#[derive(Debug, Clone, Default)]
pub(super) struct Touched {
    marks: Marks,
    items: Vec<u32>,
}

impl Touched {
    /// Removes all indices.
    pub(super) fn clear(&mut self) {
        self.marks.clear();
        self.items.clear();
    }

    /// Adds `indices`, all of which are below `count`.
    pub(super) fn extend(&mut self, indices: &[u32], count: usize) {
        self.marks.resize(count);
        self.items.extend(indices.iter().filter(|&&index| self.marks.insert(index)));
    }

    /// The indices.
    pub(super) fn items(&self) -> &[u32] {
        &self.items
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn returns_each_index_once_in_ascending_order() {
        let mut marks = Marks::default();
        marks.resize(1000);
        assert!([999, 3, 64, 63, 500].into_iter().all(|index| marks.insert(index)));
        assert!(!marks.insert(64));
        assert_eq!(marks.sorted(), [3, 63, 64, 500, 999]);
        assert!(marks.contains(500) && !marks.contains(501) && !marks.contains(5000));
        marks.clear();
        assert!(marks.sorted().is_empty() && !marks.contains(500));
    }
}
