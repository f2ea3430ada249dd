use std::collections::BTreeSet;

use super::{Delta, Journaled};

/// Which items of a [`Journaled`] array are free to be used anew.
///
/// An item that becomes free while edits are recorded is taken in when the recording ends, so that what it was can be told until then.
/// Which items are free depends on what the array holds alone, and the smallest is taken first: after undo and redo the same edits
/// take the same items.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FreeSlots {
    /// Items before this one are never free.
    first: u32,
    slots: BTreeSet<u32>,
}

impl FreeSlots {
    /// No item is free now, and those before `first` never will be.
    pub fn new(first: u32) -> Self {
        Self { first, slots: BTreeSet::new() }
    }

    /// Takes the smallest free item, or the one that an array of `length` items would append.
    pub fn take(&mut self, length: usize) -> u32 {
        self.slots.pop_first().unwrap_or(length as u32)
    }

    /// Follows an array that was [finished](Journaled::finish) or [swapped](Journaled::swap), where `delta` leads to its other end.
    pub fn follow<T: Copy>(&mut self, array: &Journaled<T>, delta: &Delta<T>, is_free: impl Fn(&T) -> bool) {
        let now = array.items();
        self.slots.split_off(&(now.len() as u32));
        for (index, other) in &delta.items {
            match now.get(*index as usize) {
                Some(item) if is_free(item) => self.insert(*index),
                Some(_) if is_free(other) => drop(self.slots.remove(index)),
                _ => {}
            }
        }
        for (index, item) in now.iter().enumerate().skip(delta.length) {
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
