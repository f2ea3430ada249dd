//! Large vectors, whose memory takes time to be handed out.

/// Bytes from which on it is worth asking. Smaller, and there may be no huge page, of two million bytes, in between; larger, and meshes
/// of many thousand triangles go without.
const WORTHWHILE: usize = 1 << 22;

/// A multiple of the size that pages have anywhere. Smaller, and the system may refuse what does not begin with a page; larger, and
/// more of the vector's ends is left out.
const PAGE: usize = 1 << 16;

/// The vector, with huge pages for the memory that it has reserved and that nobody has touched yet, such as zeros from the system:
/// where the system has them. Fresh memory is handed out page by page, which for meshes of a million triangles took half of the time
/// of reading them; and what is read here and there is found faster in large ones.
pub(crate) fn in_huge_pages<T>(mut vector: Vec<T>) -> Vec<T> {
    let size = size_of::<T>() * vector.capacity();
    if size >= WORTHWHILE {
        let start = vector.as_mut_ptr();
        let first = start.addr().next_multiple_of(PAGE);
        let end = (start.addr() + size) / PAGE * PAGE;
        ask(start.cast(), first - start.addr(), end.saturating_sub(first));
    }
    vector
}

/// Asks for huge pages for the `length` bytes that lie `offset` bytes behind an address.
#[cfg(target_os = "linux")]
#[expect(unsafe_code, reason = "the system's call takes an address")]
fn ask(start: *mut std::ffi::c_void, offset: usize, length: usize) {
    use rustix::mm::{Advice, madvise};
    // SAFETY: the range belongs to the vector, and this advice changes no memory. Where it is refused, small pages do as well.
    let _ = unsafe { madvise(start.byte_add(offset), length, Advice::LinuxHugepage) };
}

#[cfg(not(target_os = "linux"))]
fn ask(_: *mut std::ffi::c_void, _: usize, _: usize) {}

#[test]
fn vectors_of_any_size_keep_their_room_and_what_is_in_them() {
    for capacity in [0, 1, WORTHWHILE / 12, 3 * WORTHWHILE / 12 + 1] {
        let mut given: Vec<[f32; 3]> = Vec::with_capacity(capacity + 1);
        given.push([1.0; 3]);
        let address = given.as_ptr();
        let mut vector = in_huge_pages(given);
        vector.extend((0..capacity).map(|index| [index as f32; 3]));
        assert_eq!(vector.as_ptr(), address);
        assert!(vector[0] == [1.0; 3] && vector[1..].iter().enumerate().all(|(index, value)| value[2] == index as f32));
    }
}
