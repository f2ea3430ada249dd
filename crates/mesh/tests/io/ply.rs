use glam::{DVec3, DVec4, Vec2, Vec3};
use isochore_mesh::io::{self, Format};

use crate::{parse, seamed_box, written};

#[test]
fn text_is_read() {
    let text = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 5\nproperty float x\nproperty double y\n\
                property int z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float s\n\
                property float t\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement edge 1\n\
                property int vertex1\nproperty int vertex2\nelement face 2\nproperty list uchar int vertex_index\n\
                end_header\n0 0 0 0 0 1 0 0 255 0 51\n1 0.1 0 0 0 1 1 0 0 0 0\n1 1 0 0 0 1 1 1 0 0 0\n\
                0 1 0 0 0 1 0 1 0 0 0\n0 0 2 0 0 1 0.5 0 0 0 0\n0 1\n4 0 1 2 3\n3 0 1 4\n";
    let mesh = parse(Format::Ply, text).unwrap();
    assert_eq!(mesh.triangles.len(), 3);
    assert_eq!(mesh.positions[1], DVec3::new(1.0, 0.1, 0.0));
    assert_eq!(mesh.vertex.colors[0], DVec4::new(1.0, 0.0, 0.2, 1.0));
    assert_eq!(mesh.corner.uvs[0][2][2], Vec2::new(0.5, 0.0));
    assert_eq!(mesh.corner.normals[0], [Vec3::Z; 3]);
}

#[test]
fn both_byte_orders_are_read() {
    for (order, bytes) in [("little", f32::to_le_bytes as fn(f32) -> [u8; 4]), ("big", f32::to_be_bytes)] {
        let mut file = format!(
            "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
             property float z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n"
        )
        .into_bytes();
        for coordinate in [0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 2.5, 0.0] {
            file.extend(bytes(coordinate));
        }
        file.extend([3, 0, 1, 2]);
        let mesh = io::read_bytes(Format::Ply, &file).unwrap();
        assert_eq!(mesh.positions, [DVec3::ZERO, DVec3::new(1.5, 0.0, 0.0), DVec3::new(0.0, 2.5, 0.0)]);
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
    }
}

#[test]
fn written_surface_is_closed_for_readers_that_do_not_weld() {
    let bytes = written(Format::Ply, &seamed_box());
    let header = String::from_utf8_lossy(&bytes);
    assert!(header.contains("element vertex 30\n"), "a vertex was split");
    assert!(header.contains("property list uchar float texcoord\n"));
    assert!(header.contains("property float red\n"));
}

#[test]
fn errors_are_one_line() {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let error = |body: &str| parse(Format::Ply, &format!("{header}{body}")).unwrap_err().to_string();
    assert_eq!(error("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "face 0 names vertex 3, but the file has 3 vertices");
    assert_eq!(error("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), "face 0 names vertex -1, but the file has 3 vertices");
    assert_eq!(error("0 0 0\n1 0 0\n0 1 0\n2 0 1\n"), "the file has no triangles");
    // The library provides the reason.
    let refused = |body: &str, place: &str, problem: &str| {
        let message = error(body);
        assert!(message.starts_with(place) && message.contains(problem), "{message}");
    };
    refused("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "line 11: vertex 1: ", "error at 1:3: expected");
    refused("0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 11: vertex 1: ", "found nothing");
    refused("0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "line 13: face 0: ", "Expected 4 list elements, but found only 3");
    refused("0 0 0\n1e999 0 0\n0 1 0\n3 0 1 2\n", "vertex 1 is at [inf, ", "");
    assert_eq!(error("0 0 0\n1 0 0\n"), "the file is truncated: it ends in vertex 2, counted from zero");
    let mut binary = written(Format::Ply, &seamed_box());
    let body = binary.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    binary[body..body + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    let message = io::read_bytes(Format::Ply, &binary).unwrap_err().to_string();
    assert!(message.starts_with("vertex 0 is at [NaN, "), "{message}");
    let whole = written(Format::Ply, &seamed_box());
    let truncated = io::read_bytes(Format::Ply, &whole[..body + 100]).unwrap_err().to_string();
    assert_eq!(truncated, "the file is truncated: it ends in vertex 2, counted from zero");
    let header_error = |text: &str| parse(Format::Ply, text).unwrap_err().to_string();
    assert_eq!(header_error("plx\n"), "line 1: 'plx' does not belong in the header of a PLY file");
    assert_eq!(
        header_error("ply\nformat ascii 1.0\nelement vertex many\n"),
        "line 3: 'element vertex many' does not belong in the header of a PLY file"
    );
    assert_eq!(header_error("ply\nformat ascii 1.0\n"), "the header has no 'end_header'");
    // A large count of elements without properties must not cause a long loop.
    assert!(parse(Format::Ply, "ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n").is_err());
}

#[test]
fn faces_may_come_before_vertices_and_be_of_any_size() {
    let text = "ply\nformat ascii 1.0\nelement face 2\nproperty uchar flag\nproperty list uchar int vertex_indices\n\
                property list uchar float texcoord\nelement vertex 5\nproperty list uchar int ring\nproperty float z\n\
                property float x\nproperty float y\nend_header\n7 4 0 1 2 3 0\n7 3 0 1 4 6 0 0 1 0 0.5 0\n\
                0 0 0 0\n2 8 9 0 1 0\n0 0 1 1\n0 0 0 1\n0 2 0 0\n";
    let mesh = parse(Format::Ply, text).unwrap();
    assert_eq!(mesh.positions[4], DVec3::new(0.0, 0.0, 2.0));
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 4]]);
    assert_eq!(mesh.corner.uvs[0][1], [Vec2::ZERO; 3]);
    assert_eq!(mesh.corner.uvs[0][2], [Vec2::ZERO, Vec2::X, Vec2::new(0.5, 0.0)]);
}

#[test]
fn quadrilaterals_among_triangles_are_read_from_binary_files() {
    let mut file = b"ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
                     property float z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for coordinate in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0] {
        file.extend(coordinate.to_le_bytes());
    }
    for face in [&[0_i32, 1, 4][..], &[0, 1, 2, 3], &[1, 2, 4]] {
        file.push(face.len() as u8);
        face.iter().for_each(|vertex| file.extend(vertex.to_le_bytes()));
    }
    let mesh = io::read_bytes(Format::Ply, &file).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 4], [0, 1, 2], [0, 2, 3], [1, 2, 4]]);
    let end = file.len();
    file[end - 4..].copy_from_slice(&9_i32.to_le_bytes());
    let error = io::read_bytes(Format::Ply, &file).unwrap_err().to_string();
    assert_eq!(error, "face 2 names vertex 9, but the file has 5 vertices");
}

/// The fast path for triangles ends at the first polygon, after several chunks.
#[test]
fn polygons_may_come_after_many_triangles() {
    const TRIANGLES: usize = 5000;
    for (format, to_bytes) in
        [("binary_little_endian", u32::to_le_bytes as fn(u32) -> [u8; 4]), ("binary_big_endian", u32::to_be_bytes)]
    {
        let header = format!(
            "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             element face {}\nproperty uchar flag\nproperty list uchar uint vertex_indices\nproperty float quality\nend_header\n",
            TRIANGLES + 2
        );
        let mut file = header.into_bytes();
        for coordinate in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0] {
            file.extend(to_bytes(coordinate.to_bits()));
        }
        let faces = (0..TRIANGLES as u32).map(|i| vec![i % 4, (i + 1) % 4, (i + 2) % 4]);
        for face in faces.clone().chain([vec![0, 1, 2, 3], vec![1, 2, 3]]) {
            file.extend([7, face.len() as u8]);
            face.iter().for_each(|&vertex| file.extend(to_bytes(vertex)));
            file.extend(to_bytes(0.5_f32.to_bits()));
        }
        let mesh = io::read_bytes(Format::Ply, &file).unwrap();
        let last = [[0, 1, 2], [0, 2, 3], [1, 2, 3]];
        let expected: Vec<[u32; 3]> = faces.map(|face| [face[0], face[1], face[2]]).chain(last).collect();
        assert_eq!(mesh.triangles, expected);

        let error = io::read_bytes(Format::Ply, &file[..file.len() - 1]).unwrap_err().to_string();
        assert_eq!(error, "the file is truncated: it ends in face 5001, counted from zero");
        let vertex = file.len() - 8;
        file[vertex..vertex + 4].copy_from_slice(&to_bytes(4));
        let error = io::read_bytes(Format::Ply, &file).unwrap_err().to_string();
        assert_eq!(error, "face 5001 names vertex 4, but the file has 4 vertices");
    }
}
