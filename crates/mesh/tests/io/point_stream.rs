//! Streaming points chunk by chunk.

use glam::DVec3;
use isochore_mesh::io::{PointStream, PointStreamError};

/// Raises all points of a file with the given name and bytes, two at a time.
fn raised(name: &str, bytes: &[u8]) -> Result<Vec<u8>, PointStreamError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let mut stream = PointStream::open(&path)?;
    let (mut points, mut out) = (Vec::new(), Vec::new());
    stream.copy_before(&mut out)?;
    while stream.read_chunk(2, &mut points)? {
        points.iter_mut().for_each(|point| *point += DVec3::new(0.0, 0.5, 1.0));
        stream.write_chunk(&points, &mut out)?;
    }
    stream.copy_after(&mut out)?;
    Ok(out)
}

/// Three vertices with a byte before their coordinates and a short integer after them, and another
/// byte before and after all vertices.
fn binary(order: &str, number: impl Fn(f32) -> [u8; 4], points: [[f32; 3]; 3]) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat binary_{order}_endian 1.0\ncomment caf\u{e9}\nelement seal 1\nproperty uchar byte\nelement vertex 3\n\
         property uchar flag\nproperty float x\nproperty float y\nproperty float z\nproperty short tag\nend_header\n\x07"
    )
    .into_bytes();
    for point in points {
        file.push(9);
        point.iter().for_each(|&coordinate| file.extend(number(coordinate)));
        file.extend([1, 2]);
    }
    file.push(8);
    file
}

const POINTS: [[f32; 3]; 3] = [[0.0, 1.0, 2.0], [3.0, -4.0, 0.25], [-1.5, 0.0, 8.0]];

#[test]
fn other_bytes_are_kept_in_both_byte_orders() {
    let moved = POINTS.map(|[x, y, z]| [x, y + 0.5, z + 1.0]);
    for (order, number) in [("little", f32::to_le_bytes as fn(f32) -> [u8; 4]), ("big", f32::to_be_bytes)] {
        assert_eq!(raised("in.ply", &binary(order, number, POINTS)).unwrap(), binary(order, number, moved));
    }
}

#[test]
fn errors_name_the_point_and_its_location() {
    let [a, b, _] = POINTS;
    let whole = binary("little", f32::to_le_bytes, [a, b, [f32::NAN; 3]]);
    let error = raised("in.ply", &whole).unwrap_err().to_string();
    // A record has fifteen bytes, and one byte follows the last.
    let place = format!("point 2 at byte {}: has a coordinate that is not a finite number", whole.len() - 16);
    assert!(error.ends_with(&place), "{error}");
    let error = raised("in.ply", &whole[..whole.len() - 20]).unwrap_err().to_string();
    let place = format!("3 points announced, but it ends at byte {}", whole.len() - 20);
    assert!(error.ends_with(&place), "{error}");
    let text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let error = raised("in.ply", format!("{text}0 0 0\n0 0 0\n0 0 none\n").as_bytes()).unwrap_err().to_string();
    assert!(error.contains("point 2 on line 10: error at 1:5"), "{error}");
}
