//! An array that records its previous items, so that edits can be undone and redone exactly.

mod free_slots;

pub use free_slots::FreeSlots;

/// An array whose edits can be recorded. Undo takes time and memory in proportion to the number of
/// edited items, independent of the length.
///
/// ```
/// use isochore_mesh::Journaled;
///
/// let mut array = Journaled::new(vec![1, 2, 3]);
/// array.begin();
/// array.set(0, 10);
/// array.push(4);
/// let mut delta = array.finish();
/// array.swap(&mut delta);
/// assert_eq!(array.items(), [1, 2, 3]);
/// array.swap(&mut delta);
/// assert_eq!(array.items(), [10, 2, 3, 4]);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Journaled<T> {
    items: Vec<T>,
    /// For each item, its presumed index in `old`. It is valid only if the entry in `old` names the
    /// item, so it need not be cleared when a recording begins.
    slots: Vec<u32>,
    /// Items edited since recording began, with their previous values.
    old: Vec<(u32, T)>,
    /// Length when recording began, or `None` without a recording.
    start: Option<usize>,
}

/// The items of an array before a recording, for undo, or after it once undone, for redo.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Delta<T> {
    items: Vec<(u32, T)>,
    /// Appended items, while they are undone.
    tail: Vec<T>,
    /// Number of appended items, whether they are in `tail` or in the array.
    tail_length: usize,
    /// Length of the array in the other state.
    length: usize,
}

impl<T: Copy> Journaled<T> {
    /// Creates an array without a recording.
    pub fn new(items: Vec<T>) -> Self {
        Self { slots: vec![0; items.len()], items, old: Vec::new(), start: None }
    }

    /// The current items.
    pub fn items(&self) -> &[T] {
        &self.items
    }

    /// Item `index`.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn get(&self, index: u32) -> T {
        self.items[index as usize]
    }

    /// Reserves capacity for `additional` more items.
    pub fn reserve(&mut self, additional: usize) {
        self.items.reserve(additional);
        self.slots.reserve(additional);
    }

    /// Begins to record edits. Discards a recording that is not [finished](Self::finish).
    pub fn begin(&mut self) {
        self.old.clear();
        self.start = Some(self.items.len());
    }

    /// Replaces item `index`.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn set(&mut self, index: u32, item: T) {
        self.record(index);
        self.items[index as usize] = item;
    }

    /// Replaces item `index` without recording the edit. Undo keeps the new value, unless the item
    /// was set since recording began.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn amend(&mut self, index: u32, item: T) {
        self.items[index as usize] = item;
    }

    /// Appends an item and returns its index.
    pub fn push(&mut self, item: T) -> u32 {
        self.items.push(item);
        self.slots.push(0);
        self.items.len() as u32 - 1
    }

    /// Replaces item `index`, or appends it if `index` equals the number of items.
    ///
    /// # Panics
    /// If the index is larger than the number of items.
    pub fn put(&mut self, index: u32, item: T) {
        if index as usize == self.items.len() {
            self.push(item);
        } else {
            self.set(index, item);
        }
    }

    /// Value of item `index` when recording began. `None` for items appended since.
    ///
    /// # Panics
    /// Possibly, if the index is out of range.
    pub fn original(&self, index: u32) -> Option<T> {
        let start = self.start.unwrap_or(self.items.len());
        ((index as usize) < start).then(|| match self.recorded(index) {
            Some(slot) => self.old[slot].1,
            None => self.items[index as usize],
        })
    }

    /// Length when recording began.
    pub fn original_len(&self) -> usize {
        self.start.unwrap_or(self.items.len())
    }

    /// Indices of the items edited since recording began, without appended ones, in order of the
    /// first edit.
    pub fn edited(&self) -> impl Iterator<Item = u32> + '_ {
        self.old.iter().map(|&(index, _)| index)
    }

    /// Ends recording and returns the delta that undoes it. It is sorted by index, so that undo
    /// passes through memory once.
    pub fn finish(&mut self) -> Delta<T> {
        let length = self.start.take().unwrap_or(self.items.len());
        let mut items = std::mem::take(&mut self.old);
        items.sort_unstable_by_key(|&(index, _)| index);
        Delta { items, tail: Vec::new(), tail_length: self.items.len() - length, length }
    }

    /// Undoes the edits of `delta`, which then redoes them at the next call. Deltas must be undone
    /// in reverse order of their recording, and redone in order.
    ///
    /// # Panics
    /// Possibly, if the delta does not belong to the last edits.
    pub fn swap(&mut self, delta: &mut Delta<T>) {
        let current_length = self.items.len();
        if delta.length < current_length {
            delta.tail = self.items.split_off(delta.length);
        } else {
            self.items.append(&mut std::mem::take(&mut delta.tail));
        }
        self.slots.resize(self.items.len(), 0);
        delta.length = current_length;
        for (index, item) in &mut delta.items {
            std::mem::swap(item, &mut self.items[*index as usize]);
        }
    }

    fn record(&mut self, index: u32) {
        let Some(start) = self.start else { return };
        if (index as usize) < start && self.recorded(index).is_none() {
            self.slots[index as usize] = self.old.len() as u32;
            self.old.push((index, self.items[index as usize]));
        }
    }

    fn recorded(&self, index: u32) -> Option<usize> {
        let slot = self.slots[index as usize] as usize;
        self.old.get(slot).is_some_and(|&(known, _)| known == index).then_some(slot)
    }
}

impl<T> Delta<T> {
    /// Indices of the edited items, without appended ones.
    pub fn indices(&self) -> impl Iterator<Item = u32> + '_ {
        self.items.iter().map(|&(index, _)| index)
    }

    /// Length of the array in the other state.
    pub fn length(&self) -> usize {
        self.length
    }

    /// Upper bound of the memory use in bytes, the same before and after undo: appended items count
    /// even while the array stores them.
    pub fn bytes(&self) -> usize {
        self.items.capacity() * size_of::<(u32, T)>() + self.tail_length.max(self.tail.capacity()) * size_of::<T>()
    }

    /// Releases unused memory.
    pub fn shrink(&mut self) {
        self.items.shrink_to_fit();
        self.tail.shrink_to_fit();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[derive(Debug, Clone, Copy)]
    enum Edit {
        Set(usize, u8),
        Push(u8),
        Close,
        Undo,
        Redo,
    }

    /// The items in the other state of a delta, and the delta.
    type State = (Vec<u8>, Delta<u8>);

    fn edits() -> impl Strategy<Value = Vec<Edit>> {
        let edit = prop_oneof![
            4 => (0..20_usize, any::<u8>()).prop_map(|(index, value)| Edit::Set(index, value)),
            2 => any::<u8>().prop_map(Edit::Push),
            1 => Just(Edit::Close),
            1 => Just(Edit::Undo),
            1 => Just(Edit::Redo),
        ];
        prop::collection::vec(edit, 0..60)
    }

    #[test]
    fn memory_use_is_the_same_before_and_after_undo() {
        let mut array = Journaled::new(vec![0_u64; 100]);
        array.begin();
        (0..1000).for_each(|item| assert_eq!(array.push(item), 100 + item as u32));
        let mut delta = array.finish();
        assert_eq!(delta.bytes(), 1000 * size_of::<u64>());
        for is_undone in [true, false, true] {
            array.swap(&mut delta);
            assert_eq!(delta.bytes(), 1000 * size_of::<u64>());
            assert_eq!(delta.tail.capacity(), if is_undone { 1000 } else { 0 });
        }
    }

    proptest! {
        #[test]
        fn every_undo_and_redo_is_exact(edits in edits()) {
            let mut array = Journaled::new(vec![1_u8, 2, 3]);
            let mut plain = vec![1_u8, 2, 3];
            // Past states with the deltas that lead to them, and undone ones.
            let (mut past, mut future) = (Vec::<State>::new(), Vec::<State>::new());
            let mut before = plain.clone();
            array.begin();
            for edit in edits {
                match edit {
                    Edit::Set(index, value) if index < plain.len() => {
                        array.set(index as u32, value);
                        plain[index] = value;
                    }
                    Edit::Set(..) => {}
                    Edit::Push(value) => {
                        prop_assert_eq!(array.push(value) as usize, plain.len());
                        plain.push(value);
                    }
                    Edit::Close | Edit::Undo | Edit::Redo => {
                        for index in 0..plain.len() as u32 {
                            prop_assert_eq!(array.original(index), before.get(index as usize).copied());
                        }
                        let delta = array.finish();
                        if plain != before {
                            past.push((before.clone(), delta));
                            future.clear();
                        }
                        let (from, to) = if matches!(edit, Edit::Undo) { (&mut past, &mut future) } else { (&mut future, &mut past) };
                        if !matches!(edit, Edit::Close) && let Some((state, mut delta)) = from.pop() {
                            array.swap(&mut delta);
                            to.push((std::mem::replace(&mut plain, state), delta));
                        }
                        before.clone_from(&plain);
                        array.begin();
                    }
                }
                prop_assert_eq!(array.items(), &plain[..]);
            }
        }
    }
}
