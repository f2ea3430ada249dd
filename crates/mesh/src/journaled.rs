//! An array that remembers what it held, so that a stretch of edits can be undone and redone to the bit.

mod free_slots;

pub use free_slots::FreeSlots;

/// An array whose edits can be recorded. Undo costs time and memory in proportion to what was edited, never to the length.
#[derive(Debug, Clone, Default)]
pub struct Journaled<T> {
    items: Vec<T>,
    /// While recording, where in `old` an item may be; right only if `old` agrees, so it is never cleared.
    slots: Vec<u32>,
    /// Items edited since recording began, with what they were.
    old: Vec<(u32, T)>,
    /// Length when recording began; none while nothing is recorded.
    start: Option<usize>,
}

/// What an array held at the other end of a recorded stretch of edits: before it, or once undone, after it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Delta<T> {
    items: Vec<(u32, T)>,
    /// Items beyond the shorter length, while the other end is the longer one.
    tail: Vec<T>,
    /// Their number, wherever they are.
    tail_length: usize,
    length: usize,
}

impl<T: Copy> Journaled<T> {
    /// The array `items`, not recorded.
    pub fn new(items: Vec<T>) -> Self {
        Self { slots: vec![0; items.len()], items, old: Vec::new(), start: None }
    }

    /// The items as they are.
    pub fn items(&self) -> &[T] {
        &self.items
    }

    /// Item `index`.
    ///
    /// # Panics
    /// If there is none.
    pub fn get(&self, index: u32) -> T {
        self.items[index as usize]
    }

    /// Makes room for `additional` more items.
    pub fn reserve(&mut self, additional: usize) {
        self.items.reserve(additional);
        self.slots.reserve(additional);
    }

    /// Begins to record edits; what was recorded and not [taken](Self::finish) is forgotten.
    pub fn begin(&mut self) {
        self.old.clear();
        self.start = Some(self.items.len());
    }

    /// Replaces item `index`.
    ///
    /// # Panics
    /// If there is none.
    pub fn set(&mut self, index: u32, item: T) {
        self.record(index);
        self.items[index as usize] = item;
    }

    /// Replaces item `index` and records nothing: what undo leads to keeps it, unless the item was set since recording began.
    ///
    /// # Panics
    /// If there is none.
    pub fn amend(&mut self, index: u32, item: T) {
        self.items[index as usize] = item;
    }

    /// Appends an item and returns its index.
    pub fn push(&mut self, item: T) -> u32 {
        self.items.push(item);
        self.slots.push(0);
        self.items.len() as u32 - 1
    }

    /// Replaces item `index`, or appends it where that is the number of items.
    ///
    /// # Panics
    /// If there is none, and none can be appended there.
    pub fn put(&mut self, index: u32, item: T) {
        if index as usize == self.items.len() {
            self.push(item);
        } else {
            self.set(index, item);
        }
    }

    /// What item `index` was when recording began; none for items appended since.
    ///
    /// # Panics
    /// If there is no such item.
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

    /// Indices of the items edited since recording began, appended ones left out, in order of first edit.
    pub fn edited(&self) -> impl Iterator<Item = u32> + '_ {
        self.old.iter().map(|&(index, _)| index)
    }

    /// Ends recording and returns the way back, in order of the indices, so that it goes through memory once.
    pub fn finish(&mut self) -> Delta<T> {
        let length = self.start.take().unwrap_or(self.items.len());
        let mut items = std::mem::take(&mut self.old);
        items.sort_unstable_by_key(|&(index, _)| index);
        Delta { items, tail: Vec::new(), tail_length: self.items.len() - length, length }
    }

    /// Takes the array to the other end of `delta`, which then leads back. Deltas must be swapped in reverse order of their
    /// recording, and redone in order.
    ///
    /// # Panics
    /// If the delta is not that of the last edits.
    pub fn swap(&mut self, delta: &mut Delta<T>) {
        let now = self.items.len();
        if delta.length < now {
            delta.tail = self.items.split_off(delta.length);
        } else {
            self.items.append(&mut std::mem::take(&mut delta.tail));
        }
        self.slots.resize(self.items.len(), 0);
        delta.length = now;
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
    /// Indices of the items that differ at the two ends, those beyond the shorter length left out.
    pub fn indices(&self) -> impl Iterator<Item = u32> + '_ {
        self.items.iter().map(|&(index, _)| index)
    }

    /// Length of the array at the other end.
    pub fn length(&self) -> usize {
        self.length
    }

    /// Bytes that it holds at most, whichever end it leads to: items appended are counted before it has to hold them.
    pub fn bytes(&self) -> usize {
        self.items.capacity() * size_of::<(u32, T)>() + self.tail_length.max(self.tail.capacity()) * size_of::<T>()
    }

    /// Gives back memory that is not in use.
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

    /// Items at the other end of a delta.
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
    fn a_delta_holds_no_more_than_it_said() {
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
            // Past states with the way back to them, and undone ones.
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
