//! Reading and writing of mesh files on one core, compared with Rust libraries for each format and
//! with Python libraries.
//!
//! Unlike the Rust libraries, isochore also welds seams, checks indices and coordinates, uses
//! double precision, and stores attributes per corner.
//!
//! In comparisons with Rust libraries, each read is the first of its process, so the system must
//! still provide its memory. In comparisons with Python libraries, both sides keep one process and
//! can reuse memory.
//!
//! Arguments: file extensions of the formats to compare. Default: all formats.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "benchmarks print their results and missing peers")]

use std::fs::{self, File};
use std::io::{BufWriter, Cursor};
use std::path::{Path, PathBuf};
use std::process::Command;

use isochore_bench::{Comparison, PythonPeer, cpu_seconds, grouped, median, on_one_core, scratch};
use isochore_mesh::io::{self, Format};
use isochore_mesh::{TriMesh, primitives};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{BeginList, PropertyAccess, PropertyAccessResult};
use serde_json::json;

/// Rounds after one warm-up round.
const ROUNDS: usize = 7;

/// Compared formats with their file extensions.
const FORMATS: [(Format, &str); 4] =
    [(Format::Obj, "obj"), (Format::Glb, "glb"), (Format::Ply, "ply"), (Format::Stl, "stl")];

/// Python libraries: prefix of their job names, and display name.
const PEERS: [(&str, &str); 4] = [
    ("meshlib", "MeshLib 3.1.4"),
    ("open3d", "Open3D 0.20.0"),
    ("pymeshlab", "PyMeshLab 2025.7.post1"),
    ("trimesh", "trimesh 5.2.0"),
];

/// First argument of a process that reads one file. The next arguments are the reader and the path.
const READ_ONCE: &str = "read-once";

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [job, reader, path] = &arguments[..]
        && job == READ_ONCE
    {
        return println!("{}", read_once(reader, Path::new(path)));
    }
    on_one_core(|| {
        let mut mesh = primitives::icosphere(1.0, 7);
        compare_formats(&mesh, "", &FORMATS, &PEERS);
        let begin = cpu_seconds();
        let welded = mesh.clone().welded();
        let milliseconds = 1e3 * (cpu_seconds() - begin);
        println!(
            "welding {} vertices takes {milliseconds:.1} ms, including the copy of the mesh",
            welded.positions.len()
        );
        let normals = mesh.vertex_normals();
        mesh.corner.normals = by_corner(&mesh, |vertex| normals[vertex].as_vec3());
        compare_formats(&mesh, ", with normals", &FORMATS, &PEERS);

        let mut large = primitives::icosphere(1.0, 8);
        let normals = large.vertex_normals();
        large.corner.normals = by_corner(&large, |vertex| normals[vertex].as_vec3());
        compare_formats(&large, ", with normals", &[(Format::Glb, "glb")], &[]);
        large.corner.uvs = vec![by_corner(&large, |vertex| normals[vertex].truncate().as_vec2())];
        let both = [(Format::Obj, "obj"), (Format::Glb, "glb")];
        compare_formats(&large, ", with texture coordinates and normals", &both, &[]);
        large.corner.normals.clear();
        compare_formats(&large, ", with texture coordinates", &[(Format::Glb, "glb")], &[]);
    });
}

fn by_corner<T>(mesh: &TriMesh, value: impl Fn(usize) -> T) -> Vec<[T; 3]> {
    mesh.triangles.iter().map(|triangle| triangle.map(|vertex| value(vertex as usize))).collect()
}

/// CPU time in seconds for reading a file with isochore or with the Rust library. It is the first
/// file that this process reads.
fn read_once(reader: &str, path: &Path) -> f64 {
    let library = Format::of_path(path).and_then(library_of);
    match (reader, library) {
        ("library", Some((_, library))) => timed(|| library(path)),
        _ => timed(|| io::read(path).expect("a readable mesh").triangles.len()),
    }
}

/// Runs [`read_once`] in a new process on the same core.
fn first_reading(reader: &str, path: &Path) -> f64 {
    let program = std::env::current_exe().expect("this program has a path");
    let output =
        Command::new(program).args([READ_ONCE, reader]).arg(path).output().expect("this program can be started");
    String::from_utf8_lossy(&output.stdout).trim().parse().expect("the file was read")
}

/// Runs a job of a peer and returns its CPU time in seconds, or `None` if the peer does not support
/// it.
type Job<'a> = Box<dyn FnMut() -> Option<f64> + 'a>;

fn compare_formats(mesh: &TriMesh, with: &str, formats: &[(Format, &str)], peers: &[(&str, &str)]) {
    let mut python = PythonPeer::start("files", &[]);
    if let Err(error) = &python {
        eprintln!("the peers in Python are missing: {error}");
    }
    Comparison::print_heading();
    let selected: Vec<String> = std::env::args().skip(1).collect();
    for &(format, extension) in formats {
        if !selected.is_empty() && !selected.iter().any(|selected| selected == extension) {
            continue;
        }
        let path = scratch().join("io").with_extension(extension);
        let write = |path: &Path| {
            let file = File::create(path).expect("the scratch folder can be written");
            let mut file = BufWriter::new(file);
            io::write_to(format, mesh, &mut file).expect("a valid mesh");
        };
        write(&path);
        let row = |job: String, peer: &str, measured: Option<[f64; 2]>| {
            let Some([ours, theirs]) = measured else { return };
            let scale = 1e9 / mesh.triangles.len() as f64;
            let (ours, theirs) = (scale * ours, scale * theirs);
            let job = format!("{job}, {} triangles{with}", grouped(mesh.triangles.len()));
            let unit = "ns/triangle".into();
            Comparison { job, peer: peer.into(), unit, ours, theirs, accuracy: String::new() }.report();
        };
        let read_job = format!("read {}", extension.to_uppercase());
        if let Some((peer, _)) = library_of(format) {
            let mut theirs: Job<'_> = Box::new(|| Some(first_reading("library", &path)));
            row(read_job.clone(), peer, interleaved(&mut || first_reading("isochore", &path), &mut theirs));
        }
        let mut read_ours =
            || timed(|| std::hint::black_box(io::read(&path).expect("a readable mesh")).triangles.len());
        let Ok(python) = &mut python else { continue };
        for (name, peer) in peers {
            let mut ask =
                |job: &str, path: &PathBuf| python.seconds(&json!({ "job": format!("{name}_{job}"), "path": path }));
            let mut theirs: Job<'_> = Box::new(|| ask("read", &path).ok());
            let measured = interleaved(&mut read_ours, &mut theirs);
            drop(theirs);
            row(read_job.clone(), peer, measured);
            if measured.is_some() && with.is_empty() {
                let copy = scratch().join("io-copy").with_extension(extension);
                let mut theirs: Job<'_> = Box::new(|| ask("write", &copy).ok());
                let measured = interleaved(&mut || timed(|| write(&path)), &mut theirs);
                row(format!("write {}", extension.to_uppercase()), peer, measured);
            }
        }
    }
}

/// Runs both alternately and returns the median CPU times in seconds, or `None` if the peer does
/// not support the job.
fn interleaved(ours: &mut dyn FnMut() -> f64, theirs: &mut Job<'_>) -> Option<[f64; 2]> {
    let mut seconds = [Vec::new(), Vec::new()];
    for round in 0..=ROUNDS {
        let pair = [ours(), theirs()?];
        if round > 0 {
            seconds.iter_mut().zip(pair).for_each(|(seconds, new)| seconds.push(new));
        }
    }
    Some(seconds.map(|mut seconds| median(&mut seconds)))
}

fn timed<T>(work: impl FnOnce() -> T) -> f64 {
    let begin = cpu_seconds();
    std::hint::black_box(work());
    cpu_seconds() - begin
}

/// Reads a file and returns a number that depends on it.
type Reader = fn(&Path) -> f64;

/// Rust library that reads a format. The libraries do not weld or check.
fn library_of(format: Format) -> Option<(&'static str, Reader)> {
    match format {
        Format::Obj => Some(("tobj 4.0.5", read_with_tobj)),
        Format::Glb => Some(("gltf 1.4, unwelded, f32", read_with_gltf)),
        Format::Ply => Some(("ply-rs-bw 4.0", read_with_ply_rs)),
        Format::Stl => Some(("stl_io 0.11", read_with_stl_io)),
        _ => None,
    }
}

fn bytes(path: &Path) -> Vec<u8> {
    fs::read(path).expect("the file was written")
}

fn read_with_tobj(path: &Path) -> f64 {
    let no_materials = |_: &Path| Ok(Default::default());
    let read = tobj::load_obj_buf(&mut Cursor::new(bytes(path)), &tobj::LoadOptions::default(), no_materials);
    read.expect("a valid file").0[0].mesh.positions[0]
}

fn read_with_stl_io(path: &Path) -> f64 {
    let read = stl_io::read_stl(&mut Cursor::new(bytes(path))).expect("a valid file");
    f64::from(read.vertices[0].0[0])
}

/// A vertex with coordinates and normal, or a face with indices.
struct PlyElement {
    position: [f64; 3],
    normal: [f32; 3],
    indices: Vec<u32>,
}

impl PropertyAccess for PlyElement {
    fn new() -> Self {
        Self { position: [0.0; 3], normal: [0.0; 3], indices: Vec::new() }
    }

    fn set_double(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        let Some(axis) = ["x", "y", "z"].iter().position(|&axis| axis == name) else {
            return PropertyAccessResult::Ignored;
        };
        self.position[axis] = value;
        PropertyAccessResult::Set
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        let Some(axis) = ["nx", "ny", "nz"].iter().position(|&axis| axis == name) else {
            return PropertyAccessResult::Ignored;
        };
        self.normal[axis] = value;
        PropertyAccessResult::Set
    }

    fn begin_list_uint(&mut self, _: &str, _: usize) -> BeginList<'_, u32> {
        BeginList::Fill(&mut self.indices)
    }
}

fn read_with_ply_rs(path: &Path) -> f64 {
    let parser = Parser::<PlyElement>::new();
    let read = parser.read_ply(&mut Cursor::new(bytes(path))).expect("a valid file");
    let face = &read.payload["face"][0];
    let vertex = &read.payload["vertex"][face.indices[0] as usize];
    vertex.position[0] + f64::from(vertex.normal[0])
}

fn read_with_gltf(path: &Path) -> f64 {
    let document = gltf::Gltf::from_slice(&bytes(path)).expect("a valid file");
    let mut sum = 0.0;
    for primitive in document.meshes().flat_map(|mesh| mesh.primitives()) {
        let reader = primitive.reader(|_| document.blob.as_deref());
        let positions: Vec<[f32; 3]> = reader.read_positions().into_iter().flatten().collect();
        let normals: Vec<[f32; 3]> = reader.read_normals().into_iter().flatten().collect();
        let uvs: Vec<[f32; 2]> = reader.read_tex_coords(0).into_iter().flat_map(|uvs| uvs.into_f32()).collect();
        let indices: Vec<u32> = reader.read_indices().into_iter().flat_map(|indices| indices.into_u32()).collect();
        sum += f64::from(positions[indices[0] as usize][0]) + (normals.len() + uvs.len()) as f64;
    }
    sum
}
