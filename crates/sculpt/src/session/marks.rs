//! Sets of indices that are emptied in no time.

/// Which of many indices have been met.
#[derive(Debug, Clone, Default)]
pub(super) struct Marks {
    stamps: Vec<u32>,
    now: u32,
}

impl Marks {
    /// Forgets all, and makes room for indices below `count`.
    pub(super) fn clear(&mut self, count: usize) {
        if self.now == u32::MAX {
            self.stamps.fill(0);
            self.now = 0;
        }
        self.now += 1;
        self.resize(count);
    }

    /// Makes room for indices below `count`, and forgets none.
    pub(super) fn resize(&mut self, count: usize) {
        if self.stamps.len() < count {
            self.stamps.resize(count, 0);
        }
    }

    /// Takes `index` in; whether it was not there.
    #[inline]
    pub(super) fn insert(&mut self, index: u32) -> bool {
        std::mem::replace(&mut self.stamps[index as usize], self.now) != self.now
    }

    /// Whether `index` is there.
    #[inline]
    pub(super) fn contains(&self, index: u32) -> bool {
        self.now != 0 && self.stamps.get(index as usize) == Some(&self.now)
    }
}
