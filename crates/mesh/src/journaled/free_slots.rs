use std::collections::BTreeSet;

use super::{Delta, Journaled};

/// The slots of a [`Journaled`] array that can be reused.
///
/// A slot that becomes free during a recording can be reused only after it, so that its original
/// value remains available until then. The set of free slots depends only on the items of the
/// array, and the smallest slot is used first. The same edits therefore use the same slots after
/// undo and redo.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FreeSlots {
    /// Slots before this one are never free.
    first: u32,
    slots: BTreeSet<u32>,
}

impl FreeSlots {
    /// An empty set. Slots before `first` will never be free.
    pub fn new(first: u32) -> Self {
        Self { first, slots: BTreeSet::new() }
    }

    /// Takes the smallest free slot, or the slot after the end of an array of `length` items.
    pub fn take(&mut self, length: usize) -> u32 {
        self.slots.pop_first().unwrap_or(length as u32)
    }

    /// Updates the set after a [`finish`](Journaled::finish) or [`swap`](Journaled::swap) of
    /// `array` with `delta`.
    pub fn follow<T: Copy>(&mut self, array: &Journaled<T>, delta: &Delta<T>, is_free: impl Fn(&T) -> bool) {
        let items = array.items();
        self.slots.split_off(&(items.len() as u32));
        for (index, other) in &delta.items {
            match items.get(*index as usize) {
                Some(item) if is_free(item) => self.insert(*index),
                Some(_) if is_free(other) => drop(self.slots.remove(index)),
                _ => {}
            }
        }
        for (index, item) in items.iter().enumerate().skip(delta.length) {
            if is_free(item) {
                self.insert(index as u32);
            }
        }
    }

    fn insert(&mut self, index: u32) {
        if index >= self.first {
            self.slots.insert(index);
        }
    }
}
