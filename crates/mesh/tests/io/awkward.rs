//! Text files as other programs write them: marks, line ends, encodings, and elements that a mesh
//! could do without.

use isochore_mesh::io::{self, Format};
use isochore_mesh::{TriMesh, primitives};

use crate::{parse, written};

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const OFF: &str = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const PLY_HEAD: &str =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const POINTS: &str = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";

fn ply(faces: &str) -> String {
    let count = faces.lines().count();
    format!("{PLY_HEAD}element face {count}\nproperty list uchar int vertex_indices\nend_header\n{POINTS}{faces}")
}

const PLY_FACES: &str = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

fn stl() -> String {
    let facet = |corners: [&str; 3]| {
        let [a, b, c] = corners;
        format!("facet normal 0 0 0\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n")
    };
    let [o, x, y, z] = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];
    let facets = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]].map(facet).concat();
    format!("solid tetrahedron\n{facets}endsolid tetrahedron\n")
}

fn texts() -> [(Format, String); 4] {
    let [obj, off] = [TETRAHEDRON, OFF].map(str::to_owned);
    [(Format::Obj, obj), (Format::Off, off), (Format::Ply, ply(PLY_FACES)), (Format::Stl, stl())]
}

fn assert_tetrahedron(mesh: &TriMesh) {
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 4));
    assert!(mesh.check().is_closed());
    assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-15);
}

fn error(format: Format, bytes: &[u8]) -> String {
    io::read_bytes(format, bytes).unwrap_err().to_string()
}

#[test]
fn marks_and_line_ends_change_nothing() {
    for (format, text) in texts() {
        let plain = parse(format, &text).unwrap();
        assert_tetrahedron(&plain);
        for end in ["\n", "\r\n", "\r"] {
            let text = text.replace('\n', end);
            assert_eq!(parse(format, &text).unwrap(), plain, "{format:?} {end:?}");
            assert_eq!(parse(format, &format!("\u{FEFF}{text}")).unwrap(), plain, "{format:?} {end:?}");
        }
    }
    let gltf = String::from_utf8(written(Format::Gltf, &primitives::icosphere(1.0, 1))).unwrap();
    let plain = parse(Format::Gltf, &gltf).unwrap();
    assert_eq!(parse(Format::Gltf, &format!("\u{FEFF}\r\n{gltf}")).unwrap(), plain);
}

#[test]
fn lines_are_counted_whatever_ends_them() {
    for end in ["\n", "\r\n", "\r"] {
        let text = TETRAHEDRON.replace("f 2 3 4", "f 2 3 5").replace('\n', end);
        assert_eq!(error(Format::Obj, text.as_bytes()), "line 8: vertex 5 is out of range: there are 4");
        let text = OFF.replace("3 1 2 3", "3 1 2 4").replace('\n', end);
        assert_eq!(error(Format::Off, text.as_bytes()), "line 10: vertex 4 is out of range: there are 4");
    }
}

#[test]
fn wide_encodings_are_named() {
    for (format, text) in texts() {
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        for bytes in [[b"\xFF\xFE", &little[..]].concat(), [b"\xFE\xFF", &big[..]].concat(), little, big] {
            let error = error(format, &bytes);
            assert!(error.contains("UTF-16"), "{format:?}: {error}");
        }
        let wide: Vec<u8> = text.chars().flat_map(|letter| u32::from(letter).to_le_bytes()).collect();
        assert!(error(format, &[b"\xFF\xFE\0\0", &wide[..]].concat()).contains("UTF-32"));
    }
}

#[test]
fn only_numbers_continue_on_the_next_line() {
    for start in ["# C:\\parts\\\n", "o half\\\n", "g half\\\n", "mtllib C:\\a\\\n", "usemtl dark\\\n", "#\\ \n"] {
        assert_tetrahedron(&parse(Format::Obj, &format!("{start}{TETRAHEDRON}")).unwrap());
    }
    // A comment ends the statement before it, whatever the comment ends in.
    let commented = TETRAHEDRON.replace("v 0 1 0\n", "v 0 1 0 # up \\\n").replace("f 1 4 3\n", "f 1 4 3 #\\\n");
    assert_tetrahedron(&parse(Format::Obj, &commented).unwrap());
    let joined = TETRAHEDRON.replace("v 0 1 0\n", "v\\\n0 1\\ \n0\n").replace("f 1 4 3\n", "f 1 \\\r\n4 3\n");
    assert_tetrahedron(&parse(Format::Obj, &joined).unwrap());
}

/// Latin-1, GBK, and a name in Shift-JIS whose last byte is a backslash.
#[test]
fn names_keep_their_bytes() {
    for name in [&b"gr\xFCn"[..], b"\xBD\xF0\xCA\xF4", b"\x95\x5C", b"\x83\x5C\x83\x5C"] {
        let other = [name, b"\xE9"].concat();
        let materials = [b"mtllib ", name, b".mtl\nusemtl ", name, b"\n"].concat();
        let text = [&materials[..], TETRAHEDRON.as_bytes(), b"usemtl ", &other, b"\nf 2 3 4\nf 4 3 2\n"].concat();
        let mesh = io::read_bytes(Format::Obj, &text).unwrap();
        assert_eq!(mesh.materials.len(), 2);
        assert_ne!(mesh.materials[0], mesh.materials[1]);
        let lines = written(Format::Obj, &mesh);
        let kept: Vec<&[u8]> = lines.split(|&byte| byte == b'\n').filter(|line| line.contains(&b'm')).collect();
        let [library, first, second] = kept[..] else { panic!("{kept:?}") };
        assert_eq!(library, [b"mtllib ", name, b".mtl"].concat());
        assert_eq!(first, [b"usemtl ", name].concat());
        assert_eq!(second, [b"usemtl ", &other[..]].concat());
    }
}

#[test]
fn faces_without_area_are_left_out_and_counted() {
    let obj = format!("{TETRAHEDRON}f 1 2\nf 3\nf 1 1 2\nf 4 4 4\n");
    let off = OFF.replace("4 4 6", "4 8 6") + "2 0 1\n0\n3 0 0 1\n1 3\n";
    let ply = ply(&format!("2 0 1\n{PLY_FACES}0\n1 3\n3 2 1 2\n"));
    for (format, text) in [(Format::Obj, obj), (Format::Off, off), (Format::Ply, ply)] {
        let mesh = parse(format, &text).unwrap();
        assert_tetrahedron(&mesh);
        assert_eq!(mesh.assets.notes, ["4 faces with fewer than three distinct corners left out"], "{format:?}");
    }
}

#[test]
fn repeated_corners_are_left_out_and_counted() {
    let obj = TETRAHEDRON.replace("f 2 3 4", "f 2 3 3 4 2");
    let off = OFF.replace("3 1 2 3", "5 1 2 2 3 1");
    let ply = ply(&PLY_FACES.replace("3 1 2 3", "4 1 1 2 3"));
    for (format, text) in [(Format::Obj, obj), (Format::Off, off), (Format::Ply, ply)] {
        let mesh = parse(format, &text).unwrap();
        assert_tetrahedron(&mesh);
        assert_eq!(mesh.assets.notes, ["1 face with a repeated corner, which was left out"], "{format:?}");
    }
    // The attributes stay with their corners.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt .25 0\nvt .5 0\nvt .75 0\nf 1/1 2/2 2/1 3/3\n";
    let mesh = parse(Format::Obj, text).unwrap();
    assert_eq!(mesh.corner.uvs[0][0].map(|uv| uv.x), [0.25, 0.5, 0.75]);
}

#[test]
fn attributes_that_are_not_finite_are_replaced_and_counted() {
    for bad in ["nan", "-nan(ind)", "inf", "1.#QNAN", "1e999", "-Infinity"] {
        let normals = TETRAHEDRON.replace("f 1 3 2", &format!("vn 0 {bad} 0\nvt {bad} 0\nf 1/1/1 3/1/1 2/1/1"));
        let mesh = parse(Format::Obj, &normals).unwrap();
        assert_tetrahedron(&mesh);
        assert_eq!(mesh.corner.normals[0][0].to_array(), [0.0, 0.0, -1.0], "{bad}");
        assert_eq!(mesh.assets.notes.len(), 2, "{:?}", mesh.assets.notes);
        let colors = TETRAHEDRON.replace("v 0 1 0\n", &format!("v 0 1 0 {bad} 0 0\n"));
        assert_eq!(parse(Format::Obj, &colors).unwrap().assets.notes, ["1 non-finite color replaced by white"]);
        // A number that nothing reads.
        let quality = ply(PLY_FACES).replace("float z\n", "float z\nproperty float quality\n");
        let quality = quality.replace("0 0 0\n", &format!("0 0 0 {bad}\n"));
        let quality = ["1 0 0\n", "0 1 0\n", "0 0 1\n"]
            .iter()
            .fold(quality, |text, line| text.replacen(&format!("\n{line}"), &format!("\n{} 1\n", line.trim()), 1));
        let mesh = parse(Format::Ply, &quality).unwrap();
        assert_tetrahedron(&mesh);
        assert!(mesh.assets.notes.is_empty());
        // Positions decide about the file.
        for (format, text) in
            [(Format::Obj, TETRAHEDRON.to_owned()), (Format::Ply, ply(PLY_FACES)), (Format::Off, OFF.to_owned())]
        {
            assert!(parse(format, &text.replacen("1 0 0", &format!("{bad} 0 0"), 1)).is_err(), "{format:?} {bad}");
        }
    }
}

#[test]
fn strips_of_ply_are_read() {
    let head = format!("{PLY_HEAD}element tristrips 1\nproperty list int int vertex_indices\nend_header\n{POINTS}");
    assert_tetrahedron(&parse(Format::Ply, &format!("{head}6 0 2 1 3 0 2\n")).unwrap());
    let separate = "15 0 2 1 -1 1 2 3 -1 0 1 3 -1 0 3 2\n";
    assert_tetrahedron(&parse(Format::Ply, &format!("{head}{separate}")).unwrap());
    // Strips joined by triangles that use a vertex twice.
    assert_tetrahedron(&parse(Format::Ply, &format!("{head}{}", "9 0 2 1 3 0 0 0 3 2\n")).unwrap());
    let error = parse(Format::Ply, &format!("{head}3 0 1 4\n")).unwrap_err().to_string();
    assert_eq!(error, "face 0 names vertex 4, but the file has 4 vertices");
}

#[test]
fn words_may_be_wrapped() {
    let cases = [
        (Format::Off, OFF.replace(' ', "\n")),
        (Format::Off, OFF.replace("0 0 0\n1 0 0\n", "0 0 0 1 0 0\n\n")),
        (Format::Off, OFF.replace("OFF\n4", "OFF4")),
        (Format::Off, OFF.replace("OFF\n", "# made by hand\noff ")),
        (Format::Off, OFF.replace("3 0 2 1\n", "3 0 2 1 255 0 0\n\n")),
        (Format::Ply, ply(PLY_FACES).replace("3 0 1 3\n", "3\n0 1\n3\n")),
        (Format::Ply, ply(PLY_FACES).replace("0 1 0\n0 0 1\n", "0 1 0 0 0 1\n")),
        (Format::Ply, ply(PLY_FACES).replace("0 0 1\n3 0 2 1", "0 0 1\n\n \n3 0 2 1\n")),
        (Format::Stl, stl().replace('\n', " ")),
        (Format::Stl, stl().to_uppercase()),
        (Format::Stl, stl().replacen("solid", "Solid", 1)),
        (Format::Stl, stl().replacen("tetrahedron", "my vertex solid of endloop", 1)),
        (Format::Stl, stl().replace("vertex ", "vertex\n")),
    ];
    for (format, text) in cases {
        assert_tetrahedron(&parse(format, &text).unwrap());
    }
}

#[test]
fn truncated_text_stl_is_refused() {
    let text = stl();
    for length in ["solid tetrahedron\nfacet".len(), text.len() / 2, text.len() - "endsolid tetrahedron\n".len()] {
        let error = parse(Format::Stl, &text[..length]).unwrap_err().to_string();
        assert!(error.contains("truncated") || error.contains("exactly three"), "{error}");
    }
    let binary = written(Format::Stl, &primitives::icosphere(1.0, 1));
    let error = error(Format::Stl, &binary[..300]);
    assert_eq!(error, "the file is truncated: 4084 bytes announced, 300 found");
}

#[test]
fn attribute_bytes_of_stl_are_noted() {
    let mut bytes = written(Format::Stl, &primitives::icosphere(1.0, 1));
    bytes[84 + 48..84 + 50].copy_from_slice(&[0xFF, 0x83]);
    let mesh = io::read_bytes(Format::Stl, &bytes).unwrap();
    assert_eq!(mesh.assets.notes, ["the attribute bytes of triangles are not kept (nonzero in 1)"]);
}

#[test]
fn content_decides_about_the_format() {
    let ball = primitives::icosphere(1.0, 1);
    let contents = [Format::Obj, Format::Gltf, Format::Glb, Format::Ply, Format::Stl, Format::Off];
    for content in contents {
        let bytes = written(content, &ball);
        for announced in contents {
            let mesh = io::read_bytes(announced, &bytes).unwrap();
            assert_eq!(mesh.triangles.len(), 80);
            let is_same = content.name() == announced.name();
            let (found, expected) = (content.name(), announced.name());
            let note = format!("the content is {found}, not {expected}; it was read as {found}");
            assert_eq!(mesh.assets.notes, if is_same { vec![] } else { vec![note] });
        }
    }
    for (start, name) in [(&b"PK\x03\x04"[..], "ZIP"), (b"Kaydara FBX Binary  \0", "FBX"), (b"<?xml version", "XML")] {
        assert!(error(Format::Obj, start).contains(name));
    }
}

#[cfg(unix)]
#[test]
fn writing_follows_symbolic_links() {
    use std::fs;
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let [link, second, file] = ["link.obj", "second.obj", "file.txt"].map(|name| folder.path().join(name));
    symlink("file.txt", &link).unwrap();
    symlink(&link, &second).unwrap();
    for path in [&link, &second] {
        io::write(path, &primitives::icosphere(1.0, 1)).unwrap();
        assert!(fs::symlink_metadata(path).unwrap().is_symlink());
        assert!(fs::symlink_metadata(&file).unwrap().is_file());
        assert_eq!(io::read_bytes(Format::Obj, &fs::read(&file).unwrap()).unwrap().triangles.len(), 80);
    }
}
