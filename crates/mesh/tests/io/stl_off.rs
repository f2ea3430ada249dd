use glam::DVec3;
use isochore_mesh::io::{self, Format};
use isochore_mesh::primitives;

use crate::{parse, written};

#[test]
fn binary_stl_may_begin_like_text() {
    let mesh = primitives::icosphere(1.0, 1);
    let mut bytes = written(Format::Stl, &mesh);
    bytes[..9].copy_from_slice(b"solid no\n");
    assert_eq!(io::read_bytes(Format::Stl, &bytes).unwrap().triangles.len(), 80);
    bytes.extend(b"trailing bytes");
    bytes[..9].copy_from_slice(b"exported\n");
    assert_eq!(io::read_bytes(Format::Stl, &bytes).unwrap().triangles.len(), 80);
    bytes.truncate(500);
    let error = io::read_bytes(Format::Stl, &bytes).unwrap_err().to_string();
    assert_eq!(error, "the file is truncated: 4084 bytes announced, 500 found");
}

#[test]
fn text_stl_may_hold_several_solids() {
    let facet = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";
    let mesh = parse(Format::Stl, &format!("solid\n{facet}endsolid\nsolid b\n{facet}endsolid b\n")).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (3, 2));
    let broken = facet.replace("vertex 0 1 0", "vertex 0 1");
    let error = parse(Format::Stl, &format!("solid a\n{broken}endsolid a\n")).unwrap_err().to_string();
    assert_eq!(error, "line 7: 'endloop' is not a finite number");
    let short = facet.replace("  vertex 0 1 0\n", "");
    let error = parse(Format::Stl, &format!("solid a\n{short}endsolid a\n")).unwrap_err().to_string();
    assert_eq!(error, "line 6: a facet needs exactly three vertices");
}

#[test]
fn triangles_that_collapse_on_welding_are_left_out() {
    let facet = |corners: &str| format!("facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n");
    let sound = facet("vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n");
    let collapsed = facet("vertex 0 0 0\nvertex -0 0 0\nvertex 0 1 0\n");
    let mesh = parse(Format::Stl, &format!("solid a\n{sound}{collapsed}endsolid a\n")).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (3, 1));
}

#[test]
fn off_is_read() {
    let text = "# box lid\nCOFF\n4 1 0 # counts\n0 0 0 255 0 0 255\n1 0 0\n1 1 0\n0 1 0.5\n4 0 1 2 3 0.5 0.5 0.5\n";
    let mesh = parse(Format::Off, text).unwrap();
    assert_eq!(mesh.positions[3], DVec3::new(0.0, 1.0, 0.5));
    assert_eq!(mesh.triangles.len(), 2);
    assert_eq!(parse(Format::Off, "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").unwrap().triangles, [[0, 1, 2]]);
    let error = |text: &str| parse(Format::Off, text).unwrap_err().to_string();
    assert_eq!(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "line 6: vertex 3 is out of range: there are 3");
    assert_eq!(error("OFF\n3 1 0\n0 0 0\n1 x 0\n"), "line 4: 'x' is not a finite number");
    assert_eq!(error("OFF\n3 1 0\n0 0 0\n"), "the file ends too early");
    assert_eq!(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n"), "line 6: 3 numbers expected, 2 found");
    assert_eq!(error("nOFF\n"), "'nOFF' is not a header of OFF");
}
