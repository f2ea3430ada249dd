//! Reading and writing mesh files.

mod awkward;
mod awkward_gltf;
mod gltf;
mod obj;
mod oracles;
mod ply;
mod point_stream;
mod round_trip;
mod stl_off;
mod untrusted;
mod writing;

use glam::{DVec3, DVec4, Vec2};
use isochore_mesh::io::{self, Format, ParseError};
use isochore_mesh::{TriMesh, primitives};

const FORMATS: [Format; 6] = [Format::Obj, Format::Gltf, Format::Glb, Format::Ply, Format::Stl, Format::Off];

fn written(format: Format, mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    io::write_to(format, mesh, &mut bytes).unwrap();
    bytes
}

fn reread(format: Format, mesh: &TriMesh) -> TriMesh {
    io::read_bytes(format, &written(format, mesh)).unwrap()
}

fn parse(format: Format, text: &str) -> Result<TriMesh, ParseError> {
    io::read_bytes(format, text.as_bytes())
}

/// A closed box with seams between its faces in texture coordinates and normals, two materials and
/// vertex colors. All numbers are multiples of small powers of two, so they are exact in single
/// precision.
fn seamed_box() -> TriMesh {
    let mut mesh = primitives::box_mesh(DVec3::new(1.0, 2.0, 0.5), [2, 1, 4]);
    let flat = |triangle: usize| {
        let [a, b, c] = mesh.corners(triangle);
        (b - a).cross(c - a).normalize().round()
    };
    let normals: Vec<DVec3> = (0..mesh.triangles.len()).map(flat).collect();
    let uv = |position: DVec3, normal: DVec3| {
        let axis = normal.abs().max_position();
        let position = position.as_vec3();
        Vec2::new(position[(axis + 1) % 3], position[(axis + 2) % 3]) / 8.0 + Vec2::splat(0.5)
    };
    let uvs = (0..mesh.triangles.len()).map(|t| mesh.corners(t).map(|position| uv(position, normals[t])));
    mesh.corner.uvs = vec![uvs.collect()];
    mesh.corner.normals = normals.iter().map(|normal| [normal.as_vec3(); 3]).collect();
    mesh.vertex.colors = mesh.positions.iter().map(|p| DVec4::new(p.x.abs() / 4.0, 0.25, 0.5, 1.0)).collect();
    mesh.materials = vec!["bark".into(), "moss green".into()];
    mesh.triangle_materials = normals.iter().map(|normal| u32::from(normal.z > 0.5)).collect();
    // Grouped by material, as in glTF.
    let mut order: Vec<usize> = (0..mesh.triangles.len()).collect();
    order.sort_by_key(|&triangle| mesh.triangle_materials[triangle]);
    permute(&mut mesh.triangles, &order);
    permute(&mut mesh.triangle_materials, &order);
    permute(&mut mesh.corner.uvs[0], &order);
    permute(&mut mesh.corner.normals, &order);
    mesh
}

fn permute<T: Copy>(values: &mut Vec<T>, order: &[usize]) {
    *values = order.iter().map(|&index| values[index]).collect();
}
