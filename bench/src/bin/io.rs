//! Reading and writing of mesh files. Reading is measured by the library's own time where a library reads.
//!
//! What is on top of it: keeping the order of the file, welding, range checks, triangulation and materials.

#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

use std::io::Cursor;

use isochore_bench::{interleaved_medians, print_row};
use isochore_mesh::io::{self, Format};
use isochore_mesh::{TriMesh, primitives};

fn main() {
    let mut mesh = primitives::icosphere(1.0, 7);
    println!(
        "icosphere of {} triangles, from and to memory; ratios are to the first of each group",
        mesh.triangles.len()
    );
    compare_formats(&mesh);
    let normals = mesh.vertex_normals();
    mesh.corner.normals = mesh.triangles.iter().map(|t| t.map(|vertex| normals[vertex as usize])).collect();
    println!("the same with normals");
    compare_formats(&mesh);
}

/// Something to be timed. It returns a number that depends on its work, so that none of it can be left out.
type Contender<'a> = (&'a str, &'a mut dyn FnMut() -> f64);

fn compare<const N: usize>(group: &str, mut contenders: [Contender<'_>; N]) {
    let names = contenders.each_ref().map(|(name, _)| *name);
    let mut jobs = contenders.each_mut().map(|(_, run)| {
        || {
            std::hint::black_box(run());
        }
    });
    let medians = interleaved_medians(&mut jobs.each_mut().map(|job| job as &mut dyn FnMut()));
    for (name, median) in names.iter().zip(&medians) {
        print_row([group, name, &format!("{:.2} ms", 1e3 * median), &format!("x {:.2}", median / medians[0])]);
    }
}

fn compare_formats(mesh: &TriMesh) {
    let written = |format: Format| {
        let mut bytes = Vec::new();
        io::write_to(format, mesh, &mut bytes).expect("the mesh is sound");
        bytes
    };
    let ours = |format: Format, bytes: &[u8]| {
        io::read_bytes(format, bytes).expect("what was written can be read").positions[0].x
    };
    let [obj, glb, stl, ply] = [Format::Obj, Format::Glb, Format::Stl, Format::Ply].map(written);
    compare("read OBJ", [("tobj alone", &mut || read_with_tobj(&obj)), ("isochore", &mut || ours(Format::Obj, &obj))]);
    compare(
        "read GLB",
        [("gltf, unwelded", &mut || read_with_gltf(&glb)), ("isochore", &mut || ours(Format::Glb, &glb))],
    );
    compare(
        "read STL",
        [("stl_io alone", &mut || read_with_stl_io(&stl)), ("isochore", &mut || ours(Format::Stl, &stl))],
    );
    compare("read PLY", [("isochore", &mut || ours(Format::Ply, &ply))]);
    compare(
        "write",
        [
            ("OBJ", &mut || written(Format::Obj).len() as f64),
            ("GLB", &mut || written(Format::Glb).len() as f64),
            ("STL", &mut || written(Format::Stl).len() as f64),
            ("PLY", &mut || written(Format::Ply).len() as f64),
        ],
    );
    compare(
        "measure",
        [
            ("volume", &mut || mesh.volume()),
            ("check", &mut || mesh.check().boundary_edges.len() as f64),
            ("components", &mut || mesh.components().count as f64),
        ],
    );
}

fn read_with_tobj(obj: &[u8]) -> f64 {
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let read = tobj::load_obj_buf(&mut Cursor::new(obj), &tobj::LoadOptions::default(), no_materials);
    read.expect("the file is sound").0[0].mesh.positions[0]
}

fn read_with_stl_io(stl: &[u8]) -> f64 {
    let read = stl_io::read_stl(&mut Cursor::new(stl)).expect("the file is sound");
    f64::from(read.vertices[0].0[0])
}

fn read_with_gltf(glb: &[u8]) -> f64 {
    let document = gltf::Gltf::from_slice(glb).expect("the file is sound");
    let mut sum = 0.0;
    for primitive in document.meshes().flat_map(|mesh| mesh.primitives()) {
        let reader = primitive.reader(|_| document.blob.as_deref());
        let positions: Vec<[f32; 3]> = reader.read_positions().into_iter().flatten().collect();
        let normals: Vec<[f32; 3]> = reader.read_normals().into_iter().flatten().collect();
        let indices: Vec<u32> = reader.read_indices().into_iter().flat_map(|indices| indices.into_u32()).collect();
        sum += f64::from(positions[indices[0] as usize][0]) + normals.len() as f64;
    }
    sum
}
