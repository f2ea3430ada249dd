//! OBJ files read and written.

use isochore_mesh::io::{self, Format};
use isochore_mesh::{TriMesh, primitives};

fn written(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    io::write_to(Format::Obj, mesh, &mut bytes).unwrap();
    bytes
}

#[test]
fn positions_come_back_with_the_same_bits() {
    let mesh = primitives::icosphere(0.1, 3);
    assert_eq!(io::read_bytes(Format::Obj, &written(&mesh)).unwrap(), mesh);
}

#[test]
fn attributes_come_back() {
    let text = "mtllib a b.mtl\nv 0 0 0 1 0 0\nv 1e-7 0 0 0 .5 0\nv 0 1 0 0 0 1\nv 0 0 1 0 0 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
                vn 0 0 1\nusemtl red paint\nf 1/1/1 3/3/1 2/2/1\nf -4/1/1 -3/2/1 -1/3/1\nusemtl blue\nf 1/1/1 4/2/1 3/3/1\n\
                f 2/3/1 3/2/1 4/1/1\n";
    let mesh = io::read_bytes(Format::Obj, text.as_bytes()).unwrap();
    assert_eq!(mesh.materials, ["red paint", "blue"]);
    assert_eq!(mesh.triangle_materials, [0, 0, 1, 1]);
    assert_eq!(mesh.assets.material_libraries, ["a b.mtl"]);
    assert!(mesh.check().is_closed());
    assert_eq!(io::read_bytes(Format::Obj, &written(&mesh)).unwrap(), mesh);
}

#[test]
fn errors_name_the_line() {
    let error = |text: &str| io::read_bytes(Format::Obj, text.as_bytes()).unwrap_err().to_string();
    let start = "v 0 0 0\nv 1 0 0 \\\n 1\nv 0 1 0\n";
    assert_eq!(error(&format!("{start}f 1 2 4\n")), "line 5: vertex 4 is out of range: there are 3");
    assert_eq!(error(&format!("{start}f 1 2 -4\n")), "line 5: vertex -4 is out of range: there are 3");
    assert_eq!(error(&format!("{start}f 1/1 2/1 3/1\n")), "line 5: texture coordinate 1 is out of range: there are 0");
    assert_eq!(error(&format!("{start}f 0 1 2\n")), "line 5: vertex 0 is out of range: there are 3");
    assert_eq!(error(&format!("{start}v 1 nan 0\n")), "line 5: 'nan' is not a finite number");
    assert_eq!(error("v 0 0\n"), "line 1: 3 numbers expected, 2 found");
    assert_eq!(error(&format!("{start}f 1 2\n")), "line 5: a face needs at least three corners, 2 found");
    assert_eq!(error(&format!("{start}f 1 2 x\n")), "line 5: 'x' is not a face corner (v, v/vt, v//vn or v/vt/vn)");
    assert_eq!(error(start), "the file has no triangles");
}
