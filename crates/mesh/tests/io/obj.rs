use glam::Vec3;
use isochore_mesh::io::Format;
use isochore_mesh::{TriMesh, io, primitives};

use crate::{parse, reread};

fn parse_obj(text: &str) -> TriMesh {
    parse(Format::Obj, text).unwrap()
}

#[test]
fn attributes_are_read() {
    let text = "# a tetrahedron\nmtllib a b.mtl\nv 0 0 0 1 0 0\nv 1e-7 0 0 0 .5 0\nv 0 1 0 0 0 1\nv 0 0 1 0 0 0\n\
                vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\no part\ng group\ns 1\nusemtl red paint\nf 1/1/1 3/3/1 2/2/1 # face\n\
                f -4/1/1 -3/2/1 -1/3/1\r\nusemtl blue\nf 1/1/1 4/2/1 3/3/1\nf \\\n2/3/1 3/2/1 \\\r\n4/1/1\nl 1 2 3\n";
    let mesh = parse_obj(text);
    assert_eq!(mesh.materials, ["red paint", "blue"]);
    assert_eq!(mesh.triangle_materials, [0, 0, 1, 1]);
    assert_eq!(mesh.triangles[1], [0, 1, 3]);
    assert_eq!(mesh.assets.material_libraries, ["a b.mtl"]);
    assert_eq!(mesh.positions[1].x, 1e-7);
    assert_eq!(mesh.vertex.colors[1].to_array(), [0.0, 0.5, 0.0, 1.0]);
    assert!(mesh.check().is_closed());
    assert_eq!(reread(Format::Obj, &mesh), mesh);
}

#[test]
fn faces_before_a_material_have_none() {
    let mesh = parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nusemtl a\nf 1 2 4\n");
    assert_eq!(mesh.materials, ["", "a"]);
    assert_eq!(mesh.triangle_materials, [0, 1]);
    assert_eq!(reread(Format::Obj, &mesh), mesh);
}

#[test]
fn forward_references_are_allowed() {
    let mesh = parse_obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
}

/// Faces precede their vertices, more of them than fit into one object, some with negative indices.
#[test]
fn large_files_may_refer_forward() {
    let ball = primitives::icosphere(1.0, 5);
    let mut text = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3/2 -2/2 -1/2\n");
    for [a, b, c] in &ball.triangles {
        text.push_str(&format!("f {}/1 {}/1 {}/2\n", a + 4, b + 4, c + 4));
    }
    ball.positions.iter().for_each(|p| text.push_str(&format!("v {} {} {}\n", p.x, p.y, p.z)));
    let mesh = parse_obj(&format!("{text}vt 0.5 0\nvt 0.25 0\n"));
    assert_eq!(mesh.positions[3..], ball.positions);
    assert_eq!(mesh.triangles[1..], ball.triangles.iter().map(|t| t.map(|vertex| vertex + 3)).collect::<Vec<_>>());
    assert_eq!(mesh.corner.uvs[0][0].map(|uv| uv.x), [0.25; 3]);
    assert_eq!(mesh.corner.uvs[0][20480].map(|uv| uv.x), [0.5, 0.5, 0.25]);
    let faces = 5..5 + ball.triangles.len();
    let error = parse(Format::Obj, &text).unwrap_err().to_string();
    assert_eq!(error, format!("line {}: texture coordinate 2 is out of range: there are 0", faces.start - 1));
}

#[test]
fn faces_have_only_attributes_of_all_corners() {
    let mesh = parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0.5 0.5\nf 1/1 2 3/1\nf 1/1 2/1 4/1\n");
    assert_eq!(mesh.corner.uvs[0].concat().iter().map(|uv| uv.x).collect::<Vec<_>>(), [0.0, 0.0, 0.0, 0.5, 0.5, 0.5]);
}

#[test]
fn vertices_split_at_a_seam_are_welded_and_touching_ones_are_not() {
    let faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\n";
    let split = parse_obj(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv 0 0 1\n{faces}f 5 6 7\n"));
    assert_eq!(split.positions.len(), 4);
    assert!(split.check().is_closed());

    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1\n";
    let mirrored = "v 0 0 0\nv -1 0 0\nv 0 1 0\nv 0 0 1\nf -4 -3 -2\nf -4 -1 -3\nf -4 -2 -1\nf -3 -1 -2\n";
    let touching = parse_obj(&format!("{tetrahedron}{mirrored}"));
    assert_eq!(touching.positions.len(), 8);
    assert!(touching.check().is_closed() && touching.check().is_manifold());
}

#[test]
fn triangulation_keeps_the_orientation() {
    // An arrowhead: only the diagonal from its tip to its notch is inside.
    let arrowhead = parse_obj("v 0 0 0\nv 2 -1 0\nv 0.5 0 0\nv 2 1 0\nf 2 3 4 1\n");
    let star = parse_obj(
        "v 0 3 0\nv 0.5 1 0\nv 3 1 0\nv 1 -0.5 0\nv 2 -3 0\nv 0 -1 0\nv -2 -3 0\nv -1 -0.5 0\nv -3 1 0\nv -0.5 1 0\n\
         f 10 9 8 7 6 5 4 3 2 1\n",
    );
    for (mesh, triangles) in [(arrowhead, 2), (star, 8)] {
        assert_eq!(mesh.triangles.len(), triangles);
        let turn = |triangle: usize| {
            let [a, b, c] = mesh.corners(triangle);
            (b - a).cross(c - a).z.signum()
        };
        assert!((0..triangles).all(|triangle| turn(triangle) == turn(0)));
    }
}

/// Two opposed combs: many reflex corners, and ears that contain other corners.
#[test]
fn long_polygons_keep_their_area() {
    let teeth = 500;
    let mut text = String::new();
    let mut area = 0.0;
    for tooth in 0..teeth {
        let x = 2 * tooth;
        text.push_str(&format!("v {x} {} 0\nv {} -1 0\n", 10 - tooth % 7, x + 1));
    }
    text.push_str(&format!("v {} -5 0\nv 0 -5 0\nf", 2 * teeth));
    (0..2 * teeth + 2).for_each(|corner| text.push_str(&format!(" {}", corner + 1)));
    let mesh = parse_obj(&text);
    assert_eq!(mesh.triangles.len(), 2 * teeth);
    for triangle in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(triangle);
        let turn = (b - a).cross(c - a).z;
        assert!(turn < 0.0, "triangle {triangle} is reversed");
        area -= 0.5 * turn;
    }
    let corners = &mesh.positions;
    let next = |corner: usize| corners[(corner + 1) % corners.len()];
    let shoelace: f64 = (0..corners.len()).map(|corner| -0.5 * corners[corner].cross(next(corner)).z).sum();
    // Integers and halves below 2⁵³: both sums are exact.
    assert_eq!(area, shoelace);
}

#[test]
fn quadrilaterals_get_the_rounder_triangles() {
    // A flat rhombus: its short diagonal is the better one, whichever corner comes first.
    let rhombus = "v 0 0 0\nv 3 -1 0\nv 6 0 0\nv 3 1 0\n";
    for face in ["f 1 2 3 4", "f 2 3 4 1", "f 4 3 2 1"] {
        let mesh = parse_obj(&format!("{rhombus}{face}\n"));
        assert!(mesh.triangles.iter().all(|triangle| triangle.contains(&1) && triangle.contains(&3)));
    }
}

#[test]
fn corners_on_a_line_keep_their_edges() {
    // A face with a corner on one of its straight sides: dropping that corner would open a gap.
    let mesh = parse_obj("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4 5\n");
    assert_eq!(mesh.triangles.len(), 3);
    assert_eq!(mesh.check().boundary_edges, [[0, 1], [0, 4], [1, 2], [2, 3], [3, 4]]);
}

/// Polygons that cross themselves, fold back or have no area: none may leave a gap to its
/// neighbors.
#[test]
fn broken_polygons_keep_their_edges() {
    let crossed = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nv -1 1 0\n";
    let folded = "v 0 0 0\nv 2 0 0\nv 1 0 0\nv 2 1 0\nv 0 1 0\n";
    let straight = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 4 0 0\n";
    for vertices in [crossed, folded, straight] {
        let mesh = parse_obj(&format!("{vertices}f 1 2 3 4 5\n"));
        assert_eq!(mesh.triangles.len(), 3);
        assert_eq!(mesh.check().boundary_edges, [[0, 1], [0, 4], [1, 2], [2, 3], [3, 4]]);
    }
}

/// Unused vertices, attributes of some faces or vertices only, and lines and points in between.
#[test]
fn order_and_partial_attributes_survive() {
    let mesh = parse_obj(
        "v 9 9 9\nv 0 0 0 0.5 0 0 0.25\nv 1 0 0\nv 0 1 0\nvt 0.5\nvn 1 0 0\no a\nl 2 3 4\np 1\nf 4/1/1 2/1/1 3/1/1\n\
         g b\nusemtl two  words\nv 0 0 1\nf -1 -2 -3 # last\nv 8 8 8\nf 2//1 3//1 5//1\n",
    );
    let x: Vec<f64> = mesh.positions.iter().map(|position| position.x).collect();
    assert_eq!(x, [9.0, 0.0, 1.0, 0.0, 0.0, 8.0]);
    assert_eq!(mesh.triangles, [[3, 1, 2], [4, 3, 2], [1, 2, 4]]);
    assert_eq!(mesh.triangle_materials, [0, 1, 1]);
    assert_eq!(mesh.materials, ["", "two  words"]);
    let uvs: Vec<f32> = mesh.corner.uvs[0].iter().map(|corners| corners[1].x).collect();
    assert_eq!(uvs, [0.5, 0.0, 0.0]);
    let normals: Vec<f32> = mesh.corner.normals.iter().map(|corners| corners[0].x).collect();
    assert_eq!((normals[0], normals[2]), (1.0, 1.0));
    // The second face gets the normal of its plane, which is rounded once more.
    assert!((normals[1] + (1.0_f32 / 3.0).sqrt()).abs() < 2.0 * f32::EPSILON);
    let colors: Vec<[f64; 4]> = mesh.vertex.colors.iter().map(|color| color.to_array()).collect();
    assert_eq!(colors[..3], [[1.0; 4], [0.5, 0.0, 0.0, 0.25], [1.0; 4]]);
    assert_eq!(colors.len(), 6);
}

#[test]
fn attributes_may_be_counted_back() {
    let mesh = parse_obj(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0\nvt 0.25 0\nvn 0 0 1\nf -3/-2/-1\t-2/-1/-1 -1/-2/-1\nv 0 0 1\nf 4//1 -4//-1  03//1\n",
    );
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 0, 2]]);
    assert_eq!(mesh.corner.uvs[0][0].map(|uv| uv.x), [0.5, 0.25, 0.5]);
    assert_eq!(mesh.corner.normals, [[Vec3::Z; 3]; 2]);
}

/// Zero, too far back, and longer than any machine word.
#[test]
fn rejects_indices_out_of_range() {
    let error = |corner: &str| {
        let start = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
        parse(Format::Obj, &format!("{start}f {corner} 2/1/1 3/1/1\n")).unwrap_err().to_string()
    };
    assert_eq!(error("1/0/1"), "line 6: texture coordinate 0 is out of range: there are 1");
    assert_eq!(error("1/-2/1"), "line 6: texture coordinate -2 is out of range: there are 1");
    assert_eq!(error("1/1/-2"), "line 6: normal -2 is out of range: there are 1");
    let overflowing = "1/1/6148914691236517206";
    assert_eq!(error(overflowing), format!("line 6: '{overflowing}' is not a face corner (v, v/vt, v//vn or v/vt/vn)"));
}

#[test]
fn errors_name_the_line() {
    let error = |text: &str| parse(Format::Obj, text).unwrap_err().to_string();
    let start = "v 0 0 0\nv 1 0 0 \\\n 1\nv 0 1 0\n";
    assert_eq!(error(&format!("{start}f 1 2 4\n")), "line 5: vertex 4 is out of range: there are 3");
    assert_eq!(error(&format!("{start}f 1 2 -4\n")), "line 5: vertex -4 is out of range: there are 3");
    assert_eq!(error(&format!("{start}f 1/1 2/1 3/1\n")), "line 5: texture coordinate 1 is out of range: there are 0");
    assert_eq!(error(&format!("{start}f 1//1 2 3\n")), "line 5: normal 1 is out of range: there are 0");
    assert_eq!(error(&format!("{start}f 0 1 2\n")), "line 5: vertex 0 is out of range: there are 3");
    assert_eq!(error(&format!("{start}v 1 nan 0\n")), "line 5: 'nan' is not a finite number");
    assert_eq!(error(&format!("{start}v 1 1e999 0\n")), "line 5: '1e999' is not a finite number");
    assert_eq!(error("v 0 0\n"), "line 1: 3 numbers expected, 2 found");
    assert_eq!(error(&format!("{start}f 1 2\n")), "the file has no triangles");
    assert_eq!(error(&format!("{start}f 1 2 x\n")), "line 5: 'x' is not a face corner (v, v/vt, v//vn or v/vt/vn)");
    // A vertex after a face with negative indices, and before a face with an index out of range.
    let late = format!("{start}f -3 -2 -1\nv 0 0 1\nf 1 2 5\n");
    assert_eq!(error(&late), "line 7: vertex 5 is out of range: there are 4");
    assert_eq!(
        error(&format!("{start}f 1 2 99999999999\n")).split(": ").nth(1),
        Some("'99999999999' is not a face corner (v, v/vt, v//vn or v/vt/vn)")
    );
    assert_eq!(error(&format!("{start}f 1 2 9999999999\n")), "line 5: vertex 9999999999 is out of range: there are 3");
    assert_eq!(error(&format!("{start}f 1/1/1/1 2 3\n")).split(": ").next(), Some("line 5"));
    assert_eq!(error(start), "the file has no triangles");
    assert_eq!(error(""), "the file has no triangles");
}

#[test]
fn errors_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.obj");
    std::fs::write(&path, "v 0 0 0\nf 1 2 3\n").unwrap();
    let error = io::read(&path).unwrap_err().to_string();
    assert_eq!(error, format!("{}: line 2: vertex 2 is out of range: there are 1", path.display()));
    let missing = io::read(folder.path().join("missing.obj")).unwrap_err().to_string();
    assert!(missing.contains("missing.obj: No such file"), "{missing}");
    let unknown = io::read(folder.path().join("a.fbx")).unwrap_err().to_string();
    assert!(unknown.contains("a.fbx: unknown mesh format"), "{unknown}");
}
