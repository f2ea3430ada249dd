//! Broken files yield an error or a valid mesh, never a panic.

use isochore_mesh::io::{self, Format};
use proptest::prelude::*;

use crate::{FORMATS, seamed_box, written};

fn read_untrusted(format: Format, bytes: &[u8]) {
    match io::read_bytes(format, bytes) {
        Ok(mesh) => {
            assert!(mesh.check().is_valid() && !mesh.triangles.is_empty());
            assert!(!mesh.volume().is_nan() && !mesh.area().is_nan());
        }
        Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
    }
}

#[test]
fn truncated_files_do_not_panic() {
    for format in FORMATS {
        let bytes = written(format, &seamed_box());
        for length in 0..bytes.len() {
            read_untrusted(format, &bytes[..length]);
        }
    }
}

#[test]
fn truncated_glb_is_reported() {
    let bytes = written(Format::Glb, &seamed_box());
    for length in [20, bytes.len() / 2, bytes.len() - 1] {
        let error = io::read_bytes(Format::Glb, &bytes[..length]).unwrap_err().to_string();
        assert!(error.contains("truncated"), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn changed_bytes_do_not_panic(
        format in prop::sample::select(&FORMATS[..]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let mut bytes = written(format, &seamed_box());
        for (index, byte) in changes {
            let index = index.index(bytes.len());
            bytes[index] = byte;
        }
        read_untrusted(format, &bytes);
    }

    /// Unlike arbitrary bytes, these changes often keep text formats readable.
    #[test]
    fn changed_digits_do_not_panic(
        format in prop::sample::select(&[Format::Obj, Format::Gltf, Format::Glb, Format::Ply, Format::Off][..]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), "[0-9.e/,\\- \n]"), 1..4),
    ) {
        let mut bytes = written(format, &seamed_box());
        let digits: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at].is_ascii_digit()).collect();
        for (index, text) in changes {
            bytes[digits[index.index(digits.len())]] = text.as_bytes()[0];
        }
        read_untrusted(format, &bytes);
    }

    #[test]
    fn arbitrary_bytes_do_not_panic(
        format in prop::sample::select(&FORMATS[..]),
        bytes in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        read_untrusted(format, &bytes);
    }
}
