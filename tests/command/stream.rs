//! Tests of `run --stream`: the same bits as a replay in memory; all other contents of the file are
//! copied.

use std::fs;

use glam::DVec3;
use isochore_mesh::{NoProgress, io::PointStream, primitives};
use isochore_sculpt::{Meshes, Recipe, recipe::Format, replay_points};

use crate::folder::{Folder, PRESS};

/// `PRESS` with the target `name`, written to `out` with the same extension. A region stroke is
/// added, because its number of steps depends on the bounds of the points.
fn recipe(name: &str) -> String {
    let extension = name.rsplit('.').next().unwrap();
    let region = "[[stroke]]\nkind = \"region\"\nmotion = { rotate = { origin = [0, 0, 0], axis = [1, 0, 0], degrees = 20.0 } }\n\
                  inner = { kind = \"half_space\", point = [0, 0, 0], normal = [0, 0, 1] }\nouter_distance = 0.5\n\n[output]";
    PRESS
        .replace(
            "shape = { kind = \"icosphere\", radius = 1.0, subdivisions = 3 }",
            &format!("mesh = \"{name}\"\ntransform = {{ scale = 1.1 }}"),
        )
        .replace("[output]", region)
        .replace("out.ply", &format!("out.{extension}"))
}

fn points() -> Vec<DVec3> {
    // Rounded to single precision, so that files of both precisions contain the same points.
    primitives::icosphere(1.0, 4).positions.iter().map(|point| point.as_vec3().as_dvec3()).collect()
}

/// Points advected in memory by the recipe.
fn advected(name: &str) -> Vec<DVec3> {
    let recipe = Recipe::parse(&recipe(name), Format::Toml, &[]).unwrap();
    let placed: Vec<DVec3> = points().iter().map(|point| *point * 1.1).collect();
    replay_points(&recipe, &Meshes::new(), &placed, &NoProgress).unwrap().points
}

fn numpy_header(shape: &str, descr: &str) -> Vec<u8> {
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    text.extend(std::iter::repeat_n(' ', 117 - text.len()));
    let mut header = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    header.extend_from_slice(text.as_bytes());
    header.push(b'\n');
    header
}

/// A binary PLY file. An element precedes the vertices, whose coordinates have properties before,
/// between and after them; a face with an invalid index count follows.
fn binary_ply(is_big: bool, points: &[DVec3]) -> Vec<u8> {
    let order = if is_big { "big" } else { "little" };
    let mut file = format!(
        "ply\nformat binary_{order}_endian 1.0\ncomment kept\nelement camera 2\nproperty ushort number\nelement vertex {}\n\
         property uchar flag\nproperty float x\nproperty float y\nproperty short between\nproperty float z\nproperty double quality\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n",
        points.len()
    )
    .into_bytes();
    file.extend([7, 8, 9, 10]);
    for (index, point) in points.iter().enumerate() {
        let number = |value: f64| if is_big { (value as f32).to_be_bytes() } else { (value as f32).to_le_bytes() };
        file.push(index as u8);
        file.extend(number(point.x));
        file.extend(number(point.y));
        file.extend([1, 2]);
        file.extend(number(point.z));
        file.extend([3; 8]);
    }
    file.extend([0, 42]);
    file
}

#[test]
fn arrays_match_a_replay_in_memory_bitwise() {
    let mut file = numpy_header(&format!("({}, 3)", points().len()), "<f8");
    let header = file.clone();
    points().iter().for_each(|point| point.to_array().iter().for_each(|x| file.extend(x.to_le_bytes())));
    let folder = Folder::with(&[("press.toml", &recipe("in.npy"))]);
    fs::write(folder.path("in.npy"), &file).unwrap();
    for threads in ["1", "2"] {
        folder.run(&["run", "press.toml", "--stream", "--report", "report.json", "--threads", threads]).expect(0);
        let mut expected = header.clone();
        let advected = advected("in.npy");
        advected.iter().for_each(|point| point.to_array().iter().for_each(|x| expected.extend(x.to_le_bytes())));
        assert!(folder.read("out.npy") == expected);
        let report = folder.json("report.json");
        assert_eq!(report["points"], advected.len());
        assert_eq!(report["strokes"], serde_json::json!(["move", "region"]));
        let highest = advected.iter().map(|point| point.z).fold(f64::NEG_INFINITY, f64::max);
        assert_eq!(report["bounds_after"]["max"][2], highest);
        assert!(report["bounds_before"]["max"][2].as_f64().unwrap() == 1.1);
        assert!(report["warnings"][0].as_str().unwrap().contains("lock"));
    }
}

#[test]
fn binary_ply_keeps_everything_except_coordinates() {
    for is_big in [false, true] {
        let folder = Folder::with(&[("press.toml", &recipe("in.ply"))]);
        fs::write(folder.path("in.ply"), binary_ply(is_big, &points())).unwrap();
        folder.run(&["run", "press.toml", "--stream"]).expect(0);
        assert!(folder.read("out.ply") == binary_ply(is_big, &advected("in.ply")), "big endian: {is_big}");
    }
}

#[test]
fn text_ply_keeps_everything_except_coordinates() {
    let file = |points: &[DVec3], gap: &str| {
        let mut text = format!(
            "ply\nformat ascii 1.0\ncomment kept\nelement vertex {}\nproperty uchar flag\nproperty double x\nproperty double y\n\
             property double z\nproperty list uchar int ring\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n",
            points.len()
        );
        points.iter().for_each(|p| text.push_str(&format!("007{gap} {} {} {} 2 1 1\n", p.x, p.y, p.z)));
        text + "03 00 1 2\n"
    };
    let folder = Folder::with(&[("press.toml", &recipe("in.ply")), ("in.ply", &file(&points(), "\t"))]);
    folder.run(&["run", "press.toml", "--stream"]).expect(0);
    assert_eq!(String::from_utf8(folder.read("out.ply")).unwrap(), file(&advected("in.ply"), "\t"));
}

#[test]
fn result_does_not_depend_on_the_chunk_size() {
    let folder = Folder::with(&[]);
    let path = folder.path("in.ply");
    fs::write(&path, binary_ply(true, &points())).unwrap();
    let copy = |most: usize| {
        let mut stream = PointStream::open(&path).unwrap();
        let (mut copy, mut points, mut chunks) = (Vec::new(), Vec::new(), 0);
        stream.copy_before(&mut copy).unwrap();
        while stream.read_chunk(most, &mut points).unwrap() {
            points.iter_mut().for_each(|point| *point *= 0.5);
            stream.write_chunk(&points, &mut copy).unwrap();
            chunks += 1;
        }
        stream.copy_after(&mut copy).unwrap();
        (copy, chunks)
    };
    let halved: Vec<DVec3> = points().iter().map(|point| *point * 0.5).collect();
    for (most, chunks) in [(1, 2562), (1000, 3), (2562, 1), (usize::MAX, 1)] {
        assert!(copy(most) == (binary_ply(true, &halved), chunks), "{most}");
    }
}

/// Runs the recipe on a file of these bytes, in a folder with an old output. Expects an error.
#[track_caller]
fn expect_rejected(name: &str, bytes: &[u8], arguments: &[&str], parts: &[&str]) {
    let folder = Folder::with(&[("press.toml", &recipe(name))]);
    fs::write(folder.path(name), bytes).unwrap();
    fs::write(folder.path("out.ply"), "old output").unwrap();
    let before = folder.contents();
    folder.run(&[&["run", "press.toml", "--stream"], arguments].concat()).expect_error(2, parts);
    assert_eq!(folder.contents(), before);
}

#[test]
fn errors_name_the_position_in_invalid_files() {
    let whole = binary_ply(false, &points());
    let header = whole.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    let message = format!("in.ply: the file is truncated: 2562 points announced, but it ends at byte {}", header + 200);
    expect_rejected("in.ply", &whole[..header + 200], &[], &[&message]);
    let mut infinite = whole.clone();
    // The preceding element has four bytes, a vertex has 23 bytes, and x is at offset 1 of a
    // vertex.
    infinite[header + 4 + 23 * 2 + 1..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    expect_rejected(
        "in.ply",
        &infinite,
        &[],
        &["in.ply: point 2 ", &format!("at byte {}", header + 50), "not a finite number"],
    );

    let text =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    expect_rejected("in.ply", format!("{text}0 0 0\n0 0 none\n").as_bytes(), &[], &["point 1 on line 9: error at 1:5"]);
    expect_rejected(
        "in.ply",
        format!("{text}0 0 0\n").as_bytes(),
        &[],
        &["truncated: 2 points announced, but it ends at line 8"],
    );
    expect_rejected("in.ply", text.replace("float z", "int z").as_bytes(), &[], &["in.ply", "float or double"]);
    expect_rejected("in.ply", text.replace("float z", "list uchar int z").as_bytes(), &[], &["in.ply", "x, y and z"]);
    expect_rejected("in.ply", b"solid", &[], &["in.ply: line 1"]);
    let list_first =
        text.replace("ascii", "binary_little_endian").replace("vertex 2\n", "vertex 2\nproperty list uchar int ring\n");
    expect_rejected("in.ply", list_first.as_bytes(), &[], &["in.ply", "lists before or among its vertices"]);

    expect_rejected("in.npy", b"\x93NUMPY\x01", &[], &["in.npy", "truncated in its header"]);
    expect_rejected("in.npy", &numpy_header("(4, 2)", "<f8"), &[], &["in.npy", "[4, 2]", "(N, 3)"]);
    expect_rejected("in.npy", &numpy_header("(4, 3)", "<i4"), &[], &["in.npy", "<i4", "f4 or f8"]);
    expect_rejected("in.npy", &numpy_header("(4, 3)", "<f4"), &[], &["in.npy", "4 points announced", "byte 128"]);
    expect_rejected("in.obj", b"", &[], &["in.obj", "only from .ply and .npy files"]);
}

#[test]
fn errors_name_keys_that_need_a_mesh() {
    let whole = binary_ply(false, &points());
    let with = |setting: &str, parts: &[&str]| expect_rejected("in.ply", &whole, &["--set", setting], parts);
    with("promise.volume=0.1", &["promise.volume", "needs a mesh"]);
    with("output.preview=out.png", &["output.preview", "needs a mesh"]);
    with("mask.vertices=[1, 0]", &["mask.vertices", "needs a mesh"]);
    with("stroke.0.kind=stamp", &["stroke.0", "stamp"]);
    expect_rejected("in.ply", &whole, &["--output", "out.obj"], &["out.obj", "same extension"]);
    let folder = Folder::with(&[("press.toml", PRESS)]);
    folder.run(&["run", "press.toml", "--stream"]).expect_error(2, &["target", "set target.mesh"]);
}

/// Limit on data memory of a stream in bytes, as stated in the README. The system enforces it.
///
/// A chunk of 65,536 points holds 24 bytes of the file and 24 bytes for each position before and
/// after the strokes, per point: 5 MB. Buffers of 1 MiB for two files and three stacks of up to 2
/// MiB bring the total to 13 MB. The last third is for the allocator and the library.
#[cfg(target_os = "linux")]
const STREAM_MEMORY: usize = 20_000_000;

#[cfg(target_os = "linux")]
#[test]
fn streams_files_larger_than_memory() {
    const TIMES: usize = 1000;
    let repeated: Vec<u8> = points().iter().flat_map(|point| point.to_array()).flat_map(f64::to_le_bytes).collect();
    let repeated = repeated.repeat(TIMES);
    assert!(repeated.len() > 2 * STREAM_MEMORY);
    let count = TIMES * points().len();
    let ply = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
    );
    for (name, header) in [("in.npy", numpy_header(&format!("({count}, 3)"), "<f8")), ("in.ply", ply.into_bytes())] {
        let folder = Folder::with(&[("press.toml", &recipe(name))]);
        fs::write(folder.path(name), [&header, &repeated[..]].concat()).unwrap();
        let run = |bytes: usize| {
            let command = folder.command(&["run", "press.toml", "--stream", "--threads", "2"]);
            let mut limited = std::process::Command::new("sh");
            let limit = ["-c", "ulimit -d \"$0\" && exec \"$@\"", &(bytes / 1024).to_string()];
            limited.current_dir(folder.path("")).args(limit).arg(command.get_program()).args(command.get_args());
            crate::folder::Run::of(limited.output().unwrap())
        };
        // A quarter is too little, so the limit takes effect.
        assert_ne!(run(STREAM_MEMORY / 4).code, Some(0));
        run(STREAM_MEMORY).expect(0);
        let out = folder.read(&name.replace("in", "out"));
        let (first, last) = (&out[header.len()..][..24 * points().len()], &out[out.len() - 24 * points().len()..]);
        assert!(out.len() == header.len() + repeated.len() && first == last);
        let advected: Vec<u8> = advected(name).iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes).collect();
        assert!(first == advected);
    }
}
