//! Large tables that are read here and there.

use std::ops::{Deref, DerefMut};

use bytemuck::Pod;
use memmap2::MmapMut;

/// Bytes from which on a table has pages of its own. Larger: smaller tables go without huge ones. Smaller: a greater part of a table
/// lies before its first huge page or behind its last, which have two million bytes each.
const OWN_PAGES: usize = 1 << 23;

/// As many values as it was made with, zero at first, in huge pages where the system has them: those are handed out faster than
/// as many small ones, and their addresses are looked up faster.
#[derive(Debug)]
pub(crate) enum Table<T> {
    Pages(MmapMut),
    Heap(Vec<T>),
}

impl<T: Pod> Table<T> {
    pub(crate) fn zeroed(length: usize) -> Self {
        let bytes = length * size_of::<T>();
        let pages = if bytes < OWN_PAGES { None } else { MmapMut::map_anon(bytes).ok() };
        let Some(pages) = pages else { return Self::Heap(bytemuck::zeroed_vec(length)) };
        #[cfg(target_os = "linux")]
        // Where it is refused, small ones do as well.
        let _ = pages.advise(memmap2::Advice::HugePage);
        Self::Pages(pages)
    }
}

impl<T: Pod> Deref for Table<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match self {
            Self::Pages(pages) => bytemuck::cast_slice(pages),
            Self::Heap(values) => values,
        }
    }
}

impl<T: Pod> DerefMut for Table<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        match self {
            Self::Pages(pages) => bytemuck::cast_slice_mut(pages),
            Self::Heap(values) => values,
        }
    }
}

#[test]
fn tables_of_any_size_are_zero_and_keep_what_they_are_given() {
    for length in [0, 1, OWN_PAGES / 12 - 1, OWN_PAGES / 12 + 1] {
        let mut table = Table::<[f32; 3]>::zeroed(length);
        assert_eq!(matches!(table, Table::Pages(_)), 12 * length >= OWN_PAGES);
        assert!(table.iter().all(|value| *value == [0.0; 3]));
        table.iter_mut().enumerate().for_each(|(index, value)| value[2] = index as f32);
        assert!(table.len() == length && table.iter().enumerate().all(|(index, value)| value[2] == index as f32));
    }
}
