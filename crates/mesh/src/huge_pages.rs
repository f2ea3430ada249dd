//! Huge-page hints for large allocations.

/// Smallest allocation in bytes for which a hint is worthwhile. Smaller: the allocation may not
/// contain an aligned huge page of 2 MiB. Larger: meshes of many thousand triangles get no hint.
const WORTHWHILE: usize = 1 << 22;

/// A multiple of every common page size, bytes. Smaller: the system may refuse an address that is
/// not aligned to a page. Larger: more of the two ends of a vector is left out.
const PAGE: usize = 1 << 16;

/// Requests huge pages for the capacity of a vector that has not been touched yet, such as zeros
/// from the system.
///
/// The system provides fresh memory page by page. For meshes of a million triangles, this took half
/// of the time of reading them. Random access to huge pages is faster, too. Without support by the
/// system, the vector is returned unchanged.
pub(crate) fn in_huge_pages<T>(mut vector: Vec<T>) -> Vec<T> {
    let size = size_of::<T>() * vector.capacity();
    if size >= WORTHWHILE {
        let start = vector.as_mut_ptr();
        let first = start.addr().next_multiple_of(PAGE);
        let end = (start.addr() + size) / PAGE * PAGE;
        advise(start.cast(), first - start.addr(), end.saturating_sub(first));
    }
    vector
}

/// Requests huge pages for `length` bytes from `start` + `offset`.
#[cfg(target_os = "linux")]
#[expect(unsafe_code, reason = "the system call takes an address")]
fn advise(start: *mut std::ffi::c_void, offset: usize, length: usize) {
    use rustix::mm::{Advice, madvise};
    // SAFETY: the range belongs to the vector, and this advice does not change memory. If the
    // system refuses, small pages work as well.
    let _ = unsafe { madvise(start.byte_add(offset), length, Advice::LinuxHugepage) };
}

#[cfg(not(target_os = "linux"))]
fn advise(_: *mut std::ffi::c_void, _: usize, _: usize) {}

#[test]
fn vectors_keep_their_address_and_contents() {
    for capacity in [0, 1, WORTHWHILE / 12, 3 * WORTHWHILE / 12 + 1] {
        let mut vector_before: Vec<[f32; 3]> = Vec::with_capacity(capacity + 1);
        vector_before.push([1.0; 3]);
        let address = vector_before.as_ptr();
        let mut vector = in_huge_pages(vector_before);
        vector.extend((0..capacity).map(|index| [index as f32; 3]));
        assert_eq!(vector.as_ptr(), address);
        assert!(vector[0] == [1.0; 3] && vector[1..].iter().enumerate().all(|(index, value)| value[2] == index as f32));
    }
}
