use std::io::Write;

use glam::DVec3;
use isochore_mesh::io::{self, Format, WriteError};
use isochore_mesh::{TriMesh, primitives};

use crate::FORMATS;

/// A writer with capacity for `left` bytes.
struct FullDisk {
    left: usize,
}

impl Write for FullDisk {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if bytes.len() > self.left {
            return Err(std::io::ErrorKind::StorageFull.into());
        }
        self.left -= bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn full_disk_is_an_error() {
    let mesh = primitives::icosphere(1.0, 2);
    for format in FORMATS {
        for left in [0, 100, 1000] {
            let error = io::write_to(format, &mesh, &mut FullDisk { left }).unwrap_err();
            assert!(matches!(error, WriteError::Io { .. }), "{format:?}: {error}");
        }
    }
}

#[test]
fn file_is_replaced_atomically() {
    let folder = tempfile::tempdir().unwrap();
    for extension in ["obj", "gltf", "glb", "ply", "stl", "off"] {
        let path = folder.path().join("mesh").with_extension(extension);
        std::fs::write(&path, "precious").unwrap();
        let mut mesh = primitives::icosphere(1.0, 1);
        mesh.positions[7].y = f64::NAN;
        let error = io::write(&path, &mesh).unwrap_err().to_string();
        assert!(error.contains(extension) && error.contains("vertex 7"), "{error}");
        assert_eq!(std::fs::read(&path).unwrap(), b"precious");

        let mesh = primitives::icosphere(1.0, 1);
        io::write(&path, &mesh).unwrap();
        assert_eq!(io::read(&path).unwrap().triangles.len(), 80);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 6, "a temporary file was left");

    let error = io::write(folder.path().join("none/mesh.obj"), &primitives::icosphere(1.0, 0)).unwrap_err().to_string();
    assert!(error.ends_with("none/mesh.obj: cannot write: No such file or directory (os error 2)"), "{error}");
}

#[test]
fn rejects_coordinates_beyond_single_precision() {
    let far = TriMesh::new(vec![DVec3::ZERO, DVec3::X * 1e39, DVec3::Y], vec![[0, 1, 2]]);
    for format in FORMATS {
        let result = io::write_to(format, &far, &mut Vec::new());
        match format {
            Format::Obj | Format::Ply | Format::Off => result.unwrap(),
            _ => assert!(matches!(result, Err(WriteError::TooLarge { vertex: 1, .. }))),
        }
    }
}

#[test]
fn rejects_index_out_of_range() {
    let mesh = TriMesh::new(vec![DVec3::ZERO; 3], vec![[0, 1, 3]]);
    for format in FORMATS {
        assert!(matches!(io::write_to(format, &mesh, &mut Vec::new()), Err(WriteError::Invalid { .. })));
    }
}
